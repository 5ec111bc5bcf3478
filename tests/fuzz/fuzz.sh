#!/bin/sh
# Fuzzing of every reader by libFuzzer, under the address and undefined-behaviour sanitizers. Arguments: the build folder,
# seconds for each target or, with "runs=N", runs, the number of processes at a time, and targets (none: all). What is found
# stays in BUILD/fuzz/found; new inputs in BUILD/fuzz/NAME. Installs clang if it is missing.
mkdir -p "$1"
given=$1 build=$(cd "$1" && pwd) effort=$2 jobs=$3
shift 3
sh tests/setup.sh clang libclang-rt-14-dev || exit 1
case $effort in runs=*) limit="-runs=${effort#runs=}" ;; *) limit="-max_total_time=$effort" ;; esac
mkdir -p "$build/fuzz/found"
make --no-print-directory -j"$jobs" CC=clang B="$given/fuzz/obj" CHECK='$(FUZZ)' \
    SAN='-fsanitize=fuzzer,address,undefined -fno-sanitize-recover=undefined -g -O1 -w' "$given/fuzz/obj/check" || exit 1
[ $# -gt 0 ] || set -- $(ls tests/fuzz/corpus)
printf '%s\n' "$@" | ASAN_OPTIONS=allocator_may_return_null=1:detect_leaks=1 UBSAN_OPTIONS=print_stacktrace=1 \
    xargs -P "$jobs" -I{} sh -c 'mkdir -p "$1/fuzz/{}"
        FUZZ={} "$1/fuzz/obj/check" "$2" -max_len=4096 -len_control=20 -timeout=60 -rss_limit_mb=4000 -detect_leaks=0 -close_fd_mask=3 -print_final_stats=1 \
            -artifact_prefix="$1/fuzz/found/{}-" "$1/fuzz/{}" "$3/{}" >"$1/fuzz/{}.log" 2>&1
        status=$?
        runs=$(sed -n "s/^stat::number_of_executed_units: *//p" "$1/fuzz/{}.log")
        echo "{}	${runs:-0}	$status" | tee -a "$1/fuzz/runs.tsv"
        [ $status = 0 ]' sh "$build" "$limit" "$PWD/tests/fuzz/corpus"
status=$? # a target that never began leaves nothing in found
! ls "$build/fuzz/found" | grep . && [ $status = 0 ]
