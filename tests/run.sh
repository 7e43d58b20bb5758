#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# run.sh TEST...: runs test executables and tests/test_*.sh, as many at once as there are cores (JOBS), shows the output
# of those that fail, counts cases.
# GL=required makes a test that lacks GL fail; SSFR_DATA names a folder with simulators' own files; SAN=1 says that the
# executables are sanitised.

here=$(cd "$(dirname "$0")" && pwd)

# One test; leaves "passed failed skipped" in COUNTS. One that says nothing of its cases, or dies, is one failed case.
run_one() {
    test=$1 counts=$2 log=$2.log
    start=$(date +%s)
    case $test in
    *.sh) timeout -k 10 300 sh "$test" >"$log" 2>&1 ;;
    *) timeout -k 10 300 "$test" >"$log" 2>&1 ;;
    esac
    status=$?
    # cmocka names a failed and a skipped test twice
    p=$(grep -cE '^(\[       OK \]|ok - )' "$log")
    f=$(grep -E '^(\[  FAILED  \] [a-z]|not ok - )' "$log" | sort -u | wc -l)
    s=$(grep -E '^(\[  SKIPPED \] [a-z]|skip - )' "$log" | sort -u | wc -l)
    if [ $status -ne 0 ] && [ "$f" -eq 0 ]; then f=1; fi
    if [ $status -eq 0 ] && [ $((p + f + s)) -eq 0 ]; then f=1; fi
    line=$(printf '%-22s %4d passed %3d failed %3d skipped  %3d s' \
        "$(basename "$test")" "$p" "$f" "$s" $(($(date +%s) - start)))
    if [ "$f" -ne 0 ]; then # in one piece: others write, too
        line="$line
$(grep -vE '^(\[ RUN      \]|\[       OK \]|ok - )' "$log" | tail -n 60)"
        [ $status -eq 124 ] && line="$line
timed out"
    fi
    printf '%s\n' "$line"
    echo "$p $f $s" >"$counts"
    rm "$log"
}

if [ "$1" = --one ]; then
    run_one "$2" "$SSFR_COUNTS/$(basename "$2")"
    exit 0
fi

SSFR_COUNTS=$(mktemp -d "${TMPDIR:-/tmp}/ssfr-tests-XXXXXX") || exit 2
export SSFR_COUNTS
trap 'rm -rf "$SSFR_COUNTS"' EXIT
trap 'exit 2' INT TERM

# Threads that spin while they wait cost tenfold where other programs want the cores.
export OMP_WAIT_POLICY="${OMP_WAIT_POLICY:-passive}"
# So do the threads of a software rasteriser, beside as many tests as there are cores.
export LP_NUM_THREADS="${LP_NUM_THREADS:-1}"
if [ -n "$SAN" ]; then
    # The leak scan crashes in thread-local memory of a GL driver that was loaded after OpenMP's threads began.
    export ASAN_OPTIONS="intercept_tls_get_addr=0:detect_leaks=1:allocator_may_return_null=1:$ASAN_OPTIONS"
    export UBSAN_OPTIONS="print_stacktrace=1:$UBSAN_OPTIONS"
    export LSAN_OPTIONS="suppressions=$here/lsan.supp:print_suppressions=0:$LSAN_OPTIONS"
fi

# The scripts take longest: they go first.
printf '%s\n' "$here"/test_*.sh "$@" | xargs -d '\n' -n 1 -P "${JOBS:-$(nproc)}" sh "$0" --one
n=$(cat "$SSFR_COUNTS"/* | wc -l)
set -- $((n - $# - $(ls "$here"/test_*.sh | wc -l))) $(cat "$SSFR_COUNTS"/* | awk '{p += $1; f += $2; s += $3} END {print p, f, s}')
echo "$2 passed, $3 failed, $4 skipped"
[ "$1" -eq 0 ] && [ "$3" -eq 0 ]
