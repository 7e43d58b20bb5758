#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# test_scene.sh: scenes from outside: making frames, killed and two at once, rendering them, converting files.
# shellcheck disable=SC2086 # variables hold several options

test=scene
. "$(dirname "$0")/cases.sh"

export XDG_CACHE_HOME="$work/cache"
small="--size 64x48 --backend cpu --threads 1" # so few pixels are little work for several

# value NAME: the last cell of that line of `out`.
value() { awk -F '\t' -v name="$1" '$1 == name { print $NF }' out; }
n_frames() { find "$1" -name 'fluid_*.h5' | wc -l; }
sums() { (cd "$1"/* && cksum fluid_* foam_*); }
same_frames() { [ "$(sums "$1")" = "$(sums "$2")" ]; }

# has_frames DIR N: by the shell alone, so that what is to be caught half-way is.
has_frames() {
    wanted=$2
    set -- "$1"/*/fluid_*.h5
    [ -e "$1" ] && [ $# -ge "$wanted" ]
}

cat >tiny.yaml <<'END'
title: A small column of water collapses beside a moving wall
radius: 0.05
particles: 1000
duration: 0.4
frame_rate: 20
rest_time: 0.05
domain: {lo: [0, 0, 0], hi: [1.5, 1, 0.4]}
foam: {energy_min: 0, trapped_air_min: 0.1, trapped_air_max: 2, trapped_air_rate: 100}
motions: {push: {keys: [{time: 0}, {time: 0.4, move: [0.2, 0, 0]}]}}
solids: {wall: {shape: box, centre: [0.05, 0.4, 0.2], size: [0.1, 0.8, 0.4], motion: push}}
fluid: {column: {lo: [0.1, 0, 0], hi: [0.7, 0.8, 0.4]}}
cameras:
  side: {eye: [0.75, 0.6, 2.5], target: [0.75, 0.3, 0]}
  path: {target: [0.75, 0.3, 0.2], keys: [{time: 0, eye: [2, 1, 2]}, {time: 0.4, eye: [0, 1, 2]}]}
set: {curvature_flow.iterations: 3}
medium: {ior: 1.5}
END
tiny="tiny.yaml --scale full"

# ---- names ----

accepts 'the list of scenes' scene list
that 'has five cells a line' awk -F '\t' 'NF != 5 { exit 1 }' out
that 'has a shape of one picture' grep -q '^block	8000	8000	-	' out
that 'and a scene of many, with a sixteenth of the particles' \
    awk -F '\t' '$1 == "dam_break" && $4 > 1 && $3 / $2 > 15.9 && $3 / $2 < 16.1 { found = 1 } END { exit !found }' out
cp out list
for scene in $(sed -n 's|^\([a-z0-9_/]*\)	[0-9]*	[0-9]*	[0-9]*	.*|\1|p' list); do
    accepts "$scene is described" scene info "$scene"
done
refuses 'a name that two scenes end in' 'wave: there are akinci2013/wave and imai2016/wave' scene info wave
accepts 'a name that one scene ends in' scene info waterfall
that 'is that scene' grep -q '^scene		bagar2010/waterfall$' out
accepts 'what papers take particles for' scene info splash
that 'is told in per cent' awk -F '\t' '/^(splashes|strays|foam) .*%/ && $3 >= 0 && $3 <= 100 { n++ } END { exit n != 4 }' out
refuses 'a scene that is none' 'dam_braek: no such file, and not a built-in scene (splash, ' scene make dam_braek
refuses 'a scene file that is not there' 'none.yaml: no such file' render none.yaml -o a.png $small
refuses 'a shape cannot be made' 'block: there is nothing to simulate' scene make block
refuses 'a scene file that is wrong names the place' 'wrong.yaml:1:1' \
    scene make "$(echo 'tite: x' >wrong.yaml; echo wrong.yaml)"
accepts 'the parameters of scenes' scene params
that 'with unit, default and range' grep -q '^solver.cfl	1	[0-9.]*	\[' out
that 'and those of foam' grep -q '^foam.lifetime_min	s	' out
accepts 'the formats' scene formats
that 'are one a line' grep -q '^\.h5' out

# ---- making ----

accepts 'information makes no frame' scene info $tiny
that 'says how many there are' [ "$(value 'frames made')/$(value frames)" = 0/9 ]
that 'and that nothing is on the disk' [ ! -e cache ]
refuses 'information on a frame that is not made' 'frame 2 is not made: 0 of 9' scene info $tiny --frame 2
accepts 'the first frames are made' scene make $tiny --last 2 --threads 1
that 'and counted' grep -q '^tiny.yaml: 3 of 9 frames in /' out
that 'nothing is said where nobody looks' [ ! -s err ]
accepts 'then the others, with two threads' scene make $tiny --threads 2
accepts 'into another folder, at once' scene make $tiny --cache one --threads 1
that 'the frames are the same' same_frames cache/ssfr/scenes one
that 'and so many' [ "$(n_frames one)" -eq 9 ]
that 'the metadata say what they are' \
    [ "$(grep -c '"scale": "full"\|"seed": 1\|"frames_made": 9\|"solver_version": [0-9]' one/*/meta.json)" -eq 4 ]
accepts 'another seed has other frames' scene make $tiny --cache one --last 0 --seed 2
that 'in a folder of its own' [ "$(find one -name lock | wc -l)" -eq 2 ]
accepts 'information on what is made' scene info $tiny
that 'says how many there are now' [ "$(value 'frames made')" = 9 ]
that 'shows the last' [ "$(value frame) $(value time)" = '8 0.4' ]
that 'with its foam' [ "$(value 'diffuse particles')" -gt 0 ]
that 'how much it is' [ "$(value 'on disk')" -eq \
    "$(find cache -name '*.h5' -exec cat {} + | wc -c)" ]
that 'and the cameras' [ "$(grep -c '^camera	' out)" -eq 2 ]
refuses 'a frame beyond the last' 'frame 9: there are frames 0 to 8' scene make $tiny --last 9
refuses 'a frame and a time at once' '--frame and --time both' scene info $tiny --frame 1 --time 0.1
refuses 'information on a frame that cannot be' 'there is no frame 9: they go from 0 to 8' scene info $tiny --frame 9
cat >jet.yaml <<'END'
title: What is left of a pressure of high power
radius: 0.05
particles: 400
duration: 0.1
domain: {lo: [-1, 0, -1], hi: [1, 1, 1]}
solver: {pressure_k: 1, pressure_dq: 0.9, pressure_n: 16}
fluid: {pool: {lo: [-0.9, 0.6, -0.9], hi: [0.9, 1, 0.9]}}
END
refuses 'a value that is not finite' 'jet.yaml, frame 1: particle ' scene make jet.yaml --scale full --cache jet
that 'names the value' grep -q 'nan, .*nan' err
that 'and leaves the frames before it' [ "$(n_frames jet)" -eq 1 ]
cat >stone.yaml <<'END'
title: A stone lies where water is to be
radius: 0.05
particles: 400
duration: 0
domain: {lo: [0, 0, 0], hi: [1, 1, 1]}
solids: {stone: {shape: sphere, centre: [0.5, 0.5, 0.5], radius: 0.5}}
fluid: {pool: {lo: [0, 0, 0], hi: [1, 0.5, 1], count: 400}}
END
accepts 'a pool that a solid takes room from' scene make stone.yaml --scale full --cache stone
that 'is told in a line' grep -qx \
    'ssfr scene: warning: stone.yaml: pool: solids leave room for [0-9]* of its 400 particles' err
echo >file
refuses 'a cache that cannot be' 'file/x: the folder cannot be made: Not a directory' scene make $tiny --cache file/x
name='no cache at all'
(unset XDG_CACHE_HOME HOME; "$ssfr" scene make $tiny >out 2>err)
that "$name is one line" grep -q '^ssfr scene: neither XDG_CACHE_HOME nor HOME' err

# ---- killed, stopped, two at once ----

{ sed 's/^duration: .*/duration: 0.35/' tiny.yaml; echo 'solver: {iterations: 20}'; } >slow.yaml
slow="slow.yaml --scale full"
alone="$slow --threads 1" # little work for several: they would wait for each other
accepts 'a scene that takes longer' scene make $alone --cache whole
kills=0
had=0
while [ $kills -lt 2 ]; do
    "$ssfr" scene make $alone --cache killed >/dev/null 2>&1 &
    child=$!
    wait_for 10 has_frames killed $((had + 1)) || break
    kill -KILL $child 2>/dev/null && kills=$((kills + 1))
    wait $child 2>/dev/null
    had=$(n_frames killed)
done
that 'is killed twice' [ $kills -eq 2 ]
that 'before its end' [ "$had" -lt 8 ]
accepts 'and gone on with' scene make $slow --cache killed --threads 2
that 'to the same frames' same_frames killed whole

"$ssfr" scene make $alone --cache stopped >out 2>err &
child=$!
wait_for 10 has_frames stopped 1
kill -TERM $child
wait $child
that 'a signal makes it leave with 2' [ $? -eq 2 ]
that 'and say in one line where' \
    grep -Eq '^ssfr scene: slow.yaml, frame [0-9]: interrupted; the frames before it stay$' err
that 'nothing else' [ "$(cat out err | wc -l)" -eq 1 ]
that 'nothing half-written stays' [ -z "$(find stopped -name '*.part')" ]
accepts 'it is gone on with' scene make $alone --cache stopped
that 'to the same frames' same_frames stopped whole

"$ssfr" scene make $alone --cache both >out1 2>err1 &
first=$!
wait_for 10 has_frames both 1
"$ssfr" scene make $alone --cache both >out2 2>err2 &
second=$!
wait $first && wait $second
that 'two at once both leave with 0' [ $? -eq 0 ]
that 'the second waits, and says so' grep -q '^ssfr scene: warning: waiting for another process' err2
that 'both have all frames' [ "$(cat out1 out2 | grep -c '8 of 8 frames')" -eq 2 ]
that 'which are the same' same_frames both whole
(trap '' INT; exec "$ssfr" scene make $alone --cache deaf) >out 2>err &
child=$!
wait_for 10 has_frames deaf 1
kill -INT $child
wait $child
that 'a signal that was ignored stays so' [ $? -eq 0 ]
echo half >"$(echo deaf/*)/fluid_0008.h5.1.part"
find deaf -name fluid_0007.h5 -exec rm {} +
accepts 'what a killed process left half-written' scene make $alone --cache deaf
that 'is removed' [ -z "$(find deaf -name '*.part')" ]
echo bad >"$(echo deaf/*)/fluid_0001.h5"
accepts 'frames are made anew' scene make $alone --cache deaf --anew
that 'all of them' same_frames deaf whole
find both -name fluid_0003.h5 -exec rm {} +
accepts 'a frame that was removed is made again' scene make $alone --cache both --last 3
that 'the same' same_frames both whole

# ---- rendering ----

accepts 'a frame of a scene' render $tiny -o two.exr $small --frame 2
accepts 'by its time' render $tiny -o time.exr $small --time 0.11
accepts 'is the same' compare time.exr two.exr --require max_abs==0
accepts 'the default is two thirds of the way' render $tiny -o default.exr $small
accepts 'which is a frame' render $tiny -o six.exr $small --frame 6
accepts 'the same' compare default.exr six.exr --require max_abs==0
accepts 'not another' compare two.exr six.exr --require 'max_abs>0' --require 'Z.max_abs>0'
accepts 'frames of a range' render $tiny -o 'side_%02d.exr' $small --frames 2:6:4
that 'have their numbers' [ -e side_02.exr ] && [ -e side_06.exr ] && [ ! -e side_04.exr ]
accepts 'and are what they are alone' compare side_06.exr six.exr --require max_abs==0 --require Z.max_abs==0
# Foam that follows the particles: of what it is, the water is less.
foam="$tiny $small -p bagar2010 --set weber.threshold=300"
accepts 'frames that follow each other' render $foam -o 'foam_%d.exr' --frames 0:6
accepts 'a frame after all that are before it' render $foam -o all.exr --frame 6 --play all
accepts 'is the same to the last bit' compare all.exr foam_6.exr --require max_abs==0 --require Z.max_abs==0
accepts 'a lone frame' render $foam -o lone.exr --frame 6 --play none
accepts 'is another' compare lone.exr all.exr --require 'max_abs>0'
accepts 'as many as fades last' render $foam -o fades.exr --frame 6
accepts 'are all here' compare fades.exr all.exr --require max_abs==0
accepts 'of frames far apart' render $foam -o 'apart_%d.exr' --frames 0:6:3
accepts 'those between them are played' compare apart_6.exr all.exr --require max_abs==0
refuses 'what is no number of frames' "--play 'some': expected a number of frames, all or none" \
    render $foam -o a.png --frame 6 --play some
accepts 'a camera moves along its path' render $tiny -o 'path_%d.exr' $small --frames 0:8:4 --camera path
accepts 'elsewhere at another time' render $tiny -o path.exr $small --frame 4 --camera path
accepts 'as it is alone' compare path.exr path_4.exr --require max_abs==0
accepts 'it stands at a time of its own' render $tiny -o still.exr $small --frame 4 --camera path --camera-time 0.4
accepts 'which is where its path ends' render $tiny -o there.exr $small --frame 4 --eye 0,1,2 --target 0.75,0.3,0.2
accepts 'whatever the frame' compare still.exr there.exr --require max_abs==0
refuses 'a camera without a path has no time' '--camera-time 0.1: tiny.yaml: side: the camera has no path' \
    render $tiny -o a.png $small --camera side --camera-time 0.1
refuses 'nor has no camera' '--camera-time 0.1: block: there is no camera' \
    render block -o a.png $small --camera-time 0.1
accepts 'the user moves it too' render $tiny -o mine.exr $small --frame 4 --camera path --eye 0,1,2
accepts 'to where its path ends' compare mine.exr there.exr --require max_abs==0
accepts 'the settings of a scene are taken' render $tiny --dump dump_%d $small --frames 3
that 'into account' grep -q '"curvature_flow.iterations": 3' dump_3/graph.json
that 'and those that all pipelines share' grep -q '"medium.ior": 1.5' dump_3/graph.json
that 'the frame is recorded' grep -q '"scene.frame": 3' dump_3/graph.json
that 'so is which simulation it is' grep -Eq '"scene.key": "[0-9a-f]{16}"' dump_3/graph.json
accepts 'what the user sets counts for more' render $tiny --dump mine $small --frame 3 --set curvature_flow.iterations=5
that 'than the scene' grep -q '"curvature_flow.iterations": 5' mine/graph.json
sed 's/curvature_flow.iterations/curvature_flow.iteration/' tiny.yaml >typo.yaml
refuses 'a setting that no pipeline has' 'typo.yaml:15:7: ' render typo.yaml -o a.png $small
accepts 'frames that are missing are made' render $tiny -o a.png $small --frame 1 --cache made
that 'up to that which is wanted' [ "$(n_frames made)" -eq 2 ]
refuses 'a frame that cannot be' 'there is no frame 9: they go from 0 to 8' render $tiny -o a.png $small --frame 9
refuses 'a range that cannot be' 'there is no frame 9, and 1 more' render $tiny -o 'a_%d.png' $small --frames 8:10
refuses 'a frame and a time' '--frame and --time both' render $tiny -o a.png $small --frame 1 --time 1
refuses 'frames without a place for their number' 'a.png: expected one number' render $tiny -o a.png $small --frames 1:2
refuses 'a frame of a shape' 'block: has no frames' render block -o a.png $small --frame 1
refuses 'frames of a shape' 'block: has no frames' render block -o 'a_%d.png' $small --frames :
refuses 'a camera that is not there' 'top' render $tiny -o a.png $small --camera top
refuses 'a camera of a shape' 'block has no cameras' render block -o a.png $small --camera top
accepts 'a picture to take as the sky' render block -o sky.exr $small
{ cat tiny.yaml; echo 'environment: sky.exr'; } >sky.yaml
accepts 'a scene has a sky of its own' render sky.yaml --scale full -o sky_2.exr $small --frame 2
accepts 'that is seen' compare sky_2.exr two.exr --require 'max_abs>0' --require Z.max_abs==0
{ cat tiny.yaml; echo 'background: sky.exr'; } >behind.yaml
accepts 'a scene has a picture behind it' render behind.yaml --scale full -o behind.exr $small --frame 2
accepts 'that is seen too' compare behind.exr two.exr --require 'max_abs>0'
refuses 'of one size' 'sky.exr: 64x48 pixels, the image has 32x24: add --size 64x48' \
    render behind.yaml --scale full -o a.exr --size 32x24 --backend cpu --frame 2
refuses 'in a bench too' 'sky.exr: 64x48 pixels' bench --scene behind.yaml --scale full --size 32x24 --backend cpu
refuses 'and in a sweep' 'sky.exr: 64x48 pixels' sweep --scene behind.yaml --scale full --size 32x24 --backend cpu \
    --max-time 0.001 --vary curvature_flow.iterations=1 -o b.csv
accepts 'where it is of that size' bench --scene behind.yaml --scale full --frame 2 $small --max-time 0.001
that 'it is taken' awk '$1 == "background" { found = /imported|given|from outside/ } END { exit !found }' out
accepts 'the user may have another' render behind.yaml --scale full -o mine.exr $small --frame 2 --background two.exr
accepts 'which counts for more' compare mine.exr behind.exr --require 'max_abs>0'
accepts 'a sweep over a scene' sweep --scene tiny.yaml --scale full --frame 2 --size 32x24 --backend cpu \
    --max-time 0.001 --vary curvature_flow.iterations=1,4 -o s.csv
that 'has its rows' [ "$(grep -c ',ok,' s.csv)" -eq 2 ]
that 'and its frame in the metadata' grep -q '"scene.frame": 2' s.meta.json

# ---- files ----

accepts 'the frames of a scene are exported' scene import $tiny -o 'out_%03d.ply' --frames 2:6:2
that 'with their numbers' [ "$(find . -maxdepth 1 -name 'out_*.ply' | tr '\n' ' ' | wc -w)" -eq 3 ]
accepts 'a sequence of files' scene info out_%03d.ply --frame 4
that 'has its frames' [ "$(value frames)" = 3 ]
cp out info
accepts 'holds what the scene does' scene info $tiny --frame 4
for what in particles radius lowest highest speed density neighbours id; do
    that "its $what" [ "$(grep "^$what	" out)" = "$(grep "^$what	" info)" ]
done
accepts 'is rendered' render out_%03d.ply -o 'seq_%d.exr' $small --frames 2:6:2
accepts 'with one view for all' render out_%03d.ply --dump seq_%d $small --frames 2:6:4
that 'that stands still' [ "$(grep camera.eye seq_2/graph.json)" = "$(grep camera.eye seq_6/graph.json)" ]
refuses 'a frame that no file has' 'there is no frame 3: they go from 2 to 6' \
    render out_%03d.ply -o a.png $small --frame 3
refuses 'a sequence without files' 'there are no frames' render none_%d.ply -o a.png $small
refuses 'a sequence has no time' 'nothing tells when its frames are' render out_%03d.ply -o a.png $small --time 1
accepts 'frames are converted' scene import out_%03d.ply -o 'in_%d.h5' --frames 4:
that 'those that are wanted' [ "$(find . -maxdepth 1 -name 'in_*.h5' | wc -l)" -eq 2 ]

printf '%s\n' ply 'format ascii 1.0' 'element vertex 3' 'property float x' 'property float y' 'property float z' \
    end_header '0 1 2.5' '1 1 2.5' '0 2 2.5' >bare.ply
accepts 'a file of places alone' scene info bare.ply --radius 0.5
that 'has what can be computed' [ "$(value 'density is') $(value 'neighbours are')" = 'computed computed' ]
accepts 'is completed' scene import bare.ply -o full.h5 --radius 0.005 --unit 0.01 --up-axis z
accepts 'turned and scaled' scene info full.h5
that 'as was asked for' [ "$(value lowest | cut -d, -f1,2)/$(value radius)" = 0,0.025/0.005 ]
that 'and then has all' [ -z "$(grep computed out)" ]
accepts 'or left as it is' scene import bare.ply -o bare.h5 --radius 0.5 --as-is
accepts 'without them' scene info bare.h5
that 'is what it was' [ "$(value 'density is')" = computed ]
accepts 'the radius that is not told' scene info bare.ply
that 'is said to be estimated' [ "$(value radius)/$(value 'radius is')" = 0.5/estimated ]
for frame in 0 1 2; do sed "s/^1 1/$((frame + 1)) 1/; s/^0 2/0 $((frame + 2))/" bare.ply >some_$frame.ply; done
printf '%s\n' ply 'format ascii 1.0' 'element vertex 0' 'property float x' 'property float y' 'property float z' \
    end_header >some_3.ply
accepts 'frames without a radius' scene import some_%d.ply -o same_%d.h5
that 'with what was computed' grep -qx \
    'same_%d.h5: 4 frames, 9 particles, radius estimated as 0.5 m, density computed, neighbours computed' out
accepts 'one of them' scene import some_%d.ply -o one.h5 --as-is
that 'which is told' grep -qx 'one.h5: frame 2, 3 particles, radius estimated as 1.5 m' out
for frame in 0 1 2 3; do
    accepts "frame $frame of them" scene info same_$frame.h5
    that 'has the radius of all' [ "$(value radius)" = 0.5 ]
done
refuses 'a conversion into nowhere' 'nothing to write' scene import bare.ply
refuses 'frames into a format that is none' 'x_%d.foo: the names of particle files end in' \
    scene import $tiny -o 'x_%d.foo' --cache none
that 'before any is made' [ ! -e none ]
refuses 'into a format that is not written' 'full.xml' scene import bare.ply -o full.xml --radius 0.5
refuses 'into a folder that is not there' 'no/a.h5: cannot be written' scene import bare.ply -o no/a.h5
refuses 'of what is not there' 'none.ply: no such file' scene import none.ply -o a.h5

finish
