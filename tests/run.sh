#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# run.sh TEST...: runs test executables and tests/test_*.sh, shows the output of those that fail, counts cases.
# GL=required makes a test that lacks GL fail; SSFR_DATA names a folder with simulators' own files; SAN=1 says that the
# executables are sanitised.

here=$(cd "$(dirname "$0")" && pwd)
log=$(mktemp "${TMPDIR:-/tmp}/ssfr-tests-XXXXXX") || exit 2
trap 'rm -f "$log"' EXIT
trap 'exit 2' INT TERM
passed=0
failed=0
skipped=0

# Threads that spin while they wait cost tenfold where other programs want the cores.
export OMP_WAIT_POLICY="${OMP_WAIT_POLICY:-passive}"
if [ -n "$SAN" ]; then
    # The leak scan crashes in thread-local memory of a GL driver that was loaded after OpenMP's threads began.
    export ASAN_OPTIONS="intercept_tls_get_addr=0:detect_leaks=1:allocator_may_return_null=1:$ASAN_OPTIONS"
    export UBSAN_OPTIONS="print_stacktrace=1:$UBSAN_OPTIONS"
    export LSAN_OPTIONS="suppressions=$here/lsan.supp:print_suppressions=0:$LSAN_OPTIONS"
fi

# A test that says nothing of its cases, or dies, is one failed case.
for test in "$@" "$here"/test_*.sh; do
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
    printf '%-22s %4d passed %3d failed %3d skipped  %3d s\n' \
        "$(basename "$test")" "$p" "$f" "$s" $(($(date +%s) - start))
    if [ "$f" -ne 0 ]; then
        grep -vE '^(\[ RUN      \]|\[       OK \]|ok - )' "$log" | tail -n 60
        [ $status -eq 124 ] && echo "timed out"
    fi
    passed=$((passed + p)) failed=$((failed + f)) skipped=$((skipped + s))
done
echo "$passed passed, $failed failed, $skipped skipped"
[ $failed -eq 0 ]
