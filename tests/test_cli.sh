#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# test_cli.sh: the command line from outside: exit status, the one line of an error, what is written and what is not.

test=cli
. "$(dirname "$0")/cases.sh"

nothing_at() { for path; do [ ! -e "$path" ] || return 1; done; [ -z "$(find . -name '*.part')" ]; }
is_exr() { [ "$(od -An -tx1 -N4 "$1" | tr -d ' ')" = 762f3101 ]; }
small="--size 64x48 --backend cpu"

# ---- help and bad usage ----

accepts '--help lists the commands' --help
cp out commands
for command in $(sed -n 's/^  \([a-z]*\) .*/\1/p' commands); do
    accepts "$command --help leaves with 0" "$command" --help
    that "$command --help shows its usage" grep -q "^usage: ssfr $command" out
    cp out wanted
    accepts "help $command leaves with 0" help "$command"
    that 'and shows the same' cmp -s out wanted
    refuses "$command refuses an unknown option" "unknown option --colour" "$command" --colour red
done
run
that 'no command at all leaves with 2' [ $status -eq 2 ]
accepts '--version says the version' --version
that 'the version is a version' grep -Eq '^ssfr [0-9]+\.[0-9]+\.[0-9]+$' out
refuses 'an unknown command' 'unknown command rendr' rendr
refuses 'which has no help either' 'unknown command rendr' help rendr
refuses 'a missing scene' 'too few arguments: usage: ssfr render SCENE' render -o a.png
refuses 'an argument too many' 'one argument too many: plane' render block plane -o a.png
refuses 'an unknown scene' 'blok: no such file, and not a built-in scene (splash' render blok -o a.png
refuses 'an unknown pipeline' 'vanderlaan: no such pipeline; there are vanderlaan2009' \
    render block -o a.png -p vanderlaan
refuses 'an unknown pass' 'blur: no such pass; there are' passes blur
refuses 'an unknown pipeline to describe' 'nope: no such pipeline' pipelines nope
refuses 'a malformed number' '--fov wide: expected a finite number' render block -o a.png --fov wide
refuses 'a malformed size' '--size 1280: expected a size' render block -o a.png --size 1280
refuses 'a value without its option' '--eye needs a value' render block --eye

# ---- parameters ----

# shellcheck disable=SC2086
{
run render block -o a.png --size 48x32 --backend cpu --set curvature_flow.unstable=allow --set curvature_flow.step=2
that 'steps that may ripple are warned of' grep -Eq 'warning: curvature_flow: its step is longer than [1-9][0-9]* pixels' err
rm a.png
refuses 'steps that may ripple, where that is asked' 'pixels' \
    render block -o a.png --size 48x32 --backend cpu --set curvature_flow.unstable=refuse --set curvature_flow.step=2
refuses 'an unknown parameter' 'curvature_flow.blur' render block -o a.png $small --set curvature_flow.blur=3
refuses 'a parameter out of range' 'medium.ior=0.5: out of range [1, 4]' \
    render block -o a.png $small --set medium.ior=0.5
refuses 'a parameter that is no number' 'medium.ior=glass: expected a finite number' \
    render block -o a.png $small --set medium.ior=glass
refuses 'a setting without a value' '--set medium.ior: expected KEY=VALUE' render block -o a.png $small --set medium.ior
that 'nothing is left behind by bad usage' nothing_at a.png

# ---- outputs ----

refuses 'no output at all' 'nothing to write' render block $small
refuses 'an ending that is not known' 'a.jpg: the name must end in .exr or .png' render block -o a.jpg $small
refuses 'a folder that is not there' 'no/a.exr: cannot be written' render block -o no/a.exr $small
mkdir folder.exr
refuses 'a folder as output' 'folder.exr: is a folder' render block -o folder.exr $small
echo text >file
refuses 'a file as dump folder' 'file: is not a folder' render block --dump file $small
refuses 'an output inside a file' 'file/a.exr: file is not a folder' render block -o file/a.exr $small
printf 'ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nend_header\n' >broken.ply
refuses 'a broken particle file' 'broken.ply' render broken.ply -o a.exr --dump d $small
that 'nothing is left behind by bad input' nothing_at a.exr d

# ---- rendering ----

accepts 'a scene into an EXR' render block -o block.exr $small
that 'the EXR is one' is_exr block.exr
that 'no temporary file stays' nothing_at
accepts 'a scene into a PNG' render block -o block.png $small
that 'the PNG is one' is_png block.png
accepts 'the same again, with everything kept' render block -o kept.exr $small --keep-all
accepts 'leaving out changes no bit' compare kept.exr block.exr \
    --require max_abs==0 --require Z.max_abs==0 --require N.max_abs==0 --require T.max_abs==0
accepts 'no pass at all' render block -o none.png $small --set background.off=1 --set composite.off=1
accepts 'still gives an image of the size asked for' compare none.png none.png --mask block.exr:R
accepts 'another seed' render block -o seed.exr $small --seed 2
accepts 'another seed gives another block' compare seed.exr block.exr --require 'max_abs>0'
accepts 'a parameter' render block -o flow.exr $small --set curvature_flow.iterations=0
accepts 'a parameter changes the picture' compare flow.exr block.exr --require 'Z.max_abs>0'
accepts 'a scene without particles' render empty -o empty.exr $small
accepts 'a scene far away' render far -o far.exr $small
accepts 'a million metres away nothing changes' \
    compare far.exr block.exr --require 'psnr>=90' --require 'silhouette_iou==1'
accepts 'every slot at once' render block --dump dump $small
for slot in color surface_depth normal thickness; do that "dump/$slot.exr is there" is_exr dump/$slot.exr; done
that 'graph.json tells what ran' grep -q '"status": "ran"' dump/graph.json
that 'graph.json tells what was left out and why' grep -q '"why": "[^"]' dump/graph.json
that 'graph.json holds the command line' grep -q '"command": "ssfr render block --dump dump' dump/graph.json
that 'graph.json holds each parameter' grep -q '"curvature_flow.iterations": [0-9]' dump/graph.json
accepts 'a folder by its name with a slash' render block --dump new/ $small
that 'is made' is_exr new/color.exr
accepts 'the dump is the picture' compare dump/color.exr block.exr --require max_abs==0
that 'the EXR holds the camera' grep -aq camera.eye.x block.exr
that 'the EXR holds each parameter' grep -aq curvature_flow.iterations block.exr
accepts 'pass by pass' render block -o block.png $small --verbose
that '--verbose says one line a pass' grep -q '^ssfr render: curvature_flow .* ms' err
accepts 'an image of the way in false colours' render block -o front.png $small --slot fluid_depth --verbose
that 'it says of what range' grep -q 'front.png: fluid_depth from -[0-9.]* to -[0-9.]* m' err
accepts 'of a range' render block -o front.png $small --slot thickness --from 0 --to 0.5
refuses 'false colours in an EXR' '--slot thickness: false colours are a picture' render block -o a.exr $small --slot thickness
refuses 'false colours of directions' 'normal has 3 channels' render block -o a.png $small --slot normal
refuses 'an image that is none of the pipeline' 'depht' render block -o a.png $small --slot depht
refuses 'a range of nothing' '--from and --to are of the colours of a --slot' render block -o a.png $small --from 1
refuses 'a range that ends before it begins' '--from 2 is above --to 1' \
    render block -o a.png $small --slot thickness --from 2 --to 1
accepts 'without a word' render block -o block.png $small -q
that '-q says nothing' [ ! -s err ]
refuses 'a background of another size' 'block.exr: 64x48 pixels, the image has 65x48: add --size 64x48' \
    render sphere -o a.exr --backend cpu --size 65x48 --background block.exr
accepts 'a background' render empty -o behind.exr $small --background block.exr
accepts 'the background is what shows without a fluid' \
    compare behind.exr block.exr --channel R,G,B --require 'psnr>=100'

# ---- particle files ----

printf '%s\n' ply 'format ascii 1.0' 'element vertex 3' 'property float x' 'property float y' 'property float z' \
    end_header '0 0 0' '1 0 0' 'nan 1 0' >three.ply
refuses 'a position that is no number' 'three.ply' render three.ply -o a.exr $small
accepts 'the same, dropped' render three.ply -o a.exr $small --drop-nonfinite
that 'what was dropped is said' grep -q 'warning: .*dropped 1' err
cp three.ply "it's three.ply"
accepts 'a name that a shell takes apart' \
    render "it's three.ply" --dump first $small --drop-nonfinite --set medium.ior=1.5
redo=$(sed -n 's/.*"command": "ssfr \(.*\)",$/\1/p' first/graph.json | sed 's/\\\\/\\/g; s/first/second/')
eval "accepts 'the command line in graph.json runs again' $redo"
accepts 'and makes the same frame' compare second/color.exr first/color.exr --require max_abs==0
accepts 'what is in a file' scene info three.ply --drop-nonfinite --radius 0.2385
that 'scene info counts' grep -q "^particles	1	2$" out
that 'scene info knows the radius' grep -q "^radius	m	0.2385$" out
accepts 'what is in a scene' scene info block
that 'the block has 20^3 particles' grep -q "^particles	1	8000$" out
accepts 'the list of scenes' scene list
that 'the list names the splash' grep -q '^splash' out
refuses 'scene without a word that it knows' 'show: expected list, make, info, import, formats or params first' scene show

# ---- comparing ----

accepts 'an image with itself' compare block.exr block.exr
that 'the CSV has its header' [ "$(head -n 1 out)" = 'metric,unit,value,low,high' ]
that 'each row has five cells' awk -F, 'NF != 5 { exit 1 }' out
cp out same.csv
that 'its PSNR is infinite' [ "$(number same.csv psnr)" = inf ]
that 'its SSIM is 1' [ "$(number same.csv ssim)" = 1 ]
that 'its depths agree' [ "$(number same.csv depth_rms)" = 0 ]
that 'its normals agree' [ "$(number same.csv normal_max_deg)" = 0 ]
run compare seed.exr block.exr
that 'other numbers are numbers' awk -F, 'NR > 1 && $3 !~ /^-?[0-9.]+(e[-+][0-9]+)?$/ { exit 1 }' out
run compare seed.exr block.exr --require 'psnr>=99' --require 'ssim<=1'
that 'a requirement that fails leaves with 1' [ $status -eq 1 ]
that 'and the line says which' grep -Eq '^ssfr compare: psnr>=99 does not hold: psnr is [0-9.]+ dB$' err
that 'and only which' [ "$(wc -l <err)" -eq 1 ]
run compare block.exr block.exr --require 'psnr>=inf' --require 'mse<1e-9' --require 'max_abs<=0'
that 'requirements that hold leave with 0' [ $status -eq 0 ]
refuses 'a malformed requirement' '--require psnr=>50: expected a metric' \
    compare block.exr block.exr --require 'psnr=>50'
refuses 'a requirement without a number' '--require psnr>=high' compare block.exr block.exr --require 'psnr>=high'
run compare block.exr block.exr --require 'beauty>=1'
that 'a requirement on nothing measured leaves with 2' [ $status -eq 2 ]
accepts 'a PNG with an EXR' compare block.png block.exr --require 'psnr>=48'
refuses 'a channel that a PNG lacks' 'block.png: --channel Z: a PNG has only R,G,B' compare block.png block.exr -c Z
refuses 'a channel that is not there' 'block.exr' compare block.exr block.exr --channel foam
accepts 'one channel' compare block.exr seed.exr --channel T
that 'one channel has its name before its numbers' grep -q '^T.mse,m^2,' out
accepts 'another size' render sphere -o wide.exr --backend cpu --size 65x48
refuses 'images of two sizes' 'wide.exr is 65x48 pixels, block.exr is 64x48' compare wide.exr block.exr
accepts 'a difference' compare seed.exr block.exr --diff diff.exr
accepts 'the difference is zero where nothing differs' compare block.exr block.exr --diff zero.exr
accepts 'a mask of nothing' compare seed.exr block.exr --mask zero.exr:R
that 'counts nothing' [ "$(number out psnr)" = NaN ]
mkdir a:b && cp zero.exr a:b/mask.exr
accepts 'a mask in a folder with a colon' compare seed.exr block.exr --mask a:b/mask.exr
accepts 'other channels that both have' compare dump/noise.exr dump/noise.exr --require noise.max_abs==0
refuses 'a difference into nowhere' 'no/diff.exr: cannot be written' compare block.exr block.exr --diff no/diff.exr
refuses 'an image that is not there' 'none.exr' compare none.exr block.exr
refuses 'an image that is none' 'text.exr' compare text.exr block.exr

# ---- one pass by itself ----

accepts 'a pass on a depth image' filter normals dump/surface_depth.exr -o normals.exr --backend cpu
accepts 'gives what the pipeline gives' compare normals.exr dump/normal.exr --require 'normal_max_deg<=0.001'
refuses 'a pass without an output' 'nowhere to write' filter normals block.exr --backend cpu
refuses 'a pass that draws' 'draws a scene' filter sphere_depth block.exr -o a.exr --backend cpu
refuses 'a pass on particles' 'sparse: works on particles and filters no image' filter sparse block.exr -o a.exr --backend cpu
refuses 'a check of a pass on particles' 'sparse: works on particles, on the CPU for both backends' check sparse
refuses 'an unknown pass to run' 'blur: no such pass' filter blur block.exr -o a.exr --backend cpu
refuses 'an image without what the pass reads' 'normals reads depth (Z)' \
    filter normals dump/color.exr -o n.exr --backend cpu
refuses 'an unknown port' '--channel deep=Z' filter normals block.exr -o n.exr --backend cpu --channel deep=Z
refuses 'window depth without its planes' 'need --near' filter normals block.exr -o n.exr --backend cpu --depth window
refuses 'planes in the wrong order' '--far 1: must be beyond --near 2' \
    filter normals block.exr -o n.exr --backend cpu --depth window --near 2 --far 1
refuses 'a pass into a PNG' 'n.png: the name must end in .exr' filter normals block.exr -o n.png --backend cpu
that 'no refused pass writes' nothing_at n.exr n.png
accepts 'another channel as depth' filter normals block.exr -o n.exr --backend cpu --channel depth=T --depth positive
accepts 'a depth image of the wrong kind' filter normals block.exr -o n.exr --backend cpu --depth positive
that 'is warned of' grep -q 'warning: .*is --depth right' err
accepts 'in a channel of any name' filter normals dump/thickness.exr -o n.exr --backend cpu --channel depth=T
that 'as well' grep -q 'warning: .*is --depth right' err

# ---- lists ----

accepts 'the passes' passes
that 'the passes name their source' grep -q '^curvature_flow.*van der Laan' out
accepts 'one pass' passes curvature_flow
that 'a parameter has unit, default, range and help' grep -q '^iterations	1	[0-9]*	\[0, [0-9]*\]	' out
accepts 'the pipelines' pipelines
accepts 'one pipeline' pipelines vanderlaan2009
that 'keys are those of --set' grep -q '^medium.ior	' out
accepts 'what runs' info
accepts 'what runs, as JSON' info --json
that 'the JSON names the libraries' grep -q '"OpenEXR": "[0-9]' out
cp out info.json
if [ -c /dev/full ]; then
    "$ssfr" passes >/dev/full 2>err
    that 'a full disk behind stdout leaves with 2' [ $? -eq 2 ]
fi

# ---- OpenGL ----

if grep -q '"renderer": null' info.json; then
    if [ "$GL" = required ]; then bad 'OpenGL is there' "$(cat err)"; else echo 'skip - OpenGL: there is none'; fi
else
    accepts 'a scene by OpenGL' render block -o gl.exr --size 64x48
    accepts 'both backends draw the same' compare gl.exr block.exr --require 'psnr>=60' --require 'depth_rms<=1e-5'
    accepts 'OpenGL leaves out as well' render block -o glkept.exr --size 64x48 --keep-all
    accepts 'and changes no bit either' compare glkept.exr gl.exr --require max_abs==0 --require Z.max_abs==0
    accepts 'a pass by OpenGL' filter normals dump/surface_depth.exr -o normals.exr
    accepts 'on the same input' compare normals.exr dump/normal.exr --require 'normal_max_deg<=0.01'
fi
}

finish
