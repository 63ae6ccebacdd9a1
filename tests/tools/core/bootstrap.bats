#!/usr/bin/env bats
# ./bootstrap on systems where it cannot do its work.

@test "it does nothing where every package is there" {
    run "$TOMODEM_SOURCE/bootstrap" "$TOMODEM_SOURCE"/packages/debian*.txt
    [ "$status" -eq 0 ]
    [ -z "$output" ]
}

@test "without apt it lists what is needed and fails" {
    mkdir "$BATS_TEST_TMPDIR/bin"
    for command in sh sed dirname; do ln -s "$(command -v $command)" "$BATS_TEST_TMPDIR/bin/"; done
    run env PATH="$BATS_TEST_TMPDIR/bin" sh "$TOMODEM_SOURCE/bootstrap"
    [ "$status" -eq 1 ]
    [[ "$output" == *"no apt"* && "$output" == *"libopenvdb-dev"* ]]
}

@test "the tools' list is what it installs where none is named; the tests' packages are in a list of their own" {
    mkdir "$BATS_TEST_TMPDIR/bin"
    for command in sh sed dirname; do ln -s "$(command -v $command)" "$BATS_TEST_TMPDIR/bin/"; done
    run env PATH="$BATS_TEST_TMPDIR/bin" sh "$TOMODEM_SOURCE/bootstrap"
    [[ "$output" != *"libgtest-dev"* ]]
    run env PATH="$BATS_TEST_TMPDIR/bin" sh "$TOMODEM_SOURCE/bootstrap" "$TOMODEM_SOURCE/packages/debian-test.txt"
    [[ "$output" == *"libgtest-dev"* && "$output" != *"libopenvdb-dev"* ]]
}

@test "without root and sudo it says what an administrator must install" {
    mkdir "$BATS_TEST_TMPDIR/bin"
    for command in sh sed dirname apt-get; do ln -s "$(command -v $command)" "$BATS_TEST_TMPDIR/bin/"; done
    printf '#!/bin/sh\necho 1000\n' > "$BATS_TEST_TMPDIR/bin/id"
    printf '#!/bin/sh\nexit 1\n' > "$BATS_TEST_TMPDIR/bin/dpkg-query"
    chmod +x "$BATS_TEST_TMPDIR"/bin/id "$BATS_TEST_TMPDIR/bin/dpkg-query"
    run env PATH="$BATS_TEST_TMPDIR/bin" sh "$TOMODEM_SOURCE/bootstrap"
    [ "$status" -eq 1 ]
    [[ "$output" == *"ask an administrator"* && "$output" == *"apt-get install"* ]]
}
