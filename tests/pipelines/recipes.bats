#!/usr/bin/env bats
# The pages of docs/recipes, as they stand there, and what they say of the results.

setup() {
    cd "$BATS_TEST_TMPDIR" || exit 1
    export PATH="$TOMODEM_BIN:$PATH"
}

# run_page NAME: the commands of a page
run_page() {
    sed -n '/^```sh$/,/^```$/{/^```/d;p}' "$TOMODEM_SOURCE/docs/recipes/$1.md" >commands.sh
    [ "$(grep -c . commands.sh)" -gt 15 ]
    bash -eu commands.sh
}
