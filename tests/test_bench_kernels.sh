#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# test_bench_kernels.sh: the table of roots and splat kernels from outside: what its curves are.
# shellcheck disable=SC2086,SC2016 # names are plain; awk expands its own

test=bench_kernels
. "$(dirname "$0")/cases.sh"

# most FILE EXPRESSION: the largest error without its sign among these rows, to four digits.
most() { awk -F, "NR > 1 && ($2) { e = \$8 < 0 ? -\$8 : \$8; if (e > m) m = e } END { printf \"%.4f\", m }" "$1"; }

run bench kernels -o k.csv
that 'bench kernels runs' [ $status -eq 0 ]
that 'without a complaint' [ ! -s err ]
that 'it prints where curves are farthest from exact' grep -Eq '^fig4_3	ramp	0	0.00197	-0.02218' out
that 'all went well' [ "$(rows k.csv '$5 != "ok"')" -eq 0 ]
that 'no row is twice there' [ "$(cut -d, -f 1-4 k.csv | sort | uniq -d | wc -l)" -eq 0 ]
that 'the ramp is off by a quarter of its first step' [ "$(most k.csv '$1 == "fig4_3" && $2 == "ramp"')" = 0.0222 ]
that 'as printed by a sixteenth' [ "$(most k.csv '$1 == "fig4_3" && $2 == "ramp_printed"')" = 0.0624 ]
that 'exact roots are exact' [ "$(most k.csv '$1 == "fig4_3" && $2 == "exact"')" = 0.0000 ]
that 'the printed kernel keeps 51 % of a sphere' \
    [ "$(rows k.csv '$2 == "exponential" && $9 > 0.509 && $9 < 0.511')" -eq 101 ]
that 'e^(-2 r) 34 %' [ "$(rows k.csv '$2 == "exponential_r" && $9 > 0.342 && $9 < 0.344')" -eq 101 ]
that 'the chord all' [ "$(rows k.csv '$2 == "chord" && $9 > 0.99999 && $9 < 1.00001')" -eq 101 ]
that 'kernels fall outwards' \
    [ "$(awk -F, '$1 == "fig4_13" { n += $2 == k && $6 > v; k = $2; v = $6 } END { print n + 0 }' k.csv)" -eq 0 ]
that 'foam has a row at five lifetimes' [ "$(awk -F, '$1 == "fig4_15" { print $3 }' k.csv | sort -u | wc -l)" -eq 5 ]
that 'which differ' \
    [ "$(awk -F, '$1 == "fig4_15" && $2 == "exact" && $4 == 0 { print $6 }' k.csv | sort -u | wc -l)" -eq 5 ]
that 'the texture is near the noise' [ "$(rows k.csv '$2 == "texture" && ($8 > 0.02 || $8 < -0.02)')" -eq 0 ]
whole_table k.csv
cp k.csv before.csv
accepts 'a second time' bench kernels -o k.csv --no-plot
that 'gives the same' cmp -s k.csv before.csv

# as on a full disk
(trap '' XFSZ; ulimit -f 8; "$ssfr" bench kernels -o k.csv --no-plot >out 2>err)
that 'a table that does not fit is told of' [ $? -eq 2 ]
that 'in one line' [ "$(grep -c 'k.csv.*: File too large$' err)" -eq 1 ]
that 'and the one before stays' cmp -s k.csv before.csv
that 'with nothing beside it' [ "$(ls k.csv*)" = k.csv ]

refuses 'it finds out at once where it cannot write' 'absent/k.csv' bench kernels -o absent/k.csv
refuses 'it takes no pipeline' 'vanderlaan2009' bench kernels vanderlaan2009
run bench kernels --help
that 'it explains itself' grep -q 'square-root ramp' out

finish
