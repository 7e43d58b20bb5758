#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# test_bench_flow.sh: the bench of the curvature flows from outside: its two tables, metadata, charts, errors.
# shellcheck disable=SC2086,SC2016 # names are plain; awk expands its own

test=bench_flow
. "$(dirname "$0")/cases.sh"

# rows FILE EXPRESSION: how many rows awk finds it true for.
rows() { awk -F, "NR > 1 && ($2)" "$1" | wc -l; }

# ---- bumps on a plane ----

run bench flow --quick -o b.csv
that 'bench flow runs' [ $status -eq 0 ]
that 'without a complaint' [ ! -s err ]
that 'it prints widths for people' grep -Eq '^fixed	0.5	40	0.00460	0.230	' out
that 'of each flow at each distance' [ "$(grep -Ec '^(fixed|paper|metres|over_depth)	' out)" -eq 12 ]
that 'the table has every period' [ "$(rows b.csv 1)" -eq 120 ]
that 'those that pixels resolve are measured' [ "$(rows b.csv '($4 == "ok") != ($8 > 0 && $8 < 1)')" -eq 0 ]
that 'others say why they are not' [ "$(rows b.csv '$4 == "shorter than 4 pixels"')" -gt 0 ]
that 'steps times distance smooth alike' [ "$(rows b.csv '$1 == "paper" && ($12 < 0.45 || $12 > 0.55)')" -eq 0 ]
that 'the metadata has the plane' grep -q '"smoothing \[radii\]": 10' b.meta.json
that 'each column is explained' [ "$(head -n 1 b.csv | tr , '\n' | wc -l)" -eq \
    "$(sed -n '/"columns"/,/}/p' b.meta.json | grep -c '": "')" ]
if command -v gnuplot >/dev/null; then that 'there is a chart' grep -q '</svg>' b.svg; fi

# ---- a view ----

run bench flow splash --size 160x90 -o v.csv
that 'bench flow runs on a scene' [ $status -eq 0 ]
that 'every pixel takes its steps' \
    [ "$(awk -F, '$3 == "steps" { s += $7 } END { print (s > 0.999 && s < 1.001) }' v.csv)" = 1 ]
that 'curvatures stand before and after' [ "$(rows v.csv '$3 == "before" || $3 == "after"')" -eq 18 ]
that 'and fall' [ "$(awk -F, '$4 == 0.5 { k[$3] = $8 } END { print (k["after"] < 0.7 * k["before"]) }' v.csv)" = 1 ]
that 'the metadata has its parameters' grep -q '"adaptive_flow.radius": 10' v.meta.json
run bench flow splash --size 160x90 -p vanderlaan2009 --no-plot -o w.csv
that 'the other pipeline has a flow, too' [ "$(rows w.csv '$3 == "steps" && $4 == 40 && $7 == 1')" -eq 1 ]
that 'no chart is drawn that is not asked for' [ ! -e w.svg ]

# ---- errors ----

refuses 'it finds out at once where it cannot write' 'absent/b.csv' bench flow --quick -o absent/b.csv
refuses 'it needs a flow' 'no curvature flow ran' bench flow splash --size 64x36 -s adaptive_flow.off=1
refuses 'it knows its scenes' 'nowhere' bench flow nowhere
refuses 'a plane is before the eye' '--nearest' bench flow --nearest 0
run bench flow --help
that 'it explains itself' grep -q -- '--smoothing' out

finish
