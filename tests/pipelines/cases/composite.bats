#!/usr/bin/env bats
# The small variant of a case of the thesis.

load common

@test "the composite of a tomography: the small variant's figures are within their bounds" { small_case composite; }
