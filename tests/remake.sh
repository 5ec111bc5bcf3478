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
mkdir -p build figures/shown results/kept/li_eps
ln -s "$source"/analytic "$source"/src "$source"/examples "$source"/sweeps "$source"/tests "$source"/validation .
ln -s "$source"/figures/l? "$source"/figures/studies "$source"/figures/val "$source"/figures/*.gp figures
cp -r "$source/Makefile" "$source/install.mk" "$source/README.md" "$source/paper-repro.md" "$source/docs" "$source/report" .

# Tables of a sweep and of a suite are stale by every file of the code, and by what these include; not by the commit.
# A figure is stale by its file, those that it loads, its sweeps, and their tables in results.
made="build/tables/lh3/done build/studied/lh_rough build/tables/impact/done"
make -n -o build/repose build/tables/lh3/done | sed -n 's/.*echo "compile \(.*\)"$/\1/p' | sort >code
find analytic/ src/ sweeps/ -name '*.c' ! -name version.c ! -path 'src/page/*' ! -path 'src/dem/alone/*' | sort | diff - code >&2 || wrong "not all of the code"
(cd "$source/$build/obj" && find . -name '*.d' | tar -cT -) | (mkdir build/obj && tar -xC build/obj)
find build/obj -name '*.d' -exec sed -i "s#^$build/#build/#" {} +
mkdir -p build/tables/lh3 build/tables/impact build/tables/continuum build/tables/pile build/studied build/figures results/lh_mu
echo 1 | tee results/lh_mu/points.tsv >results/lh_mu/trend.tsv
make -s build/tables/lh_mu/done
make -t build/check $made build/figures/li14.svg build/figures/lh_mu.svg >touched
made() { make -n "$@" $made | grep -c 'echo "\(sweep\|check\)   [^ ]*\( --study\| impact\)\{0,1\}"' || true; }
[ "$(made)" = 0 ] || wrong "stale without a change"
[ "$(made -W build/commit)" = 0 ] || wrong "stale by the commit"
for file in src/dem/run.c src/dem/law/law.inl src/core/status.h; do
    [ "$(made -W $file)" = 3 ] || wrong "not stale by $file"
done
[ "$(made -W sweeps/lh/lh3.cfg)$(made -W sweeps/studies/lh_rough.cfg)$(made -W validation/impact.c)" = 111 ] || wrong "not stale by its file"
drawn() { make -n "$@" | grep -c 'echo "figure' || true; }
[ "$(drawn build/figures/li14.svg build/figures/lh_mu.svg)" = 0 ] || wrong "a figure is stale without a change"
for file in figures/li/li14.gp figures/li/li13.gp figures/style.gp build/tables/pile/done; do
    [ "$(drawn -W $file build/figures/li14.svg)" = 1 ] || wrong "a figure is not stale by $file"
done
[ "$(drawn -W results/lh_mu/trend.tsv build/figures/lh_mu.svg)" = 1 ] || wrong "a figure is not stale by results"
rm -r build/* results/lh_mu code

# A study's tables go into results, each with its checksum, and from there to the figures; so do those that change.
cat >repose <<'E2'
#!/bin/sh
if [ "$1" = page ]; then shift $(($# - 1)); cat verdict >"$1"; exit; fi
mkdir -p build/studies/lh_rough
for t in points trend runs row_3; do cp number build/studies/lh_rough/$t.tsv; done
E2
chmod +x repose && cp repose report.sh
try() { make -s CODE= REPOSE=./repose REPORT=./report.sh SHOWN=lh3 make_html=true "$@"; }
echo 7 >results/kept/li_eps/slope.tsv
for number in 1 2; do
    echo $number >number
    touch number -d "$number seconds"
    try -W sweeps/studies/lh_rough.cfg build/studied/lh_rough >made
    try build/tables/lh_rough/done
    for table in points trend; do
        cmp number build/tables/lh_rough/$table.tsv || wrong "table of a study: $table"
    done
    [ ! -e results/lh_rough/runs.tsv ] && [ ! -e results/lh_rough/row_3.tsv ] || wrong "runs in results"
    (cd results && sha256sum -c --quiet checksums.txt) || wrong "checksums"
    echo 3 >results/lh_rough/trend.tsv
    touch -d 2000-01-01 results/lh_rough/trend.tsv
    try build/tables/lh_rough/done
    [ "$(cat build/tables/lh_rough/trend.tsv)" = 3 ] || wrong "an older table of results"
done

# `make report` copies pages and the numbers that they need, and fails until they are committed.
command -v git >where || exit 0
table() { printf '# run_time: %s s\n# modes: %s\nx\tseconds\n%s\t%s\n' "$@" "$1"; }
report() { try -o figures -o validate -o build/figures/shown/lh3.png report >said 2>&1; }
mkdir -p build/figures/shown build/tables/li_eps && touch build/figures/shown/lh3.png
table 1 2 3 >results/kept/li_eps/slope.tsv
git init -q . && git add Makefile docs paper-repro.md results && git commit -qm 0
table 9 2 3 >build/tables/li_eps/slope.tsv
echo reproduced >verdict
! report || wrong "pages that are new"
[ "$(cat docs/claims.md paper-repro.md)" = "reproduced
reproduced" ] || wrong "pages are not copied"
git commit -qam 1
report || wrong "pages that are the same: $(cat said)"
head -1 results/kept/li_eps/slope.tsv | grep -q '1 s' || wrong "a table that differs by its time alone"
echo undecided >verdict
! report || wrong "another verdict"
grep -q 'docs/claims.md' said && grep -q '^report: .*commit them' said || wrong "another verdict: $(cat said)"
git commit -qam 2 && report || wrong "pages that are committed"
for numbers in '9 2 4' '9 3 4'; do
    table $numbers >build/tables/li_eps/slope.tsv
    ! report || wrong "another number"
    cmp build/tables/li_eps/slope.tsv results/kept/li_eps/slope.tsv || wrong "a number that is not kept"
    git commit -qam 3 && report || wrong "a number that is committed"
done

# A program is named by the last commit, with -dirty after any change but of tables of results.
commit() { make -s build/commit && cat build/commit; }
[ "$(git rev-parse "$(commit)")" = "$(git rev-parse HEAD)" ] || wrong "the commit is $(commit)"
echo 4 >results/lh_rough/trend.tsv
case $(commit) in *-dirty) wrong "dirty by a table of results" ;; esac
echo >>Makefile
case $(commit) in *-dirty) ;; *) wrong "not dirty after a change" ;; esac
