#!/bin/sh
# The modules' borders. Arguments: the build folder, then module=folder=prefix for each module.
# core <- {analytic, dem, angle} <- sweep <- {cli, tests, validation}; each exports its own prefix only.
build=$1
shift
bad=0
for entry; do
    module=${entry%%=*} rest=${entry#*=}
    folder=${rest%%=*} prefix=${rest#*=}
    case $module in
    core) allowed='core/' ;;
    analytic) allowed='core/|analytic/' ;;
    dem) allowed='core/|dem/' ;;
    angle) allowed='core/|angle/' ;;
    sweep) allowed='core/|analytic/|dem/|angle/|sweeps/' ;;
    esac
    if grep -nE '^ *#include "' "$folder"/*.[ch] | grep -vE "#include \"($allowed)"; then
        echo "lint: $module includes what it must not"
        bad=1
    fi
    exported=$(nm -g --defined-only "$build/lib$module.a" | awk 'NF == 3 { print $3 }' | grep -v "^$prefix")
    if [ -n "$exported" ]; then
        echo "lint: $module exports names without its prefix $prefix:" $exported
        bad=1
    fi
done
exit $bad
