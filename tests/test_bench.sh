#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# test_bench.sh: timing a pipeline from outside: its table, stages, views of a path, and what it allocates.
# shellcheck disable=SC2086,SC2016 # names are plain; awk expands its own

test=bench
. "$(dirname "$0")/cases.sh"

XDG_CACHE_HOME=$work/cache
export XDG_CACHE_HOME
brief='--size 64x48 --backend cpu --quick --max-time 0.001'
cat >drop.yaml <<END
title: A drop that is looked at from a path
radius: 0.05
particles: 400
duration: 0.2
frame_rate: 20
domain: {lo: [0, 0, 0], hi: [1, 1, 1]}
fluid:
  drop: {lo: [0.3, 0.1, 0.3], hi: [0.7, 0.5, 0.7]}
cameras:
  default:
    target: [0.5, 0.3, 0.5]
    keys: [{time: 0, eye: [0.5, 0.8, 3]}, {time: 0.1, eye: [2, 0.8, 2]}]
  late:
    target: [0.5, 0.3, 0.5]
    keys: [{time: 0, eye: [0.5, 0.8, 3]}, {time: 9, eye: [2, 0.8, 2]}]
  still: {eye: [0.5, 0.8, 3], target: [0.5, 0.3, 0.5]}
END

# sums A B: two numbers are the same but for what is rounded.
same() { awk -v a="$1" -v b="$2" 'BEGIN { exit !(a > 0 && a - b <= 1e-4 * b && b - a <= 1e-4 * b) }'; }
total() { awk '{ s += $1 } END { print s }'; }

# ---- one view ----

run bench bagar2010 --scene drop.yaml $brief -o b.csv
that 'bench runs' [ $status -eq 0 ]
that 'and prints each node' [ "$(grep -c '^[a-z_]*	ran	\|^[a-z_]*	needless\|^[a-z_]*	unwanted' out)" -eq 16 ]
that 'it is view 0' [ "$(column b.csv view | sort -u)" = 0 ]
that 'the columns are known' [ "$(head -n 1 b.csv)" = "$(printf %s 'scene,pipeline,backend,width,height,view,' \
    'node,pass,stage,status,why,ms_min,ms_median,ms_mad,ms_kept,runs,outliers,share,taps,iterations,vertices,' \
    'bytes [B],roofline,tiles,unstable')" ]
that 'each is explained' [ "$(head -n 1 b.csv | tr , '\n' | wc -l)" -eq \
    "$(sed -n '/"columns"/,/}/p' b.meta.json | grep -c '": "')" ]
that 'stages are rows' [ "$(column b.csv stage 'cell("node") == "(stage)"' | sort | tr '\n' ' ')" = \
    'adaptive_curvature_flow composite_and_update depth_passes thickness_passes ' ]
that 'whose shares make one' same "$(column b.csv share 'cell("node") == "(stage)"' | total)" 1
for stage in depth_passes composite_and_update; do
    that "$stage is the sum of its nodes" same \
        "$(column b.csv ms_median 'cell("node") == "(stage)" && cell("stage") == "'$stage'"')" \
        "$(column b.csv ms_median 'cell("node") !~ /[(]/ && cell("status") == "ran" && cell("stage") == "'$stage'"' |
            total)"
done
that 'values of particles count in their stage, and are told' same \
    "$(column b.csv ms_kept 'cell("node") == "(stage)" && cell("stage") == "composite_and_update"')" \
    "$(column b.csv ms_median 'cell("node") == "weber" || cell("node") == "sparse"' | grep -v NaN | total)"
that 'they are no share of the frame' [ "$(column b.csv share 'cell("node") == "weber"')" = NaN ]
that 'in which others have all' same 1 \
    "$(column b.csv share 'cell("node") !~ /[(]/ && cell("status") == "ran"' | grep -v NaN | total)"
that 'the frame is there, too' [ "$(column b.csv stage 'cell("node") ~ /^[(]frame/' | wc -l)" -eq 2 ]

# ---- views of a path ----

run bench bagar2010 --scene drop.yaml $brief --views 3 -o v.csv
that 'views are timed' [ $status -eq 0 ]
that 'each with all its rows' \
    [ "$(column v.csv view | sort | uniq -c | awk '{ print $1 ":" $2 }' | tr '\n' ' ')" = '22:0 22:1 22:2 ' ]
that 'which differ' [ "$(column v.csv vertices 'cell("node") == "(frame)"' | wc -l)" -eq 3 ]
that 'the means are printed' grep -qx 'mean over 3 views of default' out
mean=$(column v.csv ms_median 'cell("node") == "sphere_depth"' | total)
that 'of the medians' \
    awk -v mean="$mean" '$1 == "sphere_depth" { d = $3 - mean / 3 } END { exit d < -0.001 || d > 0.001 }' out
run bench --scene drop.yaml $brief --views 1 -o one.csv
that 'one view is the first' [ "$status $(column one.csv view | sort -u)" = '0 0' ]

# ---- what is allocated ----

run bench images bagar2010 --scene drop.yaml --size 64x48 --backend cpu -s adaptive_flow.off=1 -o i.csv
that 'bench images runs' [ $status -eq 0 ]
that 'with a row an image' [ "$(column i.csv bits_per_pixel 'cell("name") == "fluid_depth"')" = 64 ]
that 'its node and format' [ "$(column i.csv node 'cell("name") == "scene_color"') $(column i.csv format \
    'cell("name") == "scene_color"')" = 'background RGB64F' ]
that 'and a sum' same "$(column i.csv bytes 'cell("name") == "(sum)"')" \
    "$(column i.csv bytes 'cell("name") != "(sum)"' | total)"
that 'no image of what is off' [ -z "$(column i.csv name 'cell("name") == "smooth_depth"')" ]
that 'for people in MiB' grep -q '^scene_color	background	image	RGB64F	64	48	1	3	0.070	192.0' out
that 'the metadata explain it' grep -q '"bits_per_pixel": "' i.meta.json
run bench images bagar2010 --scene drop.yaml --size 64x48 --backend cpu -s sphere_depth.root=ramp
that 'tables are listed, too' grep -q '^root_ramp		table	R32F	128	1	1	1' out

# ---- errors ----

refuses 'views need a path' 'path: drop.yaml: still: the camera has no path' \
    bench --scene drop.yaml $brief --views 2 --camera still
refuses 'and a scene with cameras' 'path: splash: there is no camera' bench $brief --views 2
refuses 'all of whose moments have a frame' 'path: drop.yaml: late goes on to 9 s, which no frame shows' \
    bench --scene drop.yaml $brief --views 2 --camera late
for option in '--frame 1' '--time 0.1' '--camera-time 0.1'; do
    refuses "views say the time, not $option" '--views: --frame, --time or --camera-time says which, too' \
        bench --scene drop.yaml $brief --views 2 $option
done
refuses 'there is at least one' '--views' bench --views 0
refuses 'it knows its pipelines' 'nothing: no such pipeline' bench nothing
refuses 'in images as well' 'nothing: no such pipeline' bench images nothing
refuses 'it finds out at once where it cannot write' 'absent/b.csv' bench --scene drop.yaml $brief -o absent/b.csv
refuses 'images do so, too' 'absent/b.csv' bench images --scene drop.yaml --backend cpu -o absent/b.csv
that 'nothing is left of tables that were begun' [ "$(find . -maxdepth 1 -name '*.part' | wc -l)" -eq 0 ]
run bench images --help
that 'it explains itself' grep -q 'Buffers of particles are not among them' out

finish
