# Initial states of the benches, kept in the working folder of the calling script. Needs $repose.

# Columns of a table of repose, by name.
columns() { "$repose" stats select - --columns "$(IFS=,; echo "$*")" --bare | tr '\t' ' '; }

# Width of the box of N grains. Median of the numbers of standard input, the lower of two in the middle.
width() { awk -v n="$1" 'BEGIN { printf "%.17f", 0.2 * sqrt(n) }'; }
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
steps = $2; dt = $dt; tangential = { law = "spring"; mu = 0.2; };
walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; },
          { point = [0.0, 0.0]; direction = [1.0, 0.0]; },
          { point = [$(width "$1"), 0.0]; direction = [-1.0, 0.0]; } );
S
}

# NAME_N.tsv: N grains, a number of steps after their fall began.
filled() { # NAME N steps
    [ ! -f "$1_$2.tsv" ] || return 0
    {
        box "$2" "$3"
        echo "fill = { N = $2; W = $(width "$2"); H = $(width $((4 * $2))); };"
    } >"$1_$2.cfg"
    "$repose" run "$1_$2.cfg" >"$1_$2.new"
    mv "$1_$2.new" "$1_$2.tsv"
}
dilute() { filled dilute "$1" 0; }
settle() { filled settled "$1" "$(awk -v n="$1" 'BEGIN { printf "%.0f", (30000 * sqrt(0.05 * sqrt(n)) + 10000) * (n > 20000 ? 1.25 : 1) }')"; }
