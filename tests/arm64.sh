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
libraries=$(printf '%s:arm64,' libgsl-dev libconfig-dev libsqlite3-dev libsuitesparse-dev libxxhash-dev \
    libjansson-dev libcunit1-dev)
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
# equal WHAT FILE: $home/native and $home/arm.
equal() {
    if [ -s $home/native ] && cmp -s $home/native $home/arm; then echo "arm64   equal: $*"; else
        echo "arm64   NOT EQUAL: $*" && diff $home/native $home/arm | head -4
        bad=1
    fi
}
# same WORD...: what both programs print, digests too, but for the lines that tell which program it was.
same() {
    $native "$@" 2>/dev/null | grep -Ev '^# (program|compiler|libraries|kernel):' >$home/native || true
    arm build/repose.qemu "$@" 2>/dev/null | grep -Ev '^# (program|compiler|libraries|kernel):' >$home/arm || true
    equal "repose $*"
}
# to_both FILE: a file made here goes to the other program, too.
to_both() { mkdir -p "$root/src/$(dirname "$1")" && cp -r "$1" "$root/src/$1"; }
# words SECTION KEY: of a choice in scenes.
words() {
    $native params scene | awk -v section="# scene file, $1:" -v key="$2" '/^# scene file/ { inside = index($0, section) == 1 }
        inside && $1 == "#" && $2 == key && $3 == "=" { sub(":", "", $4); print $4 }'
}
# laws NORMAL TANGENTIAL ROLLING INTEGRATOR: a fall with every function of `let` and of measures.
laws() {
    case $2 in
        spring | mindlin) friction='mu = 0.4; k_s = "k_n"; gamma_s = 300.0;' ;;
        slip_roll) friction='mu = 0.4; gamma_s = 300.0;' ;;
        *) friction= ;;
    esac
    laws="normal = { law = \"$1\"; k_n = \"k_n\"; restitution = 0.6; restitution_speed = 30.0; }; tangential = { law = \"$2\"; $friction };"
    [ "$2" != mindlin ] || laws='material = { E = 1e7; nu = 0.3; restitution = 0.6; mu = 0.4; };'
    [ "$3" = none ] || laws="$laws rolling = { model = \"$3\"; mu = 0.05; };"
    cat >"$home/$1-$2-$3-$4.cfg" <<TEXT
let = { a = { value = 0.7; range = "[0, 1]"; }; k_n = 2e5; };
dt = "min(1e-4, 0.25*dt_limit(60))"; rotation = $([ "$4" = verlet ] && echo true || echo false); integrator = "$4"; $laws
gravity = ( "100*tan(0.1*a) + 10*min(a, sqrt(a)) - abs(cos(3*a))", "-800*sin(1 + a) - max(round(7*a), floor(9.9*a))^1.5" );
walls = ( { point = (0.0, 0.0); direction = ("sin(0.05)", 1.0); }, { point = (0.0, 0.0); direction = (1.0, 0.0); },
          { point = (2.0, 0.0); direction = (-1.0, 0.0); } );
fill = { N = 40; W = 2.0; H = 3.0; y0 = 0.2; radius_law = "lognormal"; };
phases = ( { name = "fall"; time = 0.2; } );
measure = ( { name = "functions"; of = "atan(y) + exp(-x) + log(y + 1)"; } );
TEXT
    to_both "$home/$1-$2-$3-$4.cfg"
    same run "$home/$1-$2-$3-$4.cfg"
}
for normal in $(words normal law); do laws "$normal" spring none verlet; done
for tangential in $(words tangential law); do laws elastic "$tangential" none verlet; done
for rolling in $(words rolling model); do laws hertz spring "$rolling" verlet; done
for integrator in $(words 'top level' integrator); do laws hertz slip_roll none "$integrator"; done
for function in $($native params experiment | sed -n 's/.* m g; \([a-z ]*\) held known change.*/\1/p'); do
    grep -q "[^a-z]$function(" $home/hertz-slip_roll-none-verlet.cfg || { echo "arm64   no run has $function()" && bad=1; }
done
for scene in pile chute impact shear_box scene; do same run examples/$scene.cfg; done
# A disk that rolls to rest on the ground: its speed falls below the smallest normal number.
cat >build/alone.cfg <<'TEXT'
dt = 5.0e-5; steps = 60000;
tangential = { law = "slip_roll"; mu = 0.2; gamma_s = 2000.0; };
walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; } );
particles = ( { x = 0.0; y = 0.0999; r = 0.1; vx = 3.0; } );
TEXT
cp build/alone.cfg $root/src/build/alone.cfg
same run build/alone.cfg --every 100
same run examples/drum.cfg --set fill.N=100 --set turns=0.1
same run examples/hopper.cfg --set fill.N=400
same run examples/cylinder.cfg --set aspect=0.5
# Names from runs that are given; and the digest of a sweep of each protocol but the static one.
awk 'BEGIN { print "a\tb\ty"; for (i = 0; i < 60; i++) print (a = i%10/10) "\t" (b = int(i/10)/5) "\t" 0.4 + 2*a + a*a - b + 0.02*(i*i%7 - 3) }' >$home/t.tsv
echo 'fit = { a = [0.0, 0.9]; b = [0.0, 1.0]; }; measured = ( { runs = "t.tsv"; of = "y"; value = 1.2; error = 0.02; } );' >$home/two.cfg
echo 'fit = { a = [0.0, 0.9]; }; measured = ( { runs = "one.tsv"; of = "y"; value = 1.2; error = 0.02; } );' >$home/one.cfg
cut -f 1,3 $home/t.tsv >$home/one.tsv
for file in one two; do
    to_both $home/t.tsv && to_both $home/one.tsv && to_both $home/$file.cfg
    same calibrate $home/$file.cfg
done
work=$home
. tests/drill/sweeps.sh
rm $home/sweeps/pile.cfg
for sweep in $home/sweeps/*.cfg; do
    to_both "$sweep" && rm -rf $home/made.d "$root/src/$home/made.d"
    $native sweep make "$sweep" -o $home/made.d >/dev/null 2>&1 || true
    arm build/repose.qemu sweep make "$sweep" -o $home/made.d >/dev/null 2>&1 || true
    $native sweep digest $home/made.d >$home/native || true
    arm build/repose.qemu sweep digest $home/made.d >$home/arm || true
    equal "sweep digest, $sweep"
done
arm qemu-aarch64-static build/check golden core units expression laws angle || bad=1
# A build that fuses products and sums says so, and runs nothing.
rm -f $root/src/build/obj/src/core/version.o
arm make -s CC=aarch64-linux-gnu-gcc CFLAGS='-O2 -ffp-contract=fast' build/repose
if arm build/repose.qemu run examples/impact.cfg 2>&1 | grep -q 'fuses products and sums'; then echo "arm64   a fused build is refused"; else
    echo "arm64   a fused build runs" && bad=1
fi
rm -f $root/src/build/obj/src/core/version.o
exit $bad
