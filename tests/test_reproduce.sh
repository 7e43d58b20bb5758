#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# test_reproduce.sh: reproducing from outside: a tiny paper in a folder, killed and gone on with, and those built in.
# shellcheck disable=SC2086,SC2012,SC2015 # variables hold several options; names are plain

test=reproduce
. "$(dirname "$0")/cases.sh"

cells() { column "$@" | tr '\n' ' '; }
# holds ID: what claims.csv says of a claim.
holds() { sed -n "s/^$1,.*,\(yes\|no\|not measured\),[^,]*\$/\1/p" results/claims.csv; }

brief="--max-time 0.001"

# ---- a paper in a folder ----

mkdir -p experiments/tiny/published experiments/other experiments/no_paper
cat >experiments/tiny/tab1.yaml <<'END'
title: Steps of a block
scene: block
size: 48x32
backend: cpu
vary: {curvature_flow.iterations: 0:4:2}
plot: {x: curvature_flow.iterations, y: ms_median, lines: [backend]}
published: {file: tab1.csv, on: {place: scene, steps: curvature_flow.iterations}, column: ms}
END
printf 'place,steps,ms\nblock,0,14\nblock,2.0,15.50\nrock,4,16\n' >experiments/tiny/published/tab1.csv
cat >experiments/tiny/fig2.yaml <<'END'
scene: block
size: 48x32
backend: cpu
vary: {curvature_flow.step: 0.5}
quick: {title: Smaller still, size: 16x8, set: {curvature_flow.iterations: 3}, vary: {curvature_flow.step: "0.5,0.7"}}
END
cat >experiments/tiny/claims.yaml <<'END'
- id: work
  where: Tab. 1
  statement: steps are work
  published: a little
  rule: monotone(tab1.taps, tab1.curvature_flow.iterations) == 1
- id: none
  where: Tab. 1
  statement: steps are free
  rule: slope(tab1.taps, tab1.curvature_flow.iterations) <= 0
- {id: later, where: Fig. 3, statement: to be measured, rule: max(fig3.ms) < 1}
- {id: slower, where: Tab. 1, statement: than published, rule: min(tab1.published_ms) >= 14}
END
echo '[]' >experiments/other/claims.yaml
cp experiments/tiny/fig2.yaml experiments/no_paper/

leaves 0 'what is in the folders is listed' reproduce --list
printf 'paper\titem\ttitle\truns\ntiny\tfig2\tSmaller still\t2\ntiny\ttab1\tSteps of a block\t3\n' >wanted
that 'with titles and runs' cmp -s out wanted
leaves 0 'so it is at full scale' reproduce --list --scale full
that 'where runs may differ' grep -q '^tiny	fig2		1$' out
leaves 0 'one item is listed' reproduce --list tiny/tab1
that 'alone' [ "$(lines out)" -eq 2 ]
that 'a list writes nothing' [ ! -e results ]

leaves 0 'an item is reproduced' reproduce tiny/tab1 $brief
that 'alone' [ "$(ls results/tiny | tr '\n' ' ')" = 'tab1.csv tab1.meta.json tab1.svg ' ]
that 'with all its runs' [ "$(cells results/tiny/tab1.csv status)" = 'ok ok ok ' ]
that 'at half the width' [ "$(column results/tiny/tab1.csv width | sort -u)" = 24 ]
that 'and height' [ "$(column results/tiny/tab1.csv height | sort -u)" = 16 ]
that 'the published numbers stand beside, as printed' \
    [ "$(column results/tiny/tab1.csv published_ms)" = "$(printf '14\n15.50\n')" ]
that 'and a row without a partner has an empty cell' [ "$(tail -n 1 results/tiny/tab1.csv | grep -c ',$')" -eq 1 ]
that 'its metadata say at which scale' grep -q '"scale": "quick"' results/tiny/tab1.meta.json
that 'claims are held to it' [ "$(holds work) $(holds none) $(holds slower)" = 'yes no yes' ]
that 'what has no table is not measured' [ "$(holds later)" = 'not measured' ]
that 'which is said' grep -q '^tiny	later	-	-	not measured	there is no table fig3$' out
that 'and all is printed' [ "$(lines out)" -eq 5 ]

cp results/tiny/tab1.csv before.csv
leaves 0 'the paper is gone on with' reproduce tiny $brief
that 'rows that are there stay' cmp -s before.csv results/tiny/tab1.csv
that 'what quick says counts' [ "$(cells results/tiny/fig2.csv width)" = '16 16 ' ]
that 'its settings, too' grep -q '"curvature_flow.iterations": 3' results/tiny/fig2.meta.json
cp experiments/tiny/tab1.yaml keep.yaml
sed 's/0:4:2/0:4:4/' keep.yaml >experiments/tiny/tab1.yaml
accepts 'an item may have lost a run since' reproduce tiny/tab1 $brief
that 'whose row stays' cmp -s before.csv results/tiny/tab1.csv
that 'which is said' grep -q 'warning: results/tiny/tab1.csv: rows of runs that its item has no more: 1; ' err
mv keep.yaml experiments/tiny/tab1.yaml
leaves 0 'it can be measured anew' reproduce tiny/tab1 $brief --anew
that 'to as many rows' [ "$(lines results/tiny/tab1.csv)" -eq 4 ]
that 'which are others' sh -c '! cmp -s before.csv results/tiny/tab1.csv'
leaves 0 'full scale goes elsewhere' reproduce tiny $brief --scale full -o full
that 'with its own size' [ "$(cells full/tiny/fig2.csv width)" = '48 ' ]
that 'and its name' grep -q '"scale": "full"' full/tiny/fig2.meta.json
refuses 'scales are not mixed' 'tab1.csv: was measured with other settings' reproduce tiny/tab1 $brief -o full
that 'and the table is named' grep -q '^ssfr reproduce: full/tiny/tab1.csv: ' err
that 'and what may be done' grep -q 'at another scale: nothing to resume; measure it anew, or elsewhere with -o$' err
rm -r full

# ---- claims alone ----

printf 'status,ms\nok,0.5\n' >results/tiny/fig3.csv
cp results/tiny/tab1.csv before.csv
rm results/tiny/fig2.csv
leaves 0 'tables that are there are held to claims' reproduce tiny --claims
that 'as they are' [ "$(holds later)" = yes ]
that 'and nothing is measured' [ ! -e results/tiny/fig2.csv ]
that 'nor changed' cmp -s before.csv results/tiny/tab1.csv
sed -i 's/^later,tiny/later,elsewhere/' results/claims.csv
run reproduce --claims
that 'rows of other papers stay' grep -q '^later,elsewhere,' results/claims.csv
that 'and own ones are made anew' [ "$(lines results/claims.csv)" -eq 6 ]

# ---- figures alone ----

mkdir -p drawn/tiny
printf 'curvature_flow.iterations,backend,status,ms_median\n1,cpu,ok,1\n2,cpu,ok,2.5\n' >drawn/tiny/tab1.csv
cp drawn/tiny/tab1.csv before.csv
leaves 0 'figures are drawn of tables that are there' reproduce tiny --figures -o drawn
if command -v gnuplot >/dev/null; then
    that 'as the sweep asks for them' grep -q 'Steps of a block' drawn/tiny/tab1.svg
fi
that 'the table stays' cmp -s before.csv drawn/tiny/tab1.csv
that 'and nothing is measured' [ ! -e drawn/tiny/fig2.csv ]
sed -i 's/ms_median/ms_least/' drawn/tiny/tab1.csv
refuses 'a table without the column is told' 'the table has no column ms_median' reproduce tiny --figures -o drawn
rm -r drawn

# ---- killed, stopped, and gone on with ----

cat >experiments/other/long.yaml <<'END'
{scene: block, size: 48x32, backend: cpu, vary: {curvature_flow.iterations: 0:29:1}}
END
for signal in KILL TERM; do
    "$ssfr" reproduce other --max-time 0.05 2>err >out &
    child=$!
    had=$(lines results/other/long.csv)
    wait_for 10 has_lines results/other/long.csv $((had + 3))
    kill -$signal $child
    wait $child 2>/dev/null
    status=$?
    that "it ends by $signal" [ $status -ne 0 ]
    that 'before all is done' [ "$(lines results/other/long.csv)" -lt 31 ]
done
that 'being stopped is an error' [ $status -eq 2 ]
that 'which says how to go on' grep -q \
    '^ssfr reproduce: other/long, 1 of 1: interrupted after [0-9]* of [0-9]* runs; the same command goes on' err
that 'in one line' [ "$(lines err)" -eq 1 ]
leaves 0 'the same command goes on' reproduce other --max-time 0.05
that 'to every row once' [ "$(sed 1d results/other/long.csv | cut -d, -f1 | sort -nu | wc -l)" -eq 30 ]
that 'and no more' [ "$(lines results/other/long.csv)" -eq 31 ]
"$ssfr" reproduce other --max-time 0.2 --anew 2>err >out &
child=$!
tries=0
while [ $tries -lt 200 ] && [ "$(lines results/other/long.csv)" -eq 31 ]; do sleep 0.05; tries=$((tries + 1)); done
kill -TERM $child
wait $child 2>/dev/null
that 'what is measured anew would begin again' grep -q '; the same command without --anew goes on from there$' err

# ---- items that are other commands ----

mkdir -p experiments/made/published
echo '[]' >experiments/made/claims.yaml
printf 'pass,ms\ncomposite,3.50\n(frame),19\n' >experiments/made/published/shares.csv
small='--backend, cpu, --size, 24x16, --threads, 1'
cat >experiments/made/bench.yaml <<END
title: Shares of passes
command: [bench, vanderlaan2009, --scene, splash]
published: {file: shares.csv, on: {pass: node}, column: ms}
quick: {title: Shares of passes at once, command: [bench, vanderlaan2009, --scene, block, $small, --max-time, 0.001]}
END
cat >experiments/made/pictures.yaml <<END
title: Two to look at
args: [$small]
pictures:
  - {name: usual, args: [block]}
  - {name: rough, args: [block, -s, curvature_flow.iterations=0]}
END
leaves 0 'other items are listed' reproduce --list made
that 'with their steps' [ "$(sed 1d out | cut -f2-4 | tr '\n' '	')" = \
    'bench	Shares of passes at once	1	pictures	Two to look at	2	' ]
leaves 0 'they are made' reproduce made
printf '%s ' bench.csv bench.made.txt bench.meta.json pictures pictures.made.txt pictures/rough.png \
    pictures/usual.png >wanted
that 'each what it is' [ "$(cd results/made && printf '%s ' * */*)" = "$(cat wanted)" ]
that 'what commands print is not seen' [ "$(lines out)" -eq 1 ]
that 'with the published numbers beside' \
    [ "$(grep -c ',3.50$' results/made/bench.csv) $(grep '(frame),' results/made/bench.csv | grep -c ',19$')" = '1 1' ]
that 'and a record of what was done' \
    grep -qx 'rough: ssfr render block -s curvature_flow.iterations=0 --backend cpu .*' results/made/pictures.made.txt
that 'by which build, at which scale and on what machine' \
    grep -q '^[0-9a-f]\{16\} ssfr [0-9.]*, commit .*, quick, [0-9]* threads of ..*' results/made/pictures.made.txt
# fresh: what was made since it was touched.
fresh() { find results/made -newermt 2002-01-01 \( -name '*.csv' -o -name '*.png' \) | sort | tr '\n' ' '; }
touch -d '2001-01-01' results/made/bench.csv results/made/pictures/*.png
rm results/made/pictures/usual.png
leaves 0 'what is missing is made' reproduce made
that 'and what is there stays' [ "$(fresh)" = 'results/made/pictures/usual.png ' ]
sed -i '/^rough:/d' results/made/pictures.made.txt
leaves 0 'what was not noted was not finished' reproduce made/pictures
that 'and is made again' [ "$(fresh)" = 'results/made/pictures/rough.png results/made/pictures/usual.png ' ]
refuses 'scales are not mixed here either' 'results/made/pictures.made.txt: was made by other commands' \
    reproduce made/pictures --scale full
sed -i 's/3.50/3.75/' experiments/made/published/shares.csv
refuses 'nor published numbers' 'results/made/bench.made.txt: was made by other commands' reproduce made/bench
leaves 0 'which stand beside it anew' reproduce made/bench --anew
that 'as they are now' grep -q ',3.75$' results/made/bench.csv
cp experiments/made/pictures.yaml keep.yaml
sed -i 's/iterations=0/iterations=1/' experiments/made/pictures.yaml
refuses 'nor are recipes' 'results/made/pictures.made.txt: was made by other commands' reproduce made/pictures
sed 's/rough/raw/; s/iterations=1/iterations=0/' experiments/made/pictures.yaml >broken.yaml
cp experiments/made/pictures.yaml other.yaml && mv broken.yaml experiments/made/pictures.yaml
refuses 'nor pictures of other names' 'results/made/pictures.made.txt: was made by other' reproduce made/pictures
mv other.yaml experiments/made/pictures.yaml
cp results/made/pictures/rough.png before.png
leaves 0 'which can be made anew' reproduce made/pictures --anew
that 'to other pictures' sh -c '! cmp -s before.png results/made/pictures/rough.png'
sed 's/=1/=-1/' experiments/made/pictures.yaml >broken.yaml && mv broken.yaml experiments/made/pictures.yaml
refuses 'a command that cannot run says why' 'curvature_flow.iterations=-1: out of range' reproduce made/pictures --anew
that 'what was done before stays' [ -e results/made/pictures/usual.png ]
mv keep.yaml experiments/made/pictures.yaml
sed -i 's/pass: node/pass: nodes/' experiments/made/bench.yaml
refuses 'what cannot be joined is told' 'published: results/made/bench.csv has no column nodes' \
    reproduce made/bench --anew
sed -i 's/vanderlaan2009, --scene, block/nothing/' experiments/made/bench.yaml
refuses 'so is a pipeline that is none' 'nothing: no such pipeline' reproduce made/bench --anew
echo 'command: [passes, composite]' >experiments/made/bench.yaml
refuses 'a command must know where to write' 'unknown option' reproduce made/bench --anew
echo "command: [bench, vanderlaan2009, --scene, block, $small, --max-time, 0.001]" >experiments/made/bench.yaml
leaves 0 'once that is mended it goes on: nothing was made by other words' reproduce made/bench
that 'and is on record' [ "$(grep -c . results/made/bench.made.txt)" -eq 2 ]
sed -i 's/rough/usual/' experiments/made/pictures.yaml
refuses 'what is malformed is found out before anything runs' 'pictures.yaml:5:5: the name usual stands twice' \
    reproduce --anew
echo 'command: [bench, --help]' >experiments/made/bench.yaml
rm results/made/bench.csv
refuses 'and to write' 'reproduce: ssfr bench: left no results/made/bench.csv' reproduce made/bench --anew
rm -r experiments/made before.png

# ---- what a command is told is of it alone ----

mkdir experiments/told
echo '[]' >experiments/told/claims.yaml
echo "command: [bench, vanderlaan2009, --scene, block, --quiet, $small, --max-time, 0.001]" >experiments/told/a.yaml
cp experiments/tiny/fig2.yaml experiments/told/b.yaml
run reproduce told $brief --verbose
that 'it speaks as it was told to, after a command that is quiet' grep -q '^ssfr reproduce: 2 of 2 runs' err
run reproduce told/b $brief -o alone
threads() { grep '"threads":' "$1"; }
that 'and has as many threads as by itself' \
    [ "$(threads results/told/b.meta.json)" = "$(threads alone/told/b.meta.json)" ]
rm -r experiments/told alone

# ---- errors: one line, and nothing half-written ----

rm -r results
refuses 'an unknown paper is named, with those there are' 'tin: no such paper; there are other, tiny' reproduce tin
refuses 'so is an unknown item' 'tiny/tab2: no such item; tiny has fig2, tab1' reproduce tiny tiny/tab2
refuses 'and one without a name' 'tiny/: no such item' reproduce tiny/
refuses 'claims are no item' 'tiny/claims: no such item' reproduce tiny/claims
refuses 'a scale is one of two' '--scale huge: expected quick|full' reproduce --scale huge
for item in my-item 5_1 'a b' a.b; do
    cp experiments/tiny/fig2.yaml "experiments/tiny/$item.yaml"
    refuses "an item is not called $item, which rules cannot name" \
        "experiments/tiny/$item.yaml: an item's name is letters, digits and _" reproduce --list
    rm "experiments/tiny/$item.yaml"
done
cp experiments/tiny/claims.yaml keep.yaml
sed 's/<= 0/<= /' keep.yaml >experiments/tiny/claims.yaml
refuses 'a rule that is none has its place' 'experiments/tiny/claims.yaml:9:60: expected a number' reproduce tiny/fig2
cp keep.yaml experiments/tiny/claims.yaml
cp experiments/tiny/tab1.yaml keep.yaml
broken() { sed "$1" keep.yaml >experiments/tiny/tab1.yaml; }
broken 's/vary/very/'
refuses 'so has a sweep that is none' 'experiments/tiny/tab1.yaml:5:1: no key very' reproduce tiny
broken 's/y: ms_median/y: ms_medium/'
refuses 'a figure that cannot be drawn is found out at once' \
    'experiments/tiny/tab1.yaml:6:1: plot: the table will have no column ms_medium' reproduce tiny
broken 's/0:4:2/-2:4:2/'
refuses 'so is a value that is out of range' 'curvature_flow.iterations=-2: out of range' reproduce tiny
broken 's/tab1.csv/tab9.csv/'
refuses 'published numbers must be there' 'experiments/tiny/published/tab9.csv' reproduce tiny
broken 's/column: ms/column: s/'
refuses 'with the column' 'tab1.yaml:7:1: published: experiments/tiny/published/tab1.csv has no column s' \
    reproduce tiny
broken 's/place: scene/plaice: scene/'
refuses 'and those that they are joined by' 'tab1.csv has no column plaice' reproduce tiny
broken 's/place: scene/place: scenery/'
refuses 'on both sides' 'tab1.yaml:7:1: published: no key scenery tells the rows' reproduce tiny/tab1
broken 's/, steps: curvature_flow.iterations//'
refuses 'which must tell their rows apart' 'rows 1 and 2 of experiments/tiny/published/tab1.csv have the same place' \
    reproduce tiny
cp keep.yaml experiments/tiny/tab1.yaml
rm -rf results
: >results
refuses 'a file is no folder' 'reproduce: results: File exists' reproduce tiny/tab1
rm results
refuses 'a folder must have its own' 'absent/results: No such file' reproduce tiny/tab1 -o absent/results
that 'nothing is left of all this' [ ! -e results ]
leaves 0 'a sweep by itself has the published numbers, too' sweep experiments/tiny/tab1.yaml $brief
that 'beside its own' [ "$(column out published_ms | head -n 2 | tr '\n' ' ')" = '14 15.50 ' ]

# links in a circle, for root may look into all folders
mkdir closed && cd closed || exit 2
ln -s experiments experiments
refuses 'papers that cannot be looked into are not those of the program' 'experiments: ' reproduce --list
rm experiments
mkdir -p experiments/tiny
ln -s claims.yaml experiments/tiny/claims.yaml
refuses 'nor is one of them left out' 'experiments/tiny/claims.yaml: ' reproduce --list
cd .. && rm -r closed

# ---- from anywhere: what was built in ----

names() {
    for file in "$here"/../experiments/*/claims.yaml; do
        for item in "${file%/*}"/*.yaml; do basename "$item" .yaml; done
    done | grep -vx claims
}
mkdir elsewhere && cd elsewhere || exit 2
leaves 0 'without papers here, those of the program are listed' reproduce --list
that 'with their items' grep -q '^vanderlaan2009	truth	' out
that 'all of the source tree' [ "$(sed 1d out | cut -f2 | sort)" = "$(names | sort)" ]
leaves 0 'their claims are known' reproduce vanderlaan2009 --claims
that 'without tables not measured' \
    [ "$(grep -c ',not measured,' results/claims.csv)" -eq "$(($(wc -l <results/claims.csv) - 1))" ]
cd .. || exit 2

finish
