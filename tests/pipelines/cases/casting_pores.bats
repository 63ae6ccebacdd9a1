#!/usr/bin/env bats
# The small variant of a case of the thesis.

load common

@test "casting pores, pressed and pulled back: the small variant's figures are within their bounds" { small_case casting_pores; }
