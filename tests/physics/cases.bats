#!/usr/bin/env bats
# The cases of the thesis at their full size, against the bounds in their expected.toml; hours.

# full_case NAME [NEEDED]: of the folders of real tomographies
full_case() {
    local shared="${TOMODEM_SHARED:-$TOMODEM_SOURCE/../shared}"
    [ -z "${2:-}" ] || [ -d "$shared/data/$2" ] || skip "the tomography $2 is not there (TOMODEM_SHARED)"
    cd "$BATS_TEST_TMPDIR" || exit 1
    make --no-print-directory -s -f "$TOMODEM_SOURCE/pipelines/cases/$1/Makefile" -j2 SIZE=full OUT=out BIN="$TOMODEM_BIN" THREADS=1 check >&3
}

@test "one material under each law" { full_case single_material; }

@test "two phases side by side, one over the other, and one in the other" { full_case two_phases; }

@test "the composite of a tomography" { full_case composite nodular_cast_iron; }

@test "casting pores" { full_case casting_pores nodular_cast_iron; }

@test "open-cell foam" { full_case open_cell_foam trabecular_bone; }
