# Initial states of the benches, kept in the working folder of the calling script. Needs $repose.
processors=$(getconf _NPROCESSORS_ONLN)

# Columns of a table of repose, by name.
columns() { "$repose" stats select - --columns "$(IFS=,; echo "$*")" --bare | tr '\t' ' '; }

# Width of the box of N grains. A square box of a million would take hours to settle: ten boxes of 100 000 side by side.
width() { # N
    awk -v n="$1" 'BEGIN { printf "%#.17g", 0.2 * sqrt(n == 1000000 ? 10 * n : n) }'
}

# Median of the numbers of standard input, the lower of two in the middle.
median() { sort -g | awk '{ v[NR] = $1 } END { print v[int((NR + 1) / 2)] }'; }

# Provenance of the program, as header lines.
provenance() {
    "$repose" bench --n 1 --steps 1 --repeat 1 | grep -E '^# (program|compiler|libraries|pair_loop):'
    echo "# processor: $(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -1)"
}

# The scene of `repose bench`, without its grains.
box() { # N steps
    local dt=5e-5
    if [ "$1" -gt 20000 ]; then dt=4e-5; fi # a high fall
    cat <<S
steps = $2; dt = $dt; tangential = { law = "spring"; mu = 0.2; damping = "outside"; };
walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; },
          { point = [0.0, 0.0]; direction = [1.0, 0.0]; },
          { point = [$(width "$1"), 0.0]; direction = [-1.0, 0.0]; } );
S
}

# Options of `repose bench` for a scene: the box of grains that do not rotate, also by all processors; grains that
# rotate; with rolling resistance; with radii of 1:10.
options() { # scene
    case $1 in
        box) ;;
        threads) echo "-j $processors" ;;
        rotation) echo --rotation ;;
        rolling) echo --rotation --mu-roll 0.05 ;;
        sizes) echo --size-ratio 10 ;;
    esac
}

# settled_SCENE_N.tsv: N grains at rest; by all processors, with the same bits.
settle() { # scene N
    local scene=${1/threads/box}
    start=settled_${scene}_$2.tsv
    if [ -f "$start" ]; then return; fi
    if [ "$2" = 1000000 ]; then joined "$scene" >"$start.new"; else
        "$repose" bench --n "$2" $(options "$scene") -j "$processors" --steps 1 --repeat 1 -o "$start.new" >/dev/null
    fi
    mv "$start.new" "$start"
}

# A million grains. Every other box of 100 000 is a mirror image: the grains that touched a wall touch their own images.
joined() { # scene
    local start i
    settle "$1" 100000
    printf 'x\ty\tr\n'
    for i in $(seq 0 9); do
        columns x y r <"$start" |
            awk -v i="$i" -v W="$(width 100000)" '{ printf "%.17g\t%s\t%s\n", (i % 2 ? W * (i + 1) - $1 : W * i + $1), $2, $3 }'
    done
}

# dilute_N.tsv: N grains of the box before they fall.
dilute() { # N
    start=dilute_$1.tsv
    [ ! -f "$start" ] || return 0
    { box "$1" 0; echo "fill = { N = $1; W = $(width "$1"); H = $(width $((4 * $1))); };"; } >dilute.cfg
    "$repose" run dilute.cfg >"$start.new"
    mv "$start.new" "$start"
}
