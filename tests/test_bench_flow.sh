#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# test_bench_flow.sh: the bench of the curvature flows from outside: its two tables, metadata, charts, errors.
# shellcheck disable=SC2086,SC2016 # names are plain; awk expands its own

test=bench_flow
. "$(dirname "$0")/cases.sh"


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
whole_table b.csv

# ---- a view ----

run bench flow splash --size 160x90 -o v.csv
that 'bench flow runs on a scene' [ $status -eq 0 ]
that 'every pixel takes its steps' \
    [ "$(awk -F, '$4 == "steps" { s += $8 } END { print (s > 0.999 && s < 1.001) }' v.csv)" = 1 ]
that 'curvatures stand before and after' [ "$(rows v.csv '$4 == "before" || $4 == "after"')" -eq 18 ]
that 'and fall' [ "$(awk -F, '$5 == 0.5 { k[$4] = $10 } END { print (k["after"] < 0.7 * k["before"]) }' v.csv)" = 1 ]
that 'the metadata has its parameters' grep -q '"adaptive_flow.radius": 10' v.meta.json
that 'the fewest steps and the most are those of its pixels' [ "$(awk -F, '
    $4 == "steps" { if (!n++ || $5 < least) least = $5; if ($5 > most) most = $5 }
    $4 == "range" { range[$5] = $9 }
    END { print (range[0] == least && range[1] == most && least < most) }' v.csv)" = 1 ]
run bench flow splash --size 160x90 -p vanderlaan2009 --no-plot -o w.csv
that 'the other pipeline has a flow, too' [ "$(rows w.csv '$4 == "steps" && $5 == 40 && $8 == 1')" -eq 1 ]
that 'no chart is drawn that is not asked for' [ ! -e w.svg ]

# ---- several views ----

cat >tank.yaml <<EOS
title: A tank
radius: 0.04
particles: 1000
duration: 0.1
domain: {lo: [0, 0, 0], hi: [1, 1, 1]}
fluid: {pool: {lo: [0, 0, 0], hi: [1, 0.4, 1]}}
cameras: {near: {eye: [0.5, 1, 2.5], target: [0.5, 0.3, 0.5]}, far: {eye: [0.5, 3, 7], target: [0.5, 0.3, 0.5]}}
EOS
run bench flow --view a=tank.yaml,near,0 --view 5.2=tank.yaml,far,1 --cache . --size 96x54 -o views.csv
that 'it takes several views' [ $status -eq 0 ]
that 'each under its name' [ "$(cut -d, -f1 views.csv | sort -u | tr '\n' ' ')" = '5.2 a view ' ]
that 'with its scene and camera' [ "$(rows views.csv '$1 == "5.2" && ($2 != "tank.yaml" || $3 != "far")')" -eq 0 ]
that 'what is near takes more steps' \
    [ "$(awk -F, '$4 == "range" && $5 == 1 { n[$1] = $9 } END { print (n["a"] > n["5.2"]) }' views.csv)" = 1 ]
that 'the metadata has both' [ "$(grep -c '"scene": "tank.yaml"' views.meta.json)" -eq 2 ]

run bench flow --view a=tank.yaml,near,0 --cache . --size 96x54 --no-plot --pictures -o seen.csv
that 'it shows the pixels of a view' \
    [ "$(printf '%s ' seen_*)" = 'seen_a_after.png seen_a_before.png seen_a_steps.png ' ]
that 'before the flow they are others' sh -c '! cmp -s seen_a_before.png seen_a_after.png'

# ---- errors ----

refuses 'it finds out at once where it cannot write' 'absent/b.csv' bench flow --quick -o absent/b.csv
refuses 'it needs a flow' 'no curvature flow ran' bench flow splash --size 64x36 -s adaptive_flow.off=1
refuses 'it knows its scenes' 'nowhere' bench flow nowhere
refuses 'a view has all its parts' '--view a=splash: expected NAME=SCENE,CAMERA,FRAME' bench flow --view a=splash
refuses 'its frame is a number' 'expected NAME=SCENE,CAMERA,FRAME' bench flow --view a=tank.yaml,near,x
refuses 'its scene is known before the first is seen' 'nowhere' \
    bench flow --view a=tank.yaml,near,0 --view b=nowhere,near,0
refuses 'a scene stands alone' 'beside --view' bench flow splash --view a=tank.yaml,near,0
refuses 'pictures are of views' '--pictures: they are of views' bench flow --quick --pictures -o p.csv
refuses 'and stand beside a table' '--pictures: they are of views, and stand beside -o' bench flow splash --pictures
refuses 'a plane is before the eye' '--nearest' bench flow --nearest 0
run bench flow --help
that 'it explains itself' grep -q -- '--smoothing' out

finish
