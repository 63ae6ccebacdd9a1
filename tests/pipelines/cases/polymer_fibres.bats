#!/usr/bin/env bats
# The small variant of a case on a real image.

load common

@test "a fibre preform pressed: the small variant's figures are within their bounds" {
    [ -d "${TOMODEM_SHARED:-$TOMODEM_SOURCE/../shared}/data" ] || skip "the real tomographies are not there (TOMODEM_SHARED)"
    small_case polymer_fibres
}
