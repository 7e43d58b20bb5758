# SPDX-License-Identifier: GPL-3.0-or-later
# cases.sh: what tests of the command line share; sourced with their name in $test. They run in a folder of their own,
# print one line a case, and end with `finish`.
# shellcheck shell=sh disable=SC2154 # $test is the sourcing script's

here=$(cd "$(dirname "$0")" && pwd)
ssfr=$(cd "$(dirname "${SSFR:-${BUILD:-build}/ssfr}")" && pwd)/$(basename "${SSFR:-ssfr}")
work=$(mktemp -d "${TMPDIR:-/tmp}/ssfr-$test-XXXXXX") || exit 2
trap 'rm -rf "$work"' EXIT
trap 'exit 2' INT TERM
cd "$work" || exit 2
[ -x "$ssfr" ] || { echo "not ok - $ssfr is there"; echo "0 passed, 1 failed"; exit 1; }
passed=0
failed=0

ok() { passed=$((passed + 1)); echo "ok - $1"; }
bad() { failed=$((failed + 1)); echo "not ok - $1"; shift; printf '# %s\n' "$@"; }

finish() {
    echo "$passed passed, $failed failed"
    [ $failed -eq 0 ]
}

# run ARGS: status, out and err are what came of it.
run() {
    "$ssfr" "$@" >out 2>err
    status=$?
}

# refuses NAME TEXT ARGS: leaves with 2, nothing on stdout, one line on stderr that names the command and holds TEXT.
refuses() {
    name=$1 text=$2; shift 2; run "$@"
    if [ $status -eq 2 ] && [ ! -s out ] && [ "$(wc -l <err)" -eq 1 ] && grep -q '^ssfr' err && grep -qF -- "$text" err
    then ok "$name"; else bad "$name" "status $status, wanted 2 and: $text" "$(cat err)"; fi
}

# accepts NAME ARGS: leaves with 0.
accepts() {
    name=$1; shift; run "$@"
    if [ $status -eq 0 ]; then ok "$name"; else bad "$name" "status $status" "$(cat err)"; fi
}

# that NAME COMMAND: the shell command holds.
that() {
    name=$1; shift
    if "$@"; then ok "$name"; else bad "$name" "$*"; fi
}
