#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# test_truth.sh: ground truth from outside: files, samples, the cache, interrupts, and what is refused.
# shellcheck disable=SC2086 # variables hold several options

test=truth
. "$(dirname "$0")/cases.sh"

export XDG_CACHE_HOME="$work/cache"
small="--size 64x48 --only surface,thickness"
balls="--set truth.kind=spheres"

n_files() { find "$work/cache" -name '*.tiles' | wc -l; }

# ---- help and lists ----

accepts '--help' truth --help
that 'tells of --every' grep -q -- '--every N' out
that 'and of the view' grep -q -- '--eye X,Y,Z' out
accepts '--parameters' truth --parameters --set truth.level=0.4
that 'lists those of truth with their values' grep -q '^truth.level	1	0.4	' out
that 'and those of the scene' grep -q '^medium.ior	' out

# ---- a ball ----

accepts 'a ball' truth sphere $small $balls -o ball.exr --preview ball.png
that 'has a table' grep -q '^quantity,unit,estimate,low,high,n$' out
that 'that says what is covered' awk -F , '$1 == "covered" { good = $3 > 0.2 && $4 <= $3 && $3 <= $5 && $6 == 3072 }
    END { exit !good }' out
that 'and that a ball holds one ball' [ "$(number out thickness)" = "$(number out content)" ]
that 'has a preview' [ -s ball.png ]
that 'says nothing else' [ ! -s err ]
that 'leaves its tiles in the cache' [ "$(find cache/ssfr/truth -maxdepth 1 -name '*.tiles' | wc -l)" -eq 1 ]
cp out first
accepts 'the same from the cache' truth sphere $small $balls -o again.exr --verbose
that 'says so' grep -q 'all from the cache' err
that 'has the same table' cmp -s out first
accepts 'with another number of threads and no cache' truth sphere $small $balls -o other.exr --no-cache --threads 3
that 'has the same table, too' cmp -s out first
for channel in Z N.X,N.Y,N.Z T D Z.err T.err; do
    accepts "and the same bits in $channel" compare again.exr other.exr --channel $channel
    that 'by its metrics' awk -F , '$1 == "max" || $1 == "rmse" { if ($3 != 0) exit 1 }' out
done
accepts 'a particle that is less dense than a surface' truth sphere --size 64x48 --only surface,thickness
that 'which is said' grep -q 'ssfr truth: warning: rays cross particles, but no surface' err
accepts 'without a file' truth sphere $small $balls
accepts 'with a cache of its own' truth sphere $small $balls --cache mine
that 'which is in the folder that was named' [ "$(find mine/truth -name '*.tiles' | wc -l)" -eq 1 ]
XDG_CACHE_HOME=relative HOME="$work/home" run truth sphere $small $balls
that 'or in ~/.cache, where XDG_CACHE_HOME is no whole path' [ -d home/.cache/ssfr/truth ]
accepts 'anew' truth sphere $small $balls --anew --verbose
that 'casts again' sh -c '! grep -q "from the cache" err'

# ---- what exact splats show ----

exact="--backend cpu --set sphere_depth.splat=exact --set thickness.splat=exact --set downsample.factor=1
    --set curvature_flow.iterations=0"
at_most() { awk -v a="$1" -v b="$2" 'BEGIN { exit !(a != "" && a <= b) }'; }
accepts 'the ball as an exact splat' render sphere --size 64x48 $exact -o splat.exr
accepts 'and as it is' compare splat.exr ball.exr --channel Z
that 'cover the same pixels' [ "$(number out silhouette_iou)" = 1 ]
that 'in the same depth' at_most "$(number out Z.max_abs)" 1e-6
accepts 'in thickness' compare splat.exr ball.exr --channel T
that 'they are the same' at_most "$(number out T.max_abs)" 1e-6
accepts 'in normals' compare splat.exr ball.exr --channel N.X,N.Y,N.Z
that 'up to finite differences' at_most "$(number out normal_mean_deg)" 3

# ---- places and kinds ----

# A million metres away the built-in block must be what it is at home.
accepts 'a block' truth block $small -o here.exr
here=$(number out depth),$(number out thickness),$(number out content)
accepts 'a block a million metres away' truth far $small -o there.exr
there=$(number out depth),$(number out thickness),$(number out content)
that 'has the same depth, thickness and content' awk -v a="$here" -v b="$there" 'BEGIN {
    n = split(a, x, ","); split(b, y, ",")
    for (i = 1; i <= n; i++) if (x[i] == 0 || (x[i] / y[i] - 1) ^ 2 > 1e-12) exit 1 }'
accepts 'pixel by pixel' compare here.exr there.exr --channel Z,T
for kind in spheres density zhu_bridson anisotropic; do
    accepts "the plane as $kind" truth plane $small --set truth.kind=$kind
    accepts "nothing as $kind" truth empty $small --set truth.kind=$kind
    that 'covers nothing' [ "$(number out covered)" = 0 ]
done
accepts 'the splash, in colour, a sample' truth splash --size 160x90 --every 16 -o splash.exr --preview splash.png
that 'with its luminance' awk -F , '$1 == "luminance" { good = $3 > 0.1 && $4 < $3 && $3 < $5 && $6 == 60 }
    END { exit !good }' out
from_behind="--eye 1.35,0.6,-4 --target 1.35,0.3,0"
accepts 'the splash from behind its wall' truth splash $small $from_behind
hidden=$(number out covered)
accepts 'as if there were no wall' truth splash $small $from_behind --set truth.solids=0
that 'which hides some of it' awk -v a="$hidden" -v b="$(number out covered)" 'BEGIN { exit !(a < b) }'

# ---- samples ----

accepts 'every pixel' truth block $small
whole=$(number out thickness)
accepts 'every fourth' truth block $small --every 4
that 'has an interval around the mean' awk -F , -v mean="$whole" '$1 == "thickness" { good = $4 < mean && mean < $5 }
    END { exit !good }' out
that 'of one pixel a square' grep -q '^thickness,m,.*,192$' out
cp out first
accepts 'with another seed' truth block $small --every 4 --seed 2
that 'has other pixels' sh -c '! cmp -s out first'

# ---- frames ----

cat >tiny.yaml <<'END'
title: A small column of water collapses
radius: 0.05
particles: 1000
duration: 0.2
frame_rate: 20
domain: {lo: [0, 0, 0], hi: [1.5, 1, 0.4]}
foam: {energy_min: 0, trapped_air_min: 0.1, trapped_air_max: 2, trapped_air_rate: 1000}
fluid: {column: {lo: [0, 0, 0], hi: [0.7, 0.8, 0.4], velocity: [2, 0, 0]}}
cameras:
  side: {eye: [0.75, 0.6, 2.5], target: [0.75, 0.3, 0]}
medium: {ior: 1.5}
END
accepts 'frames of a scene' truth tiny.yaml --scale full --size 64x48 --frames 0:4:2 --only surface,foam \
    -o frame_%02d.exr
that 'have their number in the table' [ "$(cut -d, -f1 out | sort -u | tr '\n' ' ')" = "0 2 4 frame " ]
that 'and a file each' [ "$(find . -name "frame_0[024].exr" -size +0 | wc -l)" -eq 3 ]
that 'and foam in the end' awk -F , '$1 == 4 && $2 == "foam_opacity" && $4 > 0 { good = 1 } END { exit !good }' out

# ---- interrupted ----

n=$(n_files)
long="splash --size 64x40 --threads 1"
"$ssfr" truth $long >out 2>err &
pid=$!
tries=500
while [ "$(n_files)" -eq "$n" ] && [ $tries -gt 0 ]; do sleep 0.02; tries=$((tries - 1)); done
sleep 0.1
kill -TERM $pid
wait $pid
status=$?
that 'SIGTERM ends it with 2' [ $status -eq 2 ]
that 'says how to go on' grep -q 'tiles: the same command goes on from there' err
that 'prints no table' [ ! -s out ]
accepts 'goes on' truth $long
cp out first
accepts 'as if nothing had been' truth $long --no-cache
that 'to the last digit' cmp -s out first

# ---- what is refused ----

refuses 'no scene' 'too few arguments: usage: ssfr truth SCENE' truth
refuses 'a scene that is not there' 'nowhere' truth nowhere.yaml
refuses 'another ending' 'truth.txt: the name must end in .exr' truth sphere -o truth.txt
refuses 'a preview that is no PNG' 'a.exr: the name must end in .png' truth sphere --preview a.exr
refuses 'a folder that is not there' 'no/truth.exr' truth sphere -o no/truth.exr
refuses '--every 0' '--every 0' truth sphere --every 0
refuses 'a part that is none' 'truth.parts=depth: expected' truth sphere --only depth
refuses 'no part' 'truth.parts=none' truth dam_break --only none
that 'before it simulates anything' sh -c '! find cache | grep -q dam_break'
refuses 'an integrator that is none' 'truth.integrator=simpson' truth sphere --integrator simpson
refuses 'a parameter that is none' 'truth.speed: no such parameter; there are kind' truth sphere --set truth.speed=1
refuses 'a group that is none' 'its groups are truth, extinction' truth sphere --set water.ior=1
refuses 'a value out of range' 'truth.level=2' truth sphere --set truth.level=2
refuses 'no value' 'expected KEY=VALUE' truth sphere --set truth.level
refuses 'frames of one picture' 'has no frames' truth sphere --frames :
refuses 'frames without a place for the number' 'a.exr' truth sphere --frames : -o a.exr
refuses 'the cache and none' '--no-cache and --anew' truth sphere --no-cache --anew
touch file
refuses 'a cache in a file' 'file/truth' truth sphere $small --cache file

finish
