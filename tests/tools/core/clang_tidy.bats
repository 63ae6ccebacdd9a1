#!/usr/bin/env bats
# The lint gate: a planted violation fails, and so does a format that is not the house's.

setup() {
    cd "$BATS_TEST_TMPDIR" || exit 1
    cp "$TOMODEM_SOURCE/.clang-tidy" "$TOMODEM_SOURCE/.clang-format" .
}

@test "clang-tidy refuses a planted violation" {
    cat > planted.cpp <<'END'
#include <string>
#include <utility>
std::size_t twice(std::string text) {
    std::string taken = std::move(text);
    return taken.size() + text.size();
}
END
    run clang-tidy --quiet planted.cpp -- -std=c++20
    [ "$status" -ne 0 ]
    [[ "$output" == *"bugprone-use-after-move"* ]]
}

@test "clang-tidy accepts the same without it" {
    printf '#include <string>\nstd::size_t size(const std::string& text) { return text.size(); }\n' > clean.cpp
    clang-tidy --quiet clean.cpp -- -std=c++20
}

@test "every source has the house's format" {
    cd "$TOMODEM_SOURCE"
    find core tools solver_plugin tests bench -name '*.cpp' -o -name '*.hpp' | xargs clang-format --dry-run --Werror
}
