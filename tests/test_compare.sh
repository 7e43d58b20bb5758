#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# test_compare.sh: comparing with a reference that tells its own error, wholly known or sampled; the flow without steps.

test=compare
. "$(dirname "$0")/cases.sh"

has() { awk -F, -v m="$2" '$1 == m { found = 1 } END { exit !found }' "$1"; }
lacks() { ! has "$@"; }

# holds FILE EXPRESSION: of the rows' values, written as v["metric"], low["metric"] and high["metric"].
holds() { awk -F, 'NR > 1 { v[$1] = $3; low[$1] = $4; high[$1] = $5 } END { exit !('"$2"') }' "$1"; }

small="--size 48x32"
accepts 'a picture' render block -o a.exr --backend cpu $small
accepts 'its truth' truth block -o all.exr --no-cache $small
accepts 'a sample of it' truth block -o some.exr --every 3 --no-cache $small

# ---- everything known ----

accepts 'a picture with its truth' compare a.exr all.exr
cp out all.csv
that 'interior and edge stand apart, for depths' \
    holds all.csv 'v["depth_rms_interior"] > 0 && v["depth_rms_edge"] > 0 && v["depth_max_interior"] > 0'
that 'and for normals' holds all.csv 'v["normal_mean_interior_deg"] > 0 && v["normal_mean_edge_deg"] > 0'
that 'lengths come in radii' holds all.csv '(v["depth_rms_radii"] * 0.02 / v["depth_rms"] - 1)^2 < 1e-12'
that 'with their unit' grep -q '^depth_max_interior_radii,radii,' all.csv
that 'angles do not' lacks all.csv normal_mean_deg_radii
that 'the truth has errors' \
    holds all.csv 'v["Z.err_max"] > 0 && v["Z.err_max"] >= v["Z.err_mean"] && v["Z.err_mean"] > 0'
that 'of normals, in degrees' grep -q '^N.err_max_deg,deg,[0-9]' all.csv
that 'of thickness and colour' holds all.csv 'v["T.err_max"] >= v["T.err_mean"] && v["C.err_max"] >= v["C.err_mean"]'
that 'that are far below what is measured' holds all.csv 'v["Z.err_mean"] < 1e-4 * v["depth_rms"]'
that 'no interval is needed' awk -F, 'NR > 1 && ($4 != "" || $5 != "") { exit 1 }' all.csv
that 'depths have no mean over pixels without a surface' lacks all.csv Z.mse
that 'nor normals' lacks all.csv N.mean_difference
that 'but may be the same to the bit' has all.csv Z.max_abs
that 'lengths have means' holds all.csv 'v["T.mean_difference"] != 0 && v["T.mse"] >= v["T.mean_difference"]^2'
that 'with units' grep -q '^T.mse,m^2,' all.csv
that 'in radii, too' grep -q '^T.mean_difference_radii,radii,' all.csv
that 'the median is between the extremes' \
    holds all.csv 'v["depth_median_interior"]^2 < v["depth_max_interior"]^2 && v["depth_median_interior"] < 0'
refuses 'a picture without depth' 'draws depth, and Z is not compared' \
    compare a.exr all.exr --channel N.X,N.Y,N.Z --picture n.png
that 'before anything is said' [ ! -s out ]
refuses 'a demand on what is not measured' 'is not among what was measured' \
    compare a.exr all.exr --require 'blur<1' --picture n.png --diff n.exr
that 'without a picture or a difference' [ ! -e n.png -a ! -e n.exr ]
accepts 'the truth with itself' compare all.exr all.exr --channel N.err --channel N.X,N.Y,N.Z --diff zero.exr
degrees=$(number out N.err_max_deg)
accepts 'its errors alone' compare all.exr zero.exr --channel N.err
that 'which are radians in the file' holds out "(v[\"N.err.max_abs\"] * 45 / atan2(1, 1) / $degrees - 1)^2 < 1e-6"
accepts 'every ninth pixel of all' compare a.exr all.exr --channel Z --mask some.exr:cast
that 'has errors of its own' holds out "v[\"Z.err_mean\"] > 0 && v[\"Z.err_mean\"] != $(number all.csv Z.err_mean)"
accepts 'larger particles' render block -o large.exr --backend cpu --radius 0.05 $small
accepts 'against the truth' compare large.exr all.exr --channel Z
that 'whose radius counts' holds out '(v["depth_max_radii"] * 0.02 / v["depth_max"] - 1)^2 < 1e-12'
accepts 'the other way round' compare all.exr large.exr --channel Z
that 'theirs does' holds out '(v["depth_max_radii"] * 0.05 / v["depth_max"] - 1)^2 < 1e-12'
accepts 'another radius' compare a.exr all.exr --channel Z --radius 0.5
that 'is taken' holds out '(v["depth_rms_radii"] * 0.5 / v["depth_rms"] - 1)^2 < 1e-12'
accepts 'a requirement in radii' compare a.exr all.exr \
    --require 'depth_mean_interior_radii<0' --require 'Z.err_mean<1e-3'
refuses 'a radius of nothing' '--radius' compare a.exr all.exr --radius 0
accepts 'the truth with a picture' compare all.exr a.exr --channel Z
that 'which says nothing of its error' lacks out Z.err_mean
that 'but the radius' has out depth_rms_radii

# ---- a sample ----

accepts 'a picture with a sample of its truth' compare a.exr some.exr
cp out some.csv
that 'means have intervals around them' \
    holds some.csv 'low["depth_mean"] != "" && low["depth_mean"] < v["depth_mean"] &&
    v["depth_mean"] < high["depth_mean"] && low["depth_rms"] < v["depth_rms"] && v["depth_rms"] < high["depth_rms"] &&
    low["psnr"] < v["psnr"] && v["psnr"] < high["psnr"] && low["Z.err_mean"] < high["Z.err_mean"]'
for metric in depth_rms depth_mean normal_mean_deg silhouette_iou psnr; do
    whole=$(number all.csv $metric)
    that "that of $metric holds the whole image's" \
        holds some.csv "low[\"$metric\"] <= $whole && $whole <= high[\"$metric\"]"
done
that 'what is interior the picture says alone' holds some.csv 'v["depth_mean_interior"] < 0'
that 'largest values have none' \
    holds some.csv 'v["depth_max"] > 0 && low["depth_max"] == "" && high["depth_max"] == ""'
that 'and are no larger than all' holds some.csv "v[\"depth_max\"] <= $(number all.csv depth_max)"
that 'what looks around pixels is left out' lacks some.csv ssim
that 'all of it' lacks some.csv flip
run compare a.exr some.exr --require 'ssim>=0'
that 'and cannot be required' [ $status -eq 2 ]
accepts 'a narrower picture' render block -o ten.exr --backend cpu --size 10x32
refuses 'a mask of another size' '10x32 pixels of 1 channels, not 48x32 of one' compare a.exr some.exr --mask ten.exr:Z
refuses 'a mask of three channels' '48x32 pixels of 3 channels' compare a.exr some.exr --mask a.exr:R,G,B
accepts 'a sample under a mask' compare a.exr some.exr --channel Z --mask a.exr:Z
that 'counts' holds out 'v["depth_rms"] > 0'
accepts 'another sample' truth block -o other.exr --every 3 --seed 2 --no-cache $small
accepts 'the difference of both' compare some.exr other.exr --channel Z --channel cast --diff broken.exr
refuses 'a cast that is no sample' 'are not one of each square' compare a.exr broken.exr

accepts 'help' compare --help
that 'tells the estimator' grep -q 'collapsed strata' out

# ---- the flow without steps ----

accepts 'a small depth image' render block -o depth.exr --backend cpu --size 20x20 --set curvature_flow.iterations=0
for method in rk8pd msbdf; do
    accepts "the flow by $method" filter curvature_flow depth.exr -o $method.exr --reference $method \
        --set curvature_flow.iterations=5
    that 'says how it went in one line' grep -Eq "^$method: [0-9]+ unknowns to .* err [0-9.e-]+ m\$" out
    that 'and only one' [ "$(wc -l <out)" -eq 1 ]
    that 'and in the file' grep -aq reference.err $method.exr
done
accepts 'both are the same' compare rk8pd.exr msbdf.exr --require 'depth_max<=1e-5'
accepts 'and not the input' compare rk8pd.exr depth.exr --channel Z --require 'depth_max>1e-4'
for n in 1 16; do
    accepts "the pass with $n times as many steps" filter curvature_flow depth.exr -o steps_$n.exr --backend cpu \
        --set curvature_flow.iterations=$((5 * n)) --set curvature_flow.dt="$(awk "BEGIN { print 0.002 / $n }")"
done
accepts 'without steps' filter curvature_flow depth.exr -o exact.exr --reference rk8pd \
    --set curvature_flow.iterations=5 --set curvature_flow.dt=0.002
run compare steps_1.exr exact.exr; coarse=$(number out depth_rms)
run compare steps_16.exr exact.exr; fine=$(number out depth_rms)
that 'is what steps come to' awk "BEGIN { exit !($fine < $coarse / 8) }"
refuses 'another pass' 'of curvature_flow only, not of normals' filter normals depth.exr -o n.exr --reference rk8pd
refuses 'another solver' '--reference' filter curvature_flow depth.exr -o n.exr --reference euler
accepts 'a larger one' render block -o large.exr --backend cpu --size 64x64
refuses 'an image too large for it' 'msbdf takes up to 24x24' \
    filter curvature_flow large.exr -o n.exr --reference msbdf
that 'no refused image is written' [ ! -e n.exr ]

finish
