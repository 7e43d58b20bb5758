#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# test_bench_solver.sh: the solver's bench from outside: what its tables hold, stopped and gone on with, errors.
# shellcheck disable=SC2086,SC2016 # names are plain; awk expands its own

test=bench_solver
. "$(dirname "$0")/cases.sh"

tables='b.csv b_physics.csv b_series.csv b_fall.csv'

# ---- what it measures ----

run bench solver --quick -o b.csv
that 'bench solver runs' [ $status -eq 0 ]
that 'without a complaint' [ ! -s err ]
that 'it prints steps for people' grep -Eq '^pool	250	1	[0-9.]+	[0-9.]+	[0-9]+	[0-9]+	' out
that 'and stages' grep -Eq '^dam_break	.*	multipliers	[0-9.]+	' out
that 'and foam' grep -Eq '^250	1000	1	[0-9.]+	' out
that 'and water' grep -Eq '^dam_break	settled	4	[-+][0-9.]+	' out
that 'and free fall' grep -Eq '^0\.008333	4\.9' out
for table in $tables; do
    that "$table has no row that failed" [ "$(column $table status | sort -u)" = ok ]
    that "$table has metadata" grep -q '"solver.iterations": 4' "${table%.csv}.meta.json"
    whole_table $table
done
that 'every step took time' [ "$(rows b.csv '$4 == "(step)" && $9 > 0 && $11 >= 10')" -eq \
    "$(rows b.csv '$4 == "(step)"')" ]
that 'and so did every stage' [ "$(rows b.csv '$4 !~ /^[(]/ && $9 > 0')" -eq $((8 * $(rows b.csv '$4 == "(step)"'))) ]
that 'at both sizes, in both cases' [ "$(rows b.csv '$4 == "(step)" && $3 == 1')" -eq 4 ]
that 'memory is counted' [ "$(rows b.csv '$4 == "(step)" && $14 > 200 && $14 < 2000')" -eq \
    "$(rows b.csv '$4 == "(step)"')" ]
that 'a drop falls to first order' [ "$(rows b_fall.csv '$6 > 0.98 && $6 < 1.02')" -eq 2 ]
that 'a pool at rest keeps its height' [ "$(rows b_physics.csv '$1 == "pool" && ($17 < -0.1 || $17 > 0.1)')" -eq 0 ]
that 'the course begins at rest' [ "$(rows b_series.csv '$3 == 0 && $5 == 0 && $9 == 0')" -eq 4 ]

# ---- gone on with ----

for table in $tables; do cp $table "whole_$table"; done
run bench solver --quick -o b.csv --resume --no-plot
that 'whole tables need no run' [ $status -eq 0 ]
for table in $tables; do that "and $table stays as it was" cmp -s $table "whole_$table"; done
for table in $tables; do sort "whole_$table" >"sorted_$table"; done
# cut_off FILE SHARE: to its first SHARE percent.
cut_off() { head -c $(($(wc -c <"whole_$1") * $2 / 100)) "whole_$1" >"$1"; }
for share in 30 55 99; do
    cut_off b_series.csv $share
    cut_off b_fall.csv $share
    head -n 1 whole_b_physics.csv >b_physics.csv # a simulation's rows are written behind its course
    run bench solver --quick -o b.csv --resume --no-plot
    that "tables that are cut at $share % are made whole" [ $status -eq 0 ]
    for table in b_physics.csv b_series.csv b_fall.csv; do
        sort $table >again
        that "$table to the same bits" cmp -s again "sorted_$table"
    done
done
cut_off b_physics.csv 60
run bench solver --quick -o b.csv --resume --no-plot
sort b_series.csv >again
that 'a course that is there stands once' cmp -s again sorted_b_series.csv
refuses 'a table of another length of simulation is not gone on with' 'b.csv: was measured with other settings' \
    bench solver -o b.csv --resume
rm ./b.* ./b_* ./whole_* ./sorted_* ./again

# ---- stopped ----

stops s.csv 3 bench solver -o s.csv --max-particles 1024
for table in s_physics.csv s_series.csv s_fall.csv; do
    that "$table ends in a whole line" [ "$(tail -c 1 $table | wc -l)" -eq 1 ]
done
rm ./s.* ./s_*

# ---- errors ----

refuses 'it finds out at once where it cannot write' 'absent/b.csv' bench solver --quick -o absent/b.csv
refuses 'going on needs a table' '--resume needs' bench solver --quick --resume
refuses 'it takes no pipeline' 'vanderlaan2009' bench solver vanderlaan2009
refuses 'it measures some particles at least' '--max-particles' bench solver --max-particles 0
mkfifo b_fall.csv
refuses 'it replaces no pipe' 'b_fall.csv: is not a regular file' bench solver --quick -o b.csv
that 'and has not begun then' [ ! -e b.csv ]
run bench solver --help
that 'it explains itself' grep -q -- '--max-particles' out

finish
