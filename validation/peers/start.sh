# Initial states of the benches, kept in the working folder of the calling script. Needs $repose.

# Columns of a table of repose, by name.
columns() {
    awk -F'\t' -v names="$*" '/^#/ { head = substr($0, 3); next }
        !n { n = split(head, h, "\t"); for (i = 1; i <= n; i++) at[h[i]] = i; k = split(names, want, " ") }
        { for (i = 1; i <= k; i++) printf "%s%s", $at[want[i]], i < k ? " " : "\n" }'
}

# Provenance of the program, as header lines.
provenance() {
    "$repose" bench --n 1 --steps 1 --repeat 1 | grep -E '^# (program|compiler|libraries|pair_loop):'
    echo "# processor: $(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -1)"
}

# The scene of `repose bench`, without its grains.
box() { # N steps
    awk -v n="$1" -v steps="$2" 'BEGIN {
        printf "steps = %d; dt = %s; tangential = { law = \"spring\"; mu = 0.2; };\n", steps, (n > 20000 ? "4e-5" : "5e-5") # a high fall
        print "walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; },"
        print "          { point = [0.0, 0.0]; direction = [1.0, 0.0]; },"
        printf "          { point = [%.17f, 0.0]; direction = [-1.0, 0.0]; } );\n", 0.2 * sqrt(n) }'
}

# NAME_N.tsv: N grains, a number of steps after their fall began.
filled() { # NAME N steps
    [ ! -f "$1_$2.tsv" ] || return 0
    {
        box "$2" "$3"
        awk -v n="$2" 'BEGIN { W = 0.2 * sqrt(n); printf "fill = { N = %d; W = %.17f; H = %.17f; };\n", n, W, 2 * W }'
    } >"$1_$2.cfg"
    "$repose" run "$1_$2.cfg" >"$1_$2.new"
    mv "$1_$2.new" "$1_$2.tsv"
}
dilute() { filled dilute "$1" 0; }
settle() { filled settled "$1" "$(awk -v n="$1" 'BEGIN { printf "%.0f", (30000 * sqrt(0.05 * sqrt(n)) + 10000) * (n > 20000 ? 1.25 : 1) }')"; }
