#!/bin/sh
# SPDX-License-Identifier: MIT
# deps.sh PACKAGE...: installs the Debian packages that are missing; elsewhere it names them. Silent when all are there.

missing=''
if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    for tool in gcc g++ pkg-config gnuplot; do
        command -v $tool >/dev/null || missing="$missing $tool"
    done
    for module in epoxy egl OpenEXR libpng zlib hdf5 yaml-0.1 gsl cmocka; do
        pkg-config --exists $module 2>/dev/null || missing="$missing $module"
    done
    [ -f /usr/include/opencv4/opencv2/quality.hpp ] || missing="$missing opencv-contrib(quality)"
    [ -z "$missing" ] && exit 0
    echo "ssfr: missing:$missing; on Debian these are the packages: $*" >&2
    exit 1
fi

for package in "$@"; do
    dpkg-query -W -f '${db:Status-Status}\n' "$package" 2>/dev/null | grep -qx installed || missing="$missing $package"
done
[ -z "$missing" ] && exit 0

as_root=''
if [ "$(id -u)" -ne 0 ]; then
    as_root='sudo'
    command -v sudo >/dev/null || { echo "ssfr: to install as root:$missing" >&2; exit 1; }
fi
echo "ssfr: installing$missing"
# shellcheck disable=SC2086 # several words each
$as_root env DEBIAN_FRONTEND=noninteractive apt-get update -qq &&
    $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing >/dev/null
