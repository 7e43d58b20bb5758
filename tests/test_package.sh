#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# test_package.sh: the library as others get it: what it links and exports, its header, installing, using, removing it.

test=package
. "$(dirname "$0")/cases.sh"

root=$(dirname "$here")
if [ -n "$SAN" ]; then
    echo 'skip - what is installed: is not what is sanitised'
    finish
    exit
fi
so=$root/${BUILD:-build}/libssfr.so
a=$root/${BUILD:-build}/libssfr.a
header=$root/libssfr/ssfr.h
dest=$work/dest
version=$(sed -n 's/^.define SSFR_VERSION "\(.*\)"/\1/p' "$header")
major=${version%%.*}

none() { [ -z "$("$@")" ] || { "$@"; return 1; }; }
quietly() { "$@" >quiet 2>&1 || { sed 's/^/# /' quiet; return 1; }; }

# ---- what it links and exports ----

needed() { readelf -d "$so" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p'; }
loaded() { ldd "$so" | awk '{ print $1 }'; }
foreign() { "$1" | grep -E 'stdc\+\+|gsl|opencv|yaml|python'; }
that 'links no C++, no GSL, no OpenCV' none foreign needed
that 'loads none through others either' none foreign loaded
that 'finds everything it loads' none sh -c "ldd '$so' | grep 'not found'"
that 'has the soname of its major version' \
    [ "$(readelf -d "$so" | sed -n 's/.*(SONAME).*\[\(.*\)\]/\1/p')" = "libssfr.so.$major" ]

exports() { nm -D --defined-only "$so" | awk '{ print $3 }' | sort; }
declared() { sed -n 's/^SSFR_API .*[ *]\(ssfr_[a-z_]*\)(.*/\1/p' "$header" | sort; }
exports >exports
declared >declared
that 'exports nothing but ssfr_*' none grep -v '^ssfr_' exports
that 'exports what the header declares' cmp -s exports declared
that 'the static library has no other names either' \
    none sh -c "nm -g --defined-only '$a' | awk 'NF == 3 && \$3 !~ /^ssfr_/ { print \$3 }'"

# ---- the header by itself ----

warnings='-Wall -Wextra -Werror -pedantic -fsyntax-only'
echo '#include "ssfr.h"' >alone.c
cp alone.c alone.cpp
cat >twice.cpp <<'END'
#include "ssfr.h"
#include "ssfr.h"
int main() { ssfr_field f = {1, 1, 1, nullptr}; return ssfr_field_at(&f, 0, 0) == nullptr ? 0 : 1; }
END
# shellcheck disable=SC2086 # several options
{
that 'the header compiles alone as C17' gcc -std=c17 $warnings -I"$root/libssfr" alone.c
that 'as C23' gcc -std=c2x $warnings -I"$root/libssfr" alone.c
that 'as C++17' g++ -std=c++17 $warnings -I"$root/libssfr" alone.cpp
that 'and twice over' g++ -std=c++17 $warnings -I"$root/libssfr" twice.cpp
}

# ---- installing ----

# make_ssfr TARGET: quiet, and not as a part of a make that runs this test.
make_ssfr() { quietly env -u MAKEFLAGS -u MAKELEVEL make -s -C "$root" "$1" DESTDIR="$dest" PREFIX=/usr; }
installed() { (cd "$dest" && find . ! -type d | sort); }
sort >wanted <<END
./usr/bin/ssfr
./usr/include/ssfr.h
./usr/lib/libssfr.a
./usr/lib/libssfr.so
./usr/lib/libssfr.so.$major
./usr/lib/libssfr.so.$version
./usr/lib/pkgconfig/ssfr.pc
END
that 'installs below DESTDIR' make_ssfr install
installed >got
that 'seven files and no more' cmp -s got wanted
that 'links that lead there' [ -e "$dest/usr/lib/libssfr.so" ]
that 'the command runs from there' [ "$("$dest/usr/bin/ssfr" --version)" = "ssfr $version" ]
that 'installs again over itself' make_ssfr install

export PKG_CONFIG_PATH="$dest/usr/lib/pkgconfig"
config="pkg-config --define-variable=prefix=$dest/usr"
that 'the version by pkg-config' [ "$(pkg-config --modversion ssfr)" = "$version" ]
that 'the prefix by pkg-config' [ "$(pkg-config --variable=prefix ssfr)" = /usr ]
that 'what a static program links is there' pkg-config --exists --static ssfr
that 'others link ssfr alone' [ "$($config --libs ssfr | tr -d ' ')" = "-L$dest/usr/lib-lssfr" ]

# ---- using it ----

# 4 x 4 x 4 particles of 3 cm, 5 cm apart, as .pos: a count, a radius, positions, in little-endian floats.
float() { awk -v v="$1" 'BEGIN {
    e = 127; while (v >= 2) { v /= 2; e++ } while (v && v < 1) { v *= 2; e-- }
    bits = v ? e * 8388608 + int((v - 1) * 8388608 + 0.5) : 0
    for (i = 0; i < 4; i++) { printf "\\%03o", bits % 256; bits = int(bits / 256) } }'; }
{
    printf '\100\000\000\000%b' "$(float 0.03 | sed 's/\\/\\0/g')"
    for z in 0 0.05 0.1 0.15; do for y in 0 0.05 0.1 0.15; do for x in 0 0.05 0.1 0.15; do
        printf '%b' "$( (float $x; float $y; float $z) | sed 's/\\/\\0/g')"
    done; done; done
} >block.pos
that 'a file of particles is made' [ "$(wc -c <block.pos)" -eq 776 ]

cp "$root/docs/example/render.c" "$root/docs/example/Makefile" .
export LD_LIBRARY_PATH="$dest/usr/lib"
that 'the example builds against what is installed' quietly env -u MAKEFLAGS -u MAKELEVEL make -s \
    PKG_CONFIG="$config" CFLAGS='-O2 -Wall -Wextra -Wconversion -Werror -pedantic'
that 'and runs' quietly ./render block.pos cpu.png cpu
that 'and writes a picture' is_png cpu.png
that 'that is not empty' [ "$(wc -c <cpu.png)" -gt 20000 ]
./render none.pos none.png cpu >out 2>err
that 'an error is one line' [ "$(wc -l <err)" -eq 1 ]
that 'which names the file' grep -q 'none.pos: No such file' err
that 'and writes nothing' [ ! -e none.png ]
if ./render block.pos gl.png >out 2>err; then
    that 'the GPU draws the same' quietly "$ssfr" compare gl.png cpu.png --require 'psnr>=50'
elif [ "$GL" = required ]; then
    bad 'the example runs on the GPU' "$(cat err)"
else
    echo 'skip - the example on the GPU: there is none'
fi

# ---- removing it ----

that 'uninstalls' make_ssfr uninstall
that 'and leaves nothing' none installed

finish
