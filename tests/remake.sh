#!/bin/sh
# What `make` makes anew: in a copy of the tree, where scripts stand for the programs.
#
#   sh tests/remake.sh SOURCE BUILD    in an empty folder; BUILD has the objects. Prints what is wrong, with status 1.
set -eu
unset MAKEFLAGS MAKELEVEL MAKEOVERRIDES GIT_DIR
source=$(cd "$1" && pwd) build=${2#"$1"/}
wrong() { echo "remake: $*" >&2; exit 1; }
make() { command make --no-print-directory "$@"; }
git() { command git -c user.name=x -c user.email=x@x "$@"; }
mkdir -p build figures/shown results/kept
ln -s "$source"/analytic "$source"/report "$source"/src "$source"/sweeps "$source"/tests "$source"/validation .
ln -s "$source"/figures/l? "$source"/figures/studies "$source"/figures/val "$source"/figures/*.gp figures
cp -r "$source/Makefile" "$source/install.mk" "$source/README.md" "$source/paper-repro.md" "$source/docs" .

# Tables of a sweep and of a suite are stale by every file of the code, and by what these include; not by the commit.
make -n -o build/repose build/made/lh3 | sed -n 's/^echo "compile \(.*\)"$/\1/p' | sort >code
find analytic/ src/ sweeps/ -name '*.c' ! -name version.c | sort | diff - code >&2 || wrong "not all of the code"
(cd "$source/$build/obj" && find . -name '*.d' | tar -cT -) | (mkdir build/obj && tar -xC build/obj)
find build/obj -name '*.d' -exec sed -i "s#^$build/#build/#" {} +
mkdir build/made build/studied build/validated
make -t build/check build/made/lh3 build/studied/lh_rough build/validated/impact >touched
made() { make -n "$@" build/made/lh3 build/studied/lh_rough build/validated/impact | grep -c 'echo "\(sweep\|check\) ' || true; }
[ "$(made)" = 0 ] || wrong "stale without a change"
[ "$(made -W build/commit)" = 0 ] || wrong "stale by the commit"
for file in src/dem/run.c src/dem/law/law.inl src/core/status.h; do
    [ "$(made -W $file)" = 3 ] || wrong "not stale by $file"
done
[ "$(made -W sweeps/lh/lh3.cfg)$(made -W sweeps/studies/lh_rough.cfg)$(made -W validation/impact.c)" = 111 ] || wrong "not stale by its file"
rm -r build/* code

# A study's tables go into results, each with its checksum, and from there to the figures; so do those that change.
cat >repose <<'E2'
#!/bin/sh
if [ "$1" = page ]; then shift $(($# - 1)); cat verdict >"$1"; exit; fi
mkdir -p build/studies
for t in lh_rough lh_rough_trend lh_rough_runs lh_rough_row3; do cp number build/studies/$t.tsv; done
E2
chmod +x repose && cp repose report.sh
try() { make -s CODE= REPOSE=./repose REPORT=./report.sh SHOWN=lh3 make_html=true "$@"; }
echo 1 >number
echo 7 >results/kept/li_eps_slope.tsv
for number in 1 2; do
    echo $number >number
    touch number -d "$number seconds"
    try -W sweeps/studies/lh_rough.cfg build/studied/lh_rough >made
    for table in lh_rough lh_rough_trend; do
        try build/tables/$table.tsv
        cmp number build/tables/$table.tsv || wrong "table of a study: $table"
    done
    [ ! -e results/lh_rough_runs.tsv ] && [ ! -e results/lh_rough_row3.tsv ] || wrong "runs in results"
    (cd results && sha256sum -c --quiet checksums.txt) || wrong "checksums"
    echo 3 >results/lh_rough.tsv
    touch -d 2000-01-01 results/lh_rough.tsv
    try build/tables/lh_rough.tsv
    [ "$(cat build/tables/lh_rough.tsv)" = 3 ] || wrong "an older table of results"
done

# `make report` copies pages and the numbers that they need, and fails until they are committed.
command -v git >where || exit 0
table() { printf '# run_time: %s s\n# modes: %s\nx\tseconds\n%s\t%s\n' "$@" "$1"; }
report() { try -o figures -o validate -o build/figures/shown/lh3.png report >said 2>&1; }
table 1 2 3 >results/kept/li_eps_slope.tsv
mkdir -p build/figures/shown && touch build/figures/shown/lh3.png
git init -q . && git add Makefile docs paper-repro.md results && git commit -qm 0
table 9 2 3 >build/tables/li_eps_slope.tsv
echo reproduced >verdict
! report || wrong "pages that are new"
[ "$(cat docs/claims.md paper-repro.md)" = "reproduced
reproduced" ] || wrong "pages are not copied"
git commit -qam 1
report || wrong "pages that are the same: $(cat said)"
head -1 results/kept/li_eps_slope.tsv | grep -q '1 s' || wrong "a table that differs by its time alone"
echo undecided >verdict
! report || wrong "another verdict"
grep -q 'docs/claims.md' said && grep -q '^report: .*commit them' said || wrong "another verdict: $(cat said)"
git commit -qam 2 && report || wrong "pages that are committed"
for numbers in '9 2 4' '9 3 4'; do
    table $numbers >build/tables/li_eps_slope.tsv
    ! report || wrong "another number"
    cmp build/tables/li_eps_slope.tsv results/kept/li_eps_slope.tsv || wrong "a number that is not kept"
    git commit -qam 3 && report || wrong "a number that is committed"
done

# A program is named by the last commit, with -dirty after any change but of tables of results.
commit() { make -s build/commit && cat build/commit; }
[ "$(git rev-parse "$(commit)")" = "$(git rev-parse HEAD)" ] || wrong "the commit is $(commit)"
echo 4 >results/lh_rough.tsv
case $(commit) in *-dirty) wrong "dirty by a table of results" ;; esac
echo >>Makefile
case $(commit) in *-dirty) ;; *) wrong "not dirty after a change" ;; esac
