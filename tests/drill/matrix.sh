#!/bin/sh
# The matrix of determinism: a small sweep of each protocol has one digest, whatever the number of workers, shards, the
# kills on the way, the compiler and the optimisation. A scene has one table of states, whatever the kernel.
# Argument: the build folder. Prints a row a cell, and fails where two differ.
set -u
build=$1
work=$build/drill
program=$build/repose
bad=0
rm -rf "$work/sweeps"
. tests/drill/sweeps.sh

# cell PROTOCOL "what" DIGEST: the first of a protocol is what the others must be.
cell() {
    [ -f "$work/sweeps/$1.digest" ] || printf '%s\n' "$3" >"$work/sweeps/$1.digest"
    same=$([ -n "$3" ] && [ "$3" = "$(cat "$work/sweeps/$1.digest")" ] && echo same || echo DIFFERS)
    [ $same = same ] || bad=1
    printf '%s\t%s\t%s\t%s\n' "$1" "$2" "$3" $same
}

# digest_of DIR; plan_of PROTOCOL DIR
digest_of() { "$program" sweep digest "$1" | cut -f 1; }
plan_of() { rm -rf "$2" && "$program" sweep plan "$work/sweeps/$1.cfg" -o "$2" >/dev/null; }

# Killed when the first row is stored, and then whenever there is one more, until it is done.
stored() { "$program" sweep status "$1" | sed -n 's/^# stored: //p'; }
interrupted() {
    while :; do
        before=$(stored "$1")
        "$program" sweep run "$1" -j 2 >/dev/null 2>&1 &
        drive=$!
        while [ "$(stored "$1")" -le "$before" ] && kill -0 $drive 2>/dev/null; do :; done
        kill -KILL $drive 2>/dev/null || { wait $drive && break; }
        wait $drive
    done 2>/dev/null
}

echo "# protocol	cell	digest	verdict"
for protocol in repose stress onset flux pile drop; do
    dir=$work/sweeps/$protocol.d
    for workers in 1 2 5; do
        plan_of $protocol "$dir"
        "$program" sweep run "$dir" -j $workers >/dev/null
        cell $protocol "$workers workers" "$(digest_of "$dir")"
    done
    plan_of $protocol "$dir"
    interrupted "$dir"
    cell $protocol 'kills' "$(digest_of "$dir")"
    for shards in 1 3 8; do
        plan_of $protocol "$dir"
        for shard in $(seq $shards -1 1); do "$program" sweep run "$dir" --shard "$shard/$shards" -j 1 >/dev/null; done
        cell $protocol "$shards shards" "$(digest_of "$dir")"
        "$program" sweep merge "$dir" >/dev/null && rm -r "$dir/shards"
        cell $protocol "$shards shards merged" "$(digest_of "$dir")"
    done
done

# The final state of a row, run as a scene by each kernel that this machine has.
"$program" run "$work/sweeps/repose.cfg" --row 1 -o "$work/sweeps/row" >/dev/null
for kernel in reference baseline avx2 avx512; do
    "$program" run "$work/sweeps/row/scene.cfg" --set kernel=$kernel --force -o "$work/sweeps/kernel" >/dev/null 2>"$work/sweeps/why" ||
        { grep -q 'kernel' "$work/sweeps/why" && continue; }
    cell scene "kernel $kernel" "$(grep -v '^#' "$work/sweeps/kernel/states.tsv" | md5sum | cut -c 1-32)"
done

# The same scene, stopped as soon as it has begun, and continued by the same command.
snap=$work/sweeps/snap
for start in 1 2 3 4 5; do
    "$program" run "$work/sweeps/row/scene.cfg" -o "$snap" >/dev/null 2>&1 &
    until [ -e "$snap.part" ] || [ -e "$snap" ]; do :; done
    kill -TERM $! 2>/dev/null
    wait $! 2>/dev/null
done
"$program" run "$work/sweeps/row/scene.cfg" -o "$snap" >/dev/null 2>&1
cell scene "snapshots" "$(grep -v '^#' "$snap/states.tsv" | md5sum | cut -c 1-32)"

for compiler in gcc clang; do
    for level in -O3 -O1; do
        other=$work/$compiler$level
        command -v $compiler >/dev/null || continue
        program=$build/repose
        ${MAKE:-make} -s CC="${CCACHE:-} $compiler" SAN=$level B="$other" "$other/repose" >"$work/$compiler$level.log" 2>&1 ||
            { echo "matrix: $compiler $level does not build, see $work/$compiler$level.log" >&2; bad=1; continue; }
        program=$other/repose
        for protocol in repose stress onset flux pile drop; do
            dir=$work/sweeps/$protocol.other
            plan_of $protocol "$dir"
            "$program" sweep run "$dir" -j 2 >/dev/null
            cell $protocol "$compiler $level" "$(digest_of "$dir")"
        done
    done
done
exit $bad
