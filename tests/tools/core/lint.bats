#!/usr/bin/env bats
# The lint gate (tests/lint/lint, `make lint`) on a project of one source and one header: planted violations fail.

setup() {
    project=$BATS_TEST_TMPDIR/project
    mkdir -p "$project/core/base" "$project/tests/lint"
    cp "$TOMODEM_SOURCE/.clang-tidy" "$project/"
    cat > "$project/CMakeLists.txt" <<'END'
cmake_minimum_required(VERSION 3.25)
project(planted LANGUAGES CXX)
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
option(BUILD_TESTING "" OFF)
option(TOMODEM_BENCH "" OFF)
add_library(planted STATIC core/base/planted.cpp)
target_include_directories(planted PRIVATE ${PROJECT_SOURCE_DIR})
END
    cat > "$project/core/base/planted2.hpp" <<'END'
#pragma once
#include <string>
namespace planted {
inline std::size_t length(const std::string& text) { return text.size(); }
}
END
    cat > "$project/core/base/planted.cpp" <<'END'
#include "core/base/planted2.hpp"

#include <utility>

namespace planted {
std::size_t twice(std::string text) {
    const std::size_t size = length(text);
    const std::string taken = std::move(text);
    return size + taken.size();
}
}
END
}

lint() { run "$TOMODEM_SOURCE/tests/lint/lint" "$BATS_TEST_TMPDIR/build" --source "$project" "$@"; }

@test "sources without a fault pass, and are not checked again before something changes" {
    lint
    [ "$status" -eq 0 ]
    [[ "$output" == *"1 sources, 1 of them checked now, 0 with findings"* ]]
    lint
    [[ "$output" == *"1 sources, 0 of them checked now, 0 with findings"* ]]
    echo >> "$project/core/base/planted2.hpp"
    lint
    [[ "$output" == *"1 sources, 1 of them checked now, 0 with findings"* ]]
}

@test "a fault in a source fails" {
    sed -i 's/return size + taken.size/return text.size() + size + taken.size/' "$project/core/base/planted.cpp"
    lint
    [ "$status" -eq 1 ]
    [[ "$output" == *"planted.cpp:"*"bugprone-use-after-move"* ]]
}

@test "a fault in a header fails, whatever letters and digits its name has" {
    sed -i 's/return text.size();/return text.size() + sizeof(text.size());/' "$project/core/base/planted2.hpp"
    sed -i 's/inline std::size_t length/inline double share(int a, int b) { double c = a \/ b; return c; }\n&/' "$project/core/base/planted2.hpp"
    lint
    [ "$status" -eq 1 ]
    [[ "$output" == *"planted2.hpp:"*"bugprone-integer-division"* ]]
}

@test "a name in another form than the house's fails, in a source and in a header" {
    sed -i 's/const std::string taken/const std::string takenText/; s/taken\.size/takenText.size/' "$project/core/base/planted.cpp"
    sed -i 's/inline std::size_t length/class Room {\n    int number;\n};\n&/' "$project/core/base/planted2.hpp"
    lint
    [ "$status" -eq 1 ]
    [[ "$output" == *"planted.cpp:"*"'takenText'"*"readability-identifier-naming"* ]]
    [[ "$output" == *"planted2.hpp:"*"'number'"*"readability-identifier-naming"* ]]
}

@test "a header that no source includes fails" {
    printf '#pragma once\n' > "$project/core/base/alone.hpp"
    lint
    [ "$status" -eq 1 ]
    [[ "$output" == *"core/base/alone.hpp: no source that is checked includes this header"* ]]
}

@test "a source is left out by its name and a reason only" {
    sed -i 's/return size/return text.size() + size/' "$project/core/base/planted.cpp"
    rm "$project/core/base/planted2.hpp"
    sed -i 's/#include "core.*/#include <string>/; s/length(text)/text.size()/' "$project/core/base/planted.cpp"
    echo "core/base/planted.cpp  takes a minute" > "$project/tests/lint/left_out.txt"
    lint
    [ "$status" -eq 0 ]
    [[ "$output" == *"1 left out"* ]]
    echo "core/base/planted.cpp" > "$project/tests/lint/left_out.txt"
    lint
    [ "$status" -eq 1 ]
    echo "core/base/gone.cpp  takes a minute" > "$project/tests/lint/left_out.txt"
    lint
    [ "$status" -eq 1 ]
}

@test "every source has the house's format" {
    cd "$TOMODEM_SOURCE"
    find core tools solver_plugin tests bench -name '*.cpp' -o -name '*.hpp' | xargs clang-format --dry-run --Werror
}
