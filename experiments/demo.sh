#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# demo.sh: renders one frame with both backends, compares them, and times the passes. `make demo` runs it.
set -e
ssfr=${BUILD:-build}/ssfr
out=results/demo
scene=splash
mkdir -p $out

if $ssfr info --json -q 2>/dev/null | grep -q '"renderer": null'; then
    echo "no OpenGL 4.5 here: the frame is drawn by the CPU twins alone"
    $ssfr render $scene --size 1280x720 --backend cpu -o $out/$scene.png
    echo
    $ssfr bench --scene $scene --size 1280x720 --backend cpu --quick -o $out/bench.csv
    echo
    echo "wrote $out/$scene.png, $out/bench.csv"
    exit 0
fi

$ssfr render $scene --size 1280x720 -o $out/$scene.png
$ssfr render $scene --size 1280x720 -o $out/$scene.exr
$ssfr render $scene --size 1280x720 -o $out/${scene}_cpu.exr --backend cpu
echo "OpenGL (32-bit) against its double-precision twin on the CPU:"
$ssfr compare $out/$scene.exr $out/${scene}_cpu.exr >$out/rounding.csv
grep -E '^(metric|psnr|ssim|depth_rms|depth_max|normal_mean_deg|nan_count),' $out/rounding.csv | sed 's/^/  /'
echo
$ssfr bench --scene $scene --size 1280x720 --quick -o $out/bench.csv
echo
echo "wrote $out/$scene.png, $out/$scene.exr, $out/${scene}_cpu.exr, $out/rounding.csv, $out/bench.csv"
