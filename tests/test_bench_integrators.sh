#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# test_bench_integrators.sh: the bench of integrators from outside: what its table holds, gone on with, errors.
# shellcheck disable=SC2086,SC2016 # names are plain; awk expands its own

test=bench_integrators
. "$(dirname "$0")/cases.sh"

cat >study.yaml <<'END'
title: Two kinds of rays
scenes: [block]
size: [64, 64]
extinction: {support: 2}
candidates: 100
density:
  deep: {count: 2, content: [8, 100], regions: [1, 1]}
  rim: {count: 1, content: [0, 0.5], order: most}
radiance:
  dense: {count: 1, order: most}
integrators: [chords, qags, qagp, cquad, gauss, steps]
tolerances: [1e-2, 1e-10]
points: [2, 8]
steps: [32, 512]
END
keys='NR > 1 { print $1 FS $2 FS $3 FS $4 FS $5 }'

# ---- what it measures ----

run bench integrators study.yaml -o i.csv
that 'bench integrators runs' [ $status -eq 0 ]
that 'without a complaint' [ ! -s err ]
that 'it prints the best setting of each rule' [ "$(grep -c '^block	density	deep	' out)" -eq 6 ]
that 'a row for each rule, setting and kind of rays' [ "$(rows i.csv)" -eq $((2 * 11 + 12)) ]
that 'none of which failed' [ "$(rows i.csv '$6 == "ok"')" -eq "$(rows i.csv)" ]
that 'all of one width' [ "$(awk -F, '{ print NF }' i.csv | sort -u)" = 21 ]
that 'each ray took time' [ "$(rows i.csv '$10 > 0 && $13 >= 5')" -eq "$(rows i.csv)" ]
that 'the number of rays is that of the study' [ "$(rows i.csv '$7 == ($3 == "deep" ? 2 : 1)')" -eq "$(rows i.csv)" ]
that 'references are exact' [ "$(rows i.csv '$21 < 1e-12')" -eq "$(rows i.csv)" ]
that 'eight points between break points are' [ "$(rows i.csv '$4 == "gauss" && $5 == 8 && $16 < 1e-6')" -eq 3 ]
that 'so is qagp, whatever is asked' [ "$(rows i.csv '$4 == "qagp" && $16 < 1e-8')" -eq 6 ]
that 'many steps are better than few' [ "$(awk -F, '$4 == "steps" && $5 == 32 { few[$2, $3] = $16 }
    $4 == "steps" && $5 == 512 && $16 < 0.02 * few[$2, $3] { n++ } END { print n }' i.csv)" -eq 3 ]
that 'and they are counted a ray' [ "$(rows i.csv '$4 == "steps" && $5 == 512 && $15 == 768')" -eq 3 ]
that 'so are kernels, each with two break points or more' \
    [ "$(rows i.csv '$4 == "gauss" && $5 == 2 && $15 / 3 > 2 * $8 - 2 && $15 / 3 < 5 * $8 + 2')" -eq 3 ]
that 'the fastest of what is exact enough is printed' [ "$(awk -F, 'NR > 1 && $16 <= 1e-6 {
    k = $1 "\t" $2 "\t" $3 "\t" $4 "\t"; if (!(k in us) || $10 < us[k]) { us[k] = $10; best[k] = k $5 } }
    END { for (k in best) print best[k] }' i.csv | while IFS= read -r row; do grep -c "^$row	" out; done |
    sort | uniq -c | tr -s ' ')" = " $(awk -F, 'NR > 1 && $16 <= 1e-6 { seen[$1, $2, $3, $4] }
    END { for (k in seen) n++; print n }' i.csv) 1" ]
that 'no error is below what its reference is known to' [ "$(rows i.csv '$16 >= $21 && $16 > 2.2e-16')" -eq "$(rows i.csv)" ]
that 'two rules judge a radiance' [ "$(rows i.csv '$2 == "radiance" && $21 > 0')" -eq 12 ]
that 'whose colours mix' [ "$(rows i.csv '$2 == "radiance" && $4 == "chords" && $15 > 0')" -eq 2 ]
that 'closed forms have no setting' [ "$(rows i.csv '$2 == "density" && $4 == "chords" && $5 == "-"')" -eq 2 ]
that 'closed forms call nothing' [ "$(rows i.csv '$2 == "density" && $4 == "chords" && $15 == 0 && $16 < 1e-12')" -eq 2 ]
that 'what a rule claims is mostly enough' [ "$(rows i.csv '$20 > 0')" -le 3 ]
that 'the metadata tell the study' grep -q '"study": "title: Two kinds of rays' i.meta.json
that 'and its parameters' grep -q '"truth.kind": "density"' i.meta.json
that 'each column is explained' [ "$(sed -n '/"columns"/,/}/p' i.meta.json | grep -c '": "')" -eq 21 ]
if command -v gnuplot >/dev/null; then that 'the chart is drawn' grep -q 'integral of density along rim rays' i.svg; fi

# ---- gone on with ----

cp i.csv whole.csv
run bench integrators study.yaml -o i.csv --resume --no-plot
that 'a whole table needs no run' [ $status -eq 0 ]
that 'and stays as it was' cmp -s i.csv whole.csv
awk -F, "$keys" whole.csv | sort >keys
for share in 0 35 99; do
    head -c $(($(wc -c <whole.csv) * share / 100)) whole.csv >i.csv
    run bench integrators study.yaml -o i.csv --resume --no-plot
    that "a table that is cut at $share % is made whole" [ $status -eq 0 ]
    awk -F, "$keys" i.csv | sort >again
    that 'with each row once' cmp -s again keys
done
sed 's/count: 1/count: 2/' study.yaml >other.yaml
refuses 'rows of two studies do not mix' 'i.csv: was measured with other settings' \
    bench integrators other.yaml -o i.csv --resume
refuses 'going on needs a table' '--resume needs' bench integrators study.yaml --resume

# ---- stopped ----

sed 's/candidates: 100/candidates: 20000/; s/scenes:.*/scenes: [splash]/' study.yaml >long.yaml
stops s.csv 3 bench integrators long.yaml -o s.csv

# ---- what cannot be measured ----

sed 's/content: \[8, 100\]/content: [2000, 3000]/' study.yaml >none.yaml
run bench integrators none.yaml -o n.csv --no-plot
that 'kinds without a ray are told in their rows' [ "$(grep -c 'none of [0-9]* rays .* is deep' n.csv)" -eq 11 ]
that 'and the rest is measured' [ "$(grep -c ',ok,' n.csv)" -eq 23 ]
sed 's/scenes:.*/scenes: [absent.ply, block]/' study.yaml >absent.yaml
run bench integrators absent.yaml -o a.csv --no-plot
that 'so are scenes that are not there' [ "$(grep -c '^absent.ply,.*absent.ply: ' a.csv)" -eq 34 ]
that 'and the next is measured' [ "$(grep -c '^block,.*,ok,' a.csv)" -eq 34 ]

# ---- errors ----

refuses 'it finds out at once where it cannot write' 'absent/i.csv' bench integrators study.yaml -o absent/i.csv
refuses 'a study must be there' 'nothing.yaml' bench integrators nothing.yaml
echo 'steps: [0]' >bad.yaml
refuses 'a bad study is refused with its place' 'bad.yaml:1:9: steps: 0 is out of range' bench integrators bad.yaml
refuses 'it takes one study' 'study.yaml' bench integrators study.yaml study.yaml
run bench integrators --help
that 'it explains itself' grep -q 'integrators.yaml' out

finish
