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

# leaves STATUS NAME ARGS: with that status, and with nothing on stderr.
leaves() {
    wanted=$1 name=$2; shift 2; run "$@"
    if [ $status -eq "$wanted" ] && [ ! -s err ]; then ok "$name"; else bad "$name" "status $status" "$(cat err)"; fi
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

# ---- what stands in files ----

lines() { if [ -e "$1" ]; then wc -l <"$1"; else echo 0; fi; }
is_png() { [ "$(od -An -tx1 -N4 "$1" | tr -d ' ')" = 89504e47 ]; }
# number FILE NAME: the third cell of the row that begins with NAME.
number() { awk -F, -v name="$2" '$1 == name { print $3 }' "$1"; }
# column FILE NAME [EXPRESSION]: its cells, in rows that awk finds it true for; cell(NAME) is a cell. Only for tables
# without quoted cells before it.
column() {
    awk -F, -v name="$2" 'function cell(n) { return $at[n] }
        NR == 1 { for (i = 1; i <= NF; i++) { sub(/ \[.*/, "", $i); at[$i] = i }; next }
        '"${3:-1}"' { print cell(name) }' "$1"
}
# rows FILE [EXPRESSION]: how many rows awk finds it true for.
rows() { awk -F, "NR > 1 && (${2:-1})" "$1" | wc -l; }
# whole_table FILE: a bench's table has rows of one width, and beside it what each column means and a chart.
whole_table() {
    that "$1 has rows of one width" [ "$(awk -F, '{ print NF }' "$1" | sort -u | wc -l)" -eq 1 ]
    that "$1 has each column explained" [ "$(head -n 1 "$1" | tr , '\n' | wc -l)" -eq \
        "$(sed -n '/"columns"/,/}/p' "${1%.csv}.meta.json" | grep -c '": "')" ]
    if command -v gnuplot >/dev/null; then that "$1 has a chart" grep -q '</svg>' "${1%.csv}.svg"; fi
}

# ---- being stopped ----

# wait_for SECONDS COMMAND: until it holds.
wait_for() {
    tries=$(($1 * 50)); shift
    while ! "$@" && [ $tries -gt 0 ]; do sleep 0.02; tries=$((tries - 1)); done
    "$@"
}
has_lines() { [ "$(lines "$1")" -ge "$2" ]; }

# stop_at FILE N ARGS: asks it to stop when FILE has N lines; status and err are what came of it.
stop_at() {
    file=$1 wanted=$2; shift 2
    "$ssfr" "$@" 2>err &
    child=$!
    wait_for 20 has_lines "$file" "$wanted"
    kill -TERM $child
    wait $child
    status=$?
}

# stops FILE N ARGS: a bench.
stops() {
    stop_at "$@"
    that 'a bench that is asked to stop leaves with 2' [ $status -eq 2 ]
    that 'and says how to go on' grep -q '^ssfr bench: interrupted.*--resume' err
    that 'in one line' [ "$(wc -l <err)" -eq 1 ]
    that 'its table ends in a whole line' [ "$(tail -c 1 "$file" | wc -l)" -eq 1 ]
}
