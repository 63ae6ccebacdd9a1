#!/usr/bin/env bats
# docs/architecture.md says who may include whom.

setup() { rooms="$TOMODEM_SOURCE/tests/tools/core/rooms.py"; }

# A copy of the sources to plant faults in.
copy_sources() {
    mkdir "$BATS_TEST_TMPDIR/copy" "$BATS_TEST_TMPDIR/copy/docs"
    cp -r "$TOMODEM_SOURCE/core" "$TOMODEM_SOURCE/solver_plugin" "$TOMODEM_SOURCE/tools" "$BATS_TEST_TMPDIR/copy/"
    cp "$TOMODEM_SOURCE/docs/architecture.md" "$BATS_TEST_TMPDIR/copy/docs/"
    cd "$BATS_TEST_TMPDIR/copy"
}

@test "every include is one that docs/architecture.md allows" {
    "$rooms" "$TOMODEM_SOURCE"
}

@test "a planted include of a room above is refused" {
    copy_sources
    echo '#include "core/scene/scene.hpp"' >> core/packing/packing.cpp
    run "$rooms" .
    [ "$status" -eq 1 ]
    [[ "$output" == *"core/packing/packing.cpp: includes core/scene/scene.hpp, and core/packing may not include core/scene"* ]]
}

@test "a planted command line below main is refused" {
    copy_sources
    echo '#include "core/cli/cli.hpp"' >> tools/vol2pack/sample.cpp
    run "$rooms" .
    [ "$status" -eq 1 ]
    [[ "$output" == *"tools/vol2pack/sample.cpp: includes core/cli/cli.hpp, and has no main()"* ]]
}

@test "a planted header of a heavy library is refused, and so is one of LIGGGHTS" {
    copy_sources
    echo '#include <openvdb/openvdb.h>' >> core/volume/regions.cpp
    echo '#include "neighbor.h"' >> solver_plugin/pairs/pair_search.cpp
    run "$rooms" .
    [ "$status" -eq 1 ]
    [[ "$output" == *"core/volume/regions.cpp: includes openvdb/openvdb.h of OpenVDB"* ]]
    [[ "$output" == *"solver_plugin/pairs/pair_search.cpp: includes neighbor.h of LIGGGHTS"* ]]
}

@test "a folder that the page does not name is refused, and so is a circle of rooms" {
    copy_sources
    mkdir core/attic
    echo > core/attic/old.cpp
    sed -i 's/^| `core\/base` |\(.*\)| *none *|$/| `core\/base` |\1| `core\/packing` |/' docs/architecture.md
    run "$rooms" .
    [ "$status" -eq 1 ]
    [[ "$output" == *"core/attic/old.cpp: in no room"* ]]
    [[ "$output" == *"may include itself through other rooms"* ]]
}
