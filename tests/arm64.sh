#!/bin/sh
# `make check-arm64`: the program for 64-bit Arm, cross-built and run by qemu in a Debian root of its own
# (build/arm64/root); nothing is installed on the machine. Goldens and fingerprints hold, and the examples end with the
# numbers of the native program, to the last digit.
set -eu
native=build/repose home=build/arm64 root=build/arm64/root
[ "$(id -u)" = 0 ] && command -v mmdebstrap >/dev/null || {
    echo "check-arm64: needs root and mmdebstrap: apt-get install mmdebstrap" >&2
    exit 1
}
libraries=$(printf '%s:arm64,' libgsl-dev libnlopt-dev libconfig-dev libsqlite3-dev libsuitesparse-dev libxxhash-dev \
    libjansson-dev zlib1g-dev libcunit1-dev)
if [ ! -e $home/made ]; then
    echo "arm64   Debian's packages, 1 GB" && rm -rf $root && mkdir -p $root
    mmdebstrap --quiet --variant=apt --architectures=amd64,arm64 bookworm $root \
        --include="$libraries"librandom123-dev,make,pkg-config,gcc,libc6-dev,gcc-aarch64-linux-gnu,libc6-dev-arm64-cross,qemu-user-static
    touch $home/made
fi
mkdir -p $root/src && tar -c --exclude=./build --exclude=./.git . | tar -x -C $root/src
arm() {
    unshare --mount --pid --fork --mount-proc=$root/proc chroot $root env -C /src REPOSE=/src/build/repose.qemu \
        PKG_CONFIG_LIBDIR=/usr/lib/aarch64-linux-gnu/pkgconfig:/usr/share/pkgconfig "$@"
}
# gcc 12 for Arm ends with an internal error in the loops of two tests.
arm make -s CC="aarch64-linux-gnu-gcc -fno-tree-loop-vectorize" build/obj/tests/test_columns.o build/obj/tests/test_fills.o
arm make -s -j"$(nproc)" CC=aarch64-linux-gnu-gcc build/repose build/check
printf '#!/bin/sh\nexec qemu-aarch64-static /src/build/repose "$@"\n' >$root/src/build/repose.qemu
chmod +x $root/src/build/repose.qemu
bad=0
same() { # same WORD...: a run by both programs
    $native run "$@" 2>/dev/null | grep -v '^#' >$home/native
    arm build/repose.qemu run "$@" 2>/dev/null | grep -v '^#' >$home/arm
    if [ -s $home/native ] && cmp -s $home/native $home/arm; then echo "arm64   equal: repose run $*"; else
        echo "arm64   NOT EQUAL: repose run $*" && bad=1
    fi
}
for scene in pile chute impact shear_box scene; do same examples/$scene.cfg; done
# A disk that rolls to rest on the ground: its speed falls below the smallest normal number.
cat >build/alone.cfg <<'TEXT'
dt = 5.0e-5; steps = 60000;
tangential = { law = "slip_roll"; mu = 0.2; gamma_s = 2000.0; };
walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; } );
particles = ( { x = 0.0; y = 0.0999; r = 0.1; vx = 3.0; } );
TEXT
cp build/alone.cfg $root/src/build/alone.cfg
same build/alone.cfg --every 100
same examples/drum.cfg --set fill.N=100 --set turns=0.1
same examples/hopper.cfg --set fill.N=400
same examples/cylinder.cfg --set aspect=0.5
arm qemu-aarch64-static build/check golden core units expression laws angle || bad=1
exit $bad
