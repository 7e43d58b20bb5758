#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# test_sweep.sh: sweep, bench and check from outside: every row once, errors before anything runs.
# shellcheck disable=SC2086,SC2012,SC2015,SC2016 # variables hold several options; names are plain

test=sweep
. "$(dirname "$0")/cases.sh"

# pick FILE LINE NAMES: cells of a line, with a space behind each.
pick() {
    file=$1 line=$2; shift 2
    for name; do printf '%s ' "$(column "$file" "$name" | sed -n "$((line - 1))p")"; done
}
keys() { sed 1d "$1" | cut -d, -f1-7 | sort; }
each_once() { [ -z "$(keys "$1" | uniq -d)" ] && [ "$(rows "$1")" -eq "$2" ]; }
nothing_but() { [ "$(ls | sort | tr '\n' ' ')" = "$(printf '%s\n' err out "$@" | sort | tr '\n' ' ')" ]; }

cpu="--scene block --size 48x32 --backend cpu --threads 1" # so few pixels are little work for several
brief="--max-time 0.001"

# ---- what runs ----

leaves 0 'a dry run lists the product' sweep $cpu \
    --vary curvature_flow.iterations=0:4:2 --vary sphere_depth.splat=point,exact --dry-run
printf '%s\n' 0,point 0,exact 2,point 2,exact 4,point 4,exact >wanted
that 'in order, the last axis fastest' [ "$(sed 1d out | cut -d, -f1,2)" = "$(cat wanted)" ]
that 'under a header that names the axes' [ "$(head -n 1 out)" = \
    curvature_flow.iterations,sphere_depth.splat,scene,pipeline,backend,width,height ]
rm wanted
leaves 0 'a unit stands behind its axis' sweep $cpu --vary curvature_flow.dt=0,1e-6 --dry-run
that 'in brackets' grep -qF 'curvature_flow.dt [m^2],scene' out
that 'a dry run writes nothing' nothing_but
leaves 0 'scenes, sizes and backends are axes too' sweep \
    --vary scene=block,sphere --vary size=48x32,32x48 --vary backend=cpu,gl --dry-run
that 'with columns of their own' [ "$(sed -n 3p out)" = block,vanderlaan2009,gl,48,32 ]
leaves 0 'the first sweep of a paper is sound' sweep "$here/../experiments/vanderlaan2009/iterations.yaml" --dry-run
that 'and holds its whole product' [ "$(rows out)" -eq 162 ]

# ---- a table ----

leaves 0 'a sweep goes to standard output' sweep $cpu $brief --vary curvature_flow.iterations=0,5
that 'with a row a run' [ "$(rows out)" -eq 2 ]
that 'that is ok' [ "$(column out status | sort -u)" = ok ]
that 'and took time' [ "$(column out ms_median | awk '$1 > 0' | wc -l)" -eq 2 ]
that 'standard output has no metadata' nothing_but
leaves 0 'a sweep goes to a file' sweep $cpu $brief --vary curvature_flow.iterations=0,5 -o t.csv
that 'with its metadata beside it' nothing_but t.csv t.meta.json
that 'which name the machine, the scene and the parameters' \
    [ "$(grep -c '"processor"\|"scene.hash"\|"medium.ior"' t.meta.json)" -eq 3 ]
leaves 0 'the same sweep replaces the table' sweep $cpu $brief --vary curvature_flow.iterations=0,5 -o t.csv
that 'with as many rows' each_once t.csv 2
rm t.*

leaves 0 'a run is compared with a reference' sweep $cpu $brief \
    --vary curvature_flow.iterations=10,20 --reference curvature_flow.iterations=20 -o r.csv
that 'which it is, for one of them' \
    [ "$(pick r.csv 3 ref_depth_rms ref_iou ref_psnr ref_thickness_rms)" = '0 1 inf 0 ' ]
that 'and is not, for the other' awk -v v="$(pick r.csv 2 ref_depth_rms ref_normal_mean_deg ref_psnr)" \
    'BEGIN { split(v, x, " "); exit !(x[1] > 0 && x[2] > 0 && x[3] < 100) }'
that 'the twin has the same error' [ "$(column r.csv ref_depth_rms)" = "$(column r.csv method_depth_rms)" ]
that 'no bound is known of a frame' [ "$(column r.csv truth_depth_err_mean | sort -u)" = NaN ]
rm r.*

# ---- the truth ----

XDG_CACHE_HOME=$work/cache
export XDG_CACHE_HOME
rays="$cpu $brief --reference truth --set thickness.splat=exact --set downsample.factor=1"
leaves 0 'a run is compared with the truth' sweep $rays --set sphere_depth.splat=exact \
    --vary curvature_flow.iterations=0,5 --vary truth.kind=spheres,density -o y.csv
that 'which stands in every row' [ "$(column y.csv truth.kind | tr '\n' ' ')" = 'spheres density spheres density ' ]
that 'unsmoothed exact splats are the spheres themselves' \
    [ "$(column y.csv method_depth_rms | awk 'NR == 1 && $1 < 1e-9 || NR > 1 && $1 > 1e-4' | wc -l)" -eq 4 ]
that 'the bound on its own error stands beside' \
    [ "$(column y.csv truth_depth_err_mean | awk '$1 >= 0 && $1 < 1e-9' | wc -l)" -eq 4 ]
that 'its parameters stand in the metadata' \
    [ "$(grep -c '"reference": "truth"\|"truth.level": \|"truth.parts": "surface,thickness"' y.meta.json)" -eq 3 ]
that 'but for the axis' [ "$(grep -c '"truth.kind": ' y.meta.json)" -eq 1 ]
sed 3,4d y.csv >half.csv && mv half.csv y.csv
leaves 0 'it is resumed' sweep $rays --set sphere_depth.splat=exact \
    --vary curvature_flow.iterations=0,5 --vary truth.kind=spheres,density -o y.csv --resume
that 'to every row once' \
    [ "$(sed 1d y.csv | cut -d, -f1-2 | sort | tr '\n' ' ')" = '0,density 0,spheres 5,density 5,spheres ' ]
refuses 'but not against another truth' 'y.csv: was measured with other settings' \
    sweep $rays --set sphere_depth.splat=exact --set truth.level=0.4 \
    --vary curvature_flow.iterations=0,5 --vary truth.kind=spheres,density -o y.csv --resume
leaves 0 'a truth that is not named is that of the density' sweep $rays --vary curvature_flow.iterations=3
that 'and stands in the table all the same' [ "$(column out truth.kind)" = density ]
refuses 'a truth that is none is named' 'truth.kind=cubes: expected one of' sweep $rays --vary truth.kind=cubes
refuses 'a parameter of truth needs truth' '--vary: truth.level: only a sweep with `reference: truth` has it' \
    sweep $cpu --vary truth.level=0.4
refuses 'the reference is one of two' '--reference truth: beside curvature_flow.iterations=6' \
    sweep $cpu --vary curvature_flow.iterations=3 --reference curvature_flow.iterations=6 --reference truth
rm y.*

# ---- a picture of the difference ----

run truth block --size 48x32 --only surface -s truth.kind=spheres -o truth.exr
run render block --size 48x32 --backend cpu -o frame.exr
run compare frame.exr truth.exr -c Z --picture difference.png --range 2
that 'a picture of the difference is drawn' [ $status -eq 0 -a -s difference.png ]
that 'beside the numbers' grep -q '^depth_mean,m,' out
refuses 'it is one of depth' '--picture difference.png: draws depth, and Z is not compared' \
    compare frame.exr truth.exr -c N.X,N.Y,N.Z --picture difference.png
refuses 'its name tells that it is a PNG' '--picture difference.jpg: expected a name that ends in .png' \
    compare frame.exr truth.exr --picture difference.jpg
rm ./*.exr difference.png && rm -r cache

# ---- killed and resumed ----

many="$cpu --vary curvature_flow.iterations=0:15:1"
slow="$many --max-time 0.1" # a row; so that there is time to end it
kills=0
while [ $kills -lt 3 ]; do
    "$ssfr" sweep $slow -o k.csv --resume 2>/dev/null &
    child=$!
    had=$(lines k.csv)
    wait_for 10 has_lines k.csv $((had + 2))
    kill -KILL $child 2>/dev/null && kills=$((kills + 1)) || break
    wait $child 2>/dev/null
done
that 'a sweep was killed three times' [ $kills -eq 3 ]
that 'and had not finished' [ "$(rows k.csv)" -lt 16 ]
leaves 0 'it is resumed' sweep $many $brief -o k.csv --resume
that 'with every row once at the end' each_once k.csv 16
that 'and all of them ok' [ "$(column k.csv status | sort -u)" = ok ]
cp k.csv whole.csv
cp k.meta.json whole.json
leaves 0 'a whole table needs no run' sweep $many $brief -o k.csv --resume
that 'and stays as it was' cmp -s k.csv whole.csv
that 'with what stands beside it' cmp -s k.meta.json whole.json
rm whole.json
size=$(wc -c <whole.csv)
for part in 10 1500 $((size / 2)) $((size - 20)) $((size - 1)); do
    head -c "$part" whole.csv >k.csv
    run sweep $many $brief -o k.csv --resume
    that "a table cut at byte $part is made whole" each_once k.csv 16
done
stop_at i.csv 3 sweep $slow -o i.csv
that 'a sweep that is asked to stop leaves with 2' [ $status -eq 2 ]
that 'says how to go on' grep -q '^ssfr sweep: interrupted after [0-9]* of 16 runs.*--resume' err
that 'and ends in a whole row' [ "$(tail -n 1 i.csv | tr -cd , | wc -c)" -eq "$(head -n 1 i.csv | tr -cd , | wc -c)" ]
leaves 0 'from which it goes on' sweep $many $brief -o i.csv --resume
that 'to every row once' each_once i.csv 16
refuses 'a table of other columns is not resumed' \
    'column 1 is curvature_flow.iterations, expected curvature_flow.step' \
    sweep $cpu --vary curvature_flow.step=0.5 -o i.csv --resume
refuses 'nor one that was measured with other settings' 'i.csv: was measured with other settings' \
    sweep $many --set medium.ior=1.4 -o i.csv --resume
refuses 'nor by another number of threads' 'i.csv: was measured with other settings' \
    sweep $many --threads 3 -o i.csv --resume
refuses 'nor from a view that differs in the last digit' 'i.csv: was measured with other settings' \
    sweep $many --fov 45.0000001 -o i.csv --resume
refuses 'nor with other frames before it' 'i.csv: was measured with other settings' \
    sweep $many --play none -o i.csv --resume
that 'and neither is touched' each_once i.csv 16
rm ./*.csv ./*.json

for k in 1 2 3; do run sweep $cpu $brief --vary curvature_flow.iterations=0:4:1 --shard $k/3 -o s$k.csv; done
sed 1d s2.csv >>s1.csv
sed 1d s3.csv >>s1.csv
that 'three shards make every row once' each_once s1.csv 5
rm ./s*
run sweep --scene block --vary curvature_flow.iterations=0:3:1 --backend gl,cpu --dry-run --shard 1/2
that 'a shard has both backends of a frame' [ "$(cut -d, -f1,4 out | tail -n +2 | tr '\n' ' ')" = '0,gl 0,cpu 2,gl 2,cpu ' ]

# ---- variants, views, and rows that are held against another ----

cat >variants.yaml <<'END'
scene: block
size: 48x32
backend: cpu
variants:
  base: {}
  few: {set: {curvature_flow.iterations: 3}}
  layers: {pipeline: bagar2010, size: 32x24}
END
leaves 0 'variants are an axis' sweep variants.yaml --dry-run
printf '%s\n' base,block,cpu,vanderlaan2009,48,32 few,block,cpu,vanderlaan2009,48,32 \
    layers,block,cpu,bagar2010,32,24 >wanted
that 'whose own pipelines and sizes stand in the rows' [ "$(sed 1d out)" = "$(cat wanted)" ]
leaves 0 'they are run' sweep variants.yaml $brief -o v.csv
that 'and what is their own is no key' \
    [ "$(head -n 1 v.csv | cut -d, -f1-7)" = variant,scene,backend,status,pipeline,width,height ]
that 'but a cell' [ "$(sed -n 4p v.csv | cut -d, -f1-7)" = layers,block,cpu,ok,bagar2010,32,24 ]
leaves 0 'by which such a table is gone on with' sweep variants.yaml $brief -o v.csv --resume
that 'to every row once' [ "$(rows v.csv)" -eq 3 ]
leaves 0 'some of them can be chosen' sweep variants.yaml --vary variant=few,base --dry-run
that 'in another order' [ "$(column out variant | tr '\n' ' ')" = 'few base ' ]
{ cat variants.yaml; echo 'against: {variant: base}'; } >wrong.yaml
refuses 'what shows something else is not held against it' 'variants layers and base differ in their size' \
    sweep wrong.yaml
sed 's/, size: 32x24//' wrong.yaml >held.yaml
printf '%s\n' 'reference: {curvature_flow.iterations: 6}' >>held.yaml
refuses 'what a pipeline lacks is no setting of its reference' \
    'held.yaml:9:13: curvature_flow.iterations: pipeline bagar2010 has no such parameter' sweep held.yaml
printf '%s\n' 'added: [ref_depth_rms]' >>held.yaml
leaves 0 'rows are held against one of them' sweep held.yaml $brief --vary variant=base,few -o h.csv
that 'in time' [ "$(column h.csv ms_ratio | awk '$1 > 0' | wc -l)" -eq 2 ]
that 'and in error' \
    [ "$(column h.csv ref_depth_rms_added | awk 'NR == 1 && $1 == 0 || NR == 2 && $1 != 0' | wc -l)" -eq 2 ]
that 'which the metadata tell of' \
    [ "$(grep -c '"curvature_flow.iterations": "3"\|"against": {\|"ref_depth_rms_added' h.meta.json)" -eq 3 ]
leaves 0 'such a table needs no run either' sweep held.yaml $brief --vary variant=base,few -o h.csv --resume
sed -i 's/iterations: 3/iterations: 4/' held.yaml
refuses 'a variant of the same name is not the same variant' 'h.csv: was measured with other settings' \
    sweep held.yaml $brief --vary variant=base,few -o h.csv --resume
leaves 0 'leaving out is an axis' sweep --scene block --size 48x32 --backend cpu $brief --vary leave_out=true,false
that 'which changes no bit' [ "$(column out color_hash | sort -u | wc -l)" -eq 1 ]
that 'though less is done' [ "$(column out taps | sort -u | wc -l)" -eq 2 ]
that 'and all is as it should be' [ "$(column out finite | sort -u)/$(column out bounded | sort -u)" = 1/1 ]
leaves 0 'pipelines are an axis, frames and cameras too' sweep --vary pipeline=vanderlaan2009,bagar2010 \
    --scene bagar2010/bamboo --camera default,close --frame 3 --dry-run
printf '%s\n' default,3,bagar2010/bamboo,vanderlaan2009,gl,1280,720 \
    close,3,bagar2010/bamboo,bagar2010,gl,1280,720 >wanted
that 'with a row each' [ "$(sed -n '2p;5p' out)" = "$(cat wanted)" ]
{ echo 'path: {camera: default, views: 3, frames: follow}'; echo 'scene: bagar2010/bamboo'; } >path.yaml
leaves 0 'views are those of a path' sweep path.yaml --dry-run
that 'from its first to its last' [ "$(column out view | tr '\n' ' ')" = '0 1 2 ' ]
refuses 'a path is of a camera that has one' 'path.yaml:1:1: path: bagar2010/bamboo: close: the camera has no path' \
    sweep path.yaml --camera close
refuses 'who follows it says no frame' 'path: the frames follow the camera: --frame says which, too' \
    sweep path.yaml --frame 3
cat >drop.yaml <<'END'
title: A drop
radius: 0.05
particles: 60
duration: 0.1
frame_rate: 20
domain: {lo: [0, 0, 0], hi: [1, 1, 1]}
fluid: {drop: {lo: [0.3, 0.3, 0.3], hi: [0.6, 0.6, 0.6]}}
cameras:
  near: {keys: [{time: 0, eye: [2, 1, 2], target: [0.5, 0.4, 0.5]}, {time: 1, eye: [1, 1, 2], target: [0.5, 0.4, 0.5]}]}
END
printf '%s\n' 'scene: drop.yaml' 'size: 32x24' 'backend: cpu' 'frame: 0' 'path: {camera: near, views: 2}' \
    'vary: {curvature_flow.iterations: [0, 2]}' >path.yaml
leaves 0 'a path is run' sweep path.yaml $brief --cache frames -o p.csv
that 'and averaged over its views' [ "$(cut -d, -f1 p_mean.csv | tr '\n' ' ')" = 'curvature_flow.iterations 0 2 ' ]
that 'with the columns of numbers' \
    [ "$(column p_mean.csv rows | tr '\n' ' ')$(column p_mean.csv finite | tr '\n' ' ')" = '2 2 1 1 ' ]
rm -r ./*.yaml h.* v.* p.* p_mean.csv frames wanted

# ---- errors, before anything runs ----

cat >spec.yaml <<'END'
scene: block
size: 48x32
backend: cpu
vary:
  curvature_flow.iterations: 0:4:2
plot: {x: iterations, y: ms_median, lines: [backend]}
END
wrong() { sed "$1" spec.yaml >wrong.yaml; }
wrong 's/vary/very/'
refuses 'a key that is none has its place' 'wrong.yaml:4:1: no key very' sweep wrong.yaml -o w.csv
wrong 's/^scene: .*/scene: {a: b}/'
refuses 'so has a value of the wrong kind' 'wrong.yaml:1:8: scene: expected one value' sweep wrong.yaml -o w.csv
wrong 's/iterations: 0:4:2/repeats: 0:4:2/'
refuses 'so has a parameter that is none' \
    'wrong.yaml:5:3: curvature_flow.repeats: pipeline vanderlaan2009 has no such parameter' \
    sweep wrong.yaml -o w.csv
wrong 's/0:4:2/-2:4:2/'
refuses 'a value out of range is named' 'curvature_flow.iterations=-2: out of range' sweep wrong.yaml -o w.csv
wrong 's/0:4:2/0:1:0.5/'
refuses 'so is a number that is not whole' 'curvature_flow.iterations=0.5: expected a whole number' \
    sweep wrong.yaml -o w.csv
wrong 's/cpu/gpu/'
refuses 'so is a backend that is none' 'wrong.yaml:3:1: backend gpu: expected gl or cpu' sweep wrong.yaml -o w.csv
wrong 's/48x32/48/'
refuses 'so is a size that is none' 'wrong.yaml:2:1: size 48: expected WxH' sweep wrong.yaml -o w.csv
wrong 's/block/rock/'
refuses 'so is a scene that is none' 'wrong.yaml:1:1: rock: no such file' sweep wrong.yaml -o w.csv
wrong 's/x: iterations/x: ref_speed/'
refuses 'so is a column that a plot cannot have' 'plot: the table will have no column ref_speed' \
    sweep wrong.yaml -o w.csv
refuses 'a file that is missing is named' 'absent.yaml' sweep absent.yaml
refuses 'a pipeline that is none is named' 'nothing: no such pipeline' sweep spec.yaml --pipeline nothing
refuses 'a setting that is none is named' '--set: no.thing: pipeline' sweep spec.yaml --set no.thing=1
refuses 'so is one of the reference' '--reference: no.thing: pipeline' sweep spec.yaml --reference no.thing=1
refuses 'a sweep must have something to run' 'nothing to run' sweep
refuses 'going on needs a table' '--resume needs' sweep spec.yaml --resume
for shard in 0/2 3/2 1 x/2 1/2/3 1/ -1/2; do
    refuses "a shard is not $shard" "--shard $shard: expected K/N" sweep spec.yaml --shard=$shard
done
refuses 'a folder that is missing is named' 'absent/t.csv' sweep spec.yaml -o absent/t.csv
that 'nothing is left of all this' nothing_but spec.yaml wrong.yaml

# ---- specs and plots ----

leaves 0 'a spec is run' sweep spec.yaml $brief -o p.csv
that 'and its plot drawn' grep -q '</svg>' p.svg
printf '%s\n' 'curves:' '  - {x: curvature_flow.iterations, y: ms_median, lines: [backend], only: {width: 48}}' \
    '  - {title: B, x: curvature_flow.iterations, y: taps}' | cat spec.yaml - >curves.yaml
leaves 0 'curves are drawn, too' sweep curves.yaml $brief -o p.csv
that 'in a figure of their own' grep -q '</svg>' p_curves.svg
sed 's/y: taps/y: tips/' curves.yaml >wrong.yaml
refuses 'of columns that there are' 'plot: the table will have no column tips' sweep wrong.yaml -o p.csv
rm curves.yaml
rm ./p.*
leaves 0 'a plot can be left out' sweep spec.yaml $brief -o p.csv --no-plot
that 'and is' [ ! -e p.svg ]
"$ssfr" sweep - $brief --vary curvature_flow.iterations=3 <spec.yaml >out 2>err
that 'a spec comes from standard input, and the command line counts for more' \
    [ "$(column out curvature_flow.iterations)" = 3 ]
rm ./p.*

# ---- bench ----

leaves 0 'bench times a pipeline' bench --scene block --size 48x32 --backend cpu $brief -o b.csv
that 'pass by pass' grep -Eq '^curvature_flow	ran	[0-9.]+	[0-9.]+	[0-9.]+ %	' out
that 'and says what was left out and why' grep -Eq '^noise_normals	needless: .*	-	-' out
that 'its table has a row a node and two for the frame' \
    [ "$(cut -d, -f7 b.csv | grep -cx 'composite\|(frame)\|(frame while timed)')" -eq 3 ]
that 'with metadata' grep -q '"curvature_flow.iterations": 40' b.meta.json
that 'which say what each column means' grep -q '"bytes \[B\]": "fewest bytes' b.meta.json
that 'of which there are as many' [ "$(head -n 1 b.csv | tr , '\n' | wc -l)" -eq \
    "$(sed -n '/"columns"/,/}/p' b.meta.json | grep -c '": "')" ]
that 'and counts tiles' [ "$(awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) c[$i] = i }
    $c["node"] == "curvature_flow" { print ($c["tiles"] <= 4 * $c["iterations"] && $c["tiles"] >= 40) }' b.csv)" = 1 ]
leaves 0 'steps that may ripple are taken where that is said' \
    sweep --scene block --size 48x32 --backend cpu $brief -s curvature_flow.step=2 \
    --vary curvature_flow.unstable=allow -o b.csv
that 'and their pixels counted' [ "$(column b.csv unstable)" -gt 100 ]
leaves 0 'values of particles are computed once' bench bagar2010 --size 48x32 --backend cpu $brief -o v.csv
that 'beside the frames that are timed' [ "$(column v.csv runs | sed -n 1,2p | tr '\n' ' ')" = '1 1 ' ]
that 'in a time of their own' [ "$(column v.csv ms_median | sed -n 1,2p | awk '$1 > 0' | wc -l)" -eq 2 ]
that 'of which they are no share' grep -Eq '^weber	ran	[0-9.]+	[0-9.]+	-	' out
# Whether the shares of the rows whose node matches this are shares of one whole.
whole() {
    awk -F, -v of="$1" 'NR == 1 { for (i = 1; i <= NF; i++) c[$i] = i; next }
        $c["node"] ~ of && $c["share"] != "NaN" { s += $c["share"] } END { exit !(s > 0.99 && s < 1.01) }' v.csv
}
that 'as the others are' whole '^[^(]'
that 'and the stages' whole '^\\(stage'
for command in "bench bagar2010" "sweep $cpu --vary curvature_flow.iterations=0"; do
    refuses "what is no number of frames, in ${command%% *}" "--play '1.5': expected" $command --play 1.5
done
rm ./v.*
refuses 'bench knows its pipelines' 'nothing: no such pipeline; there are vanderlaan2009' bench nothing
refuses 'bench finds out at once where it cannot write' 'absent/b.csv' bench -o absent/b.csv
mkfifo pipe
refuses 'bench replaces no pipe or device' 'pipe: is not a regular file' bench -o pipe
that 'which stays as it is' [ -p pipe ]
rm pipe
rm ./b.*

# ---- what needs GL ----

if "$ssfr" check background --scene empty >out 2>err; then
    leaves 0 'rounding is compared with the twin' sweep --scene block --size 48x32 \
        --backend gl,cpu $brief --vary sphere_depth.splat=point,quad
    column out backend >backends
    column out twin_psnr >psnrs
    column out twin_normal_mean_deg >angles
    that 'for OpenGL, where it is small' \
        [ "$(paste -d' ' backends psnrs angles | awk '$1 == "gl" && $2 > 60 && $3 < 0.1' | wc -l)" -eq 2 ]
    that 'and not for the twin itself' [ "$(paste -d' ' backends psnrs | grep -c '^cpu NaN$')" -eq 2 ]
    rm backends psnrs angles
    run sweep --scene block --size 48x32 $brief --vary sphere_depth.max_point_px=50,2000 --set sphere_depth.splat=point
    that 'a run that fails is no failure of the sweep' [ $status -eq 0 ]
    that 'but a warning' grep -q 'warning: 1 of 2 runs failed' err
    that 'and a row that says why' grep -q ',max_point_px 2000: this GPU draws points of up to .*,NaN,NaN,' out
    leaves 0 'check compares the twins of a pass' check curvature_flow --scene block --size 48x32 --corners --dump maps
    that 'at every corner' [ "$(grep -c '^curvature_flow	smooth	block	.*	ok$' out)" -gt 8 ]
    that 'and writes what it compared' [ -s maps/curvature_flow.smooth.block.exr ]
    rm -r maps
    leaves 0 'check takes settings' check curvature_flow --scene block --size 48x32 --set iterations=3
    run check downsample --scene block --size 48x32 --set downsample.factor=2
    that 'by the name of the pass too' [ $status -eq 0 ]
elif [ "$GL" = required ]; then
    bad 'GL is there' "$(cat err)"
else
    echo 'skip - OpenGL: there is none'
fi
refuses 'check knows its passes' 'nothing: no such pass' check nothing
refuses 'check knows its settings' '--set no.thing=1: expected' check --set no.thing=1

finish
