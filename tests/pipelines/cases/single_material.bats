#!/usr/bin/env bats
# The small variant of a case of the thesis.

load common

@test "one material under each law: the small variant's figures are within their bounds" { small_case single_material; }
