#!/usr/bin/env bats
# The small variant of a case of the thesis.

load common

@test "two phases side by side, one over the other, and one in the other: the small variant's figures are within their bounds" { small_case two_phases; }
