#!/usr/bin/env bats
# The small variant of a case of the thesis.

load common

@test "open-cell foams pressed: the small variant's figures are within their bounds" { small_case open_cell_foam; }
