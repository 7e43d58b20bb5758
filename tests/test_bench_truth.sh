#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# test_bench_truth.sh: the bench of ray casting from outside: what its table holds, stopped and gone on with, errors.
# shellcheck disable=SC2086,SC2016 # names are plain; awk expands its own

test=bench_truth
. "$(dirname "$0")/cases.sh"

# ---- what it measures ----

run bench truth --quick -o b.csv --threads 2
that 'bench truth runs' [ $status -eq 0 ]
that 'without a complaint' [ ! -s err ]
that 'it prints rays for people' grep -Eq '^finer	density	1000	1	[0-9]+	[0-9.]+	[0-9]+	' out
that 'no row failed' [ "$(column b.csv status | sort -u)" = ok ]
that 'each continuum is measured at both sizes with one thread and two' [ "$(rows b.csv '$1 == "finer"')" -eq 16 ]
that 'and more of the same water, too' [ "$(rows b.csv '$1 == "wider"')" -eq 4 ]
that 'each took time' [ "$(rows b.csv '$16 > 0 && $19 > 0 && $25 > 0')" -eq 20 ]
that 'no image is measured whole' [ "$(column b.csv whole | sort -u)" = 0 ]
that 'a particle takes less than 300 bytes' [ "$(rows b.csv '$26 > 24 && $26 < 300')" -eq 20 ]
that 'shares of the time add up' [ "$(rows b.csv '$22 + $23 + $24 > 0.999 && $22 + $23 + $24 < 1.001')" -eq 20 ]
that 'an image has its pixels' [ "$(rows b.csv '$25 * $19 / 921600 > 0.999 && $25 * $19 / 921600 < 1.001')" -eq 20 ]
that 'a ray its kernels' [ "$(rows b.csv '$21 * $11 / $20 > 999 && $21 * $11 / $20 < 1001')" -eq 20 ]
that 'threads change nothing that is counted' [ "$(cut -d, -f 1-3,8,10-14 b.csv | sed 1d | sort -u | wc -l)" -eq 10 ]
that 'the metadata has the parameters' grep -q '"truth.level": 0.5' b.meta.json
that 'and those of stretched kernels' grep -q '"anisotropy.k_r"' b.meta.json
that 'words as words' grep -q '"truth.kernel": "cubic_spline"' b.meta.json
that 'a column is none' [ "$(grep -c '"truth.kind"' b.meta.json)" -eq 0 ]
whole_table b.csv

# ---- gone on with ----

cp b.csv whole.csv
run bench truth --quick -o b.csv --resume --no-plot --threads 2
that 'a whole table needs no run' [ $status -eq 0 ]
that 'and stays as it was' cmp -s b.csv whole.csv
for share in 1 30 99; do
    head -c $(($(wc -c <whole.csv) * share / 100)) whole.csv >b.csv
    run bench truth --quick -o b.csv --resume --no-plot --threads 2
    that "a table that is cut at $share % is made whole" [ $status -eq 0 ]
    that "with every row once ($share %)" [ "$(cut -d, -f 1-4 b.csv | sort -u | wc -l)" -eq 21 ]
    cut -d, -f 1-14 b.csv | sort >again
    cut -d, -f 1-14 whole.csv | sort >before
    that "and what is counted is the same ($share %)" cmp -s again before
done
refuses 'a longer table is not gone on with' 'b.csv: was measured with other settings' \
    bench truth -o b.csv --resume --threads 2
rm ./b.* ./whole.csv ./again ./before

# ---- stopped ----

stops s.csv 2 bench truth -o s.csv --max-particles 5000
rm ./s.*

# ---- errors ----

refuses 'it finds out at once where it cannot write' 'absent/b.csv' bench truth --quick -o absent/b.csv
refuses 'going on needs a table' '--resume needs' bench truth --quick --resume
refuses 'it takes no pipeline' 'vanderlaan2009' bench truth vanderlaan2009
refuses 'it measures some particles at least' '--max-particles' bench truth --max-particles 0
run bench truth --help
that 'it explains itself' grep -q -- '--max-particles' out

finish
