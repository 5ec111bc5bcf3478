# From one row a pile (val_cost) to one row a setting: what a standard error of one degree costs, sd^2 times the time
# for a pile, and the bias against the finest setting on the same fills. The time is the least for a step over all
# piles of a box, times the steps of the mean pile.
BEGIN { FS = OFS = "\t" }
/^#/ { if (last != "") before = before last "\n"; last = $0; next }
!n { n = split(substr(last, 3), name, FS); for (i = 1; i <= n; i++) c[name[i]] = i }
$c["status"] == "ok" {
    key = $c["W"] FS $c["dt"] FS $c["rest_energy"]
    if (!(key in piles)) order[++keys] = key
    theta = $c["theta_r3_deg"]; step = $c["seconds"] / $c["steps"]; box = $c["W"]; width[key] = box
    at[key, $c["replica"]] = theta
    replica[$c["replica"]]
    sum[key] += theta; square[key] += theta * theta; steps[key] += $c["steps"]; piles[key]++
    if (!(box in least) || step < least[box]) least[box] = step
}
END {
    printf "%s", substr(before, 1, match(before, /# units:[^\n]*\n$/) - 1)
    print "# units: cm", "s", "m g d", "1", "degree", "degree", "degree", "degree", "s", "s", "1"
    print "# W", "dt", "rest_energy", "n", "theta", "theta_sd", "bias", "bias_se", "seconds", "seconds_per_degree", "front"
    reference = order[keys]
    for (k = 1; k <= keys; k++) {
        key = order[k]; m = piles[key]; mean[k] = sum[key] / m
        sd[k] = sqrt((square[key] - sum[key] ^ 2 / m) / (m - 1))
        pairs = d1 = d2 = 0
        for (r in replica) if ((key, r) in at && (reference, r) in at) {
            d = at[key, r] - at[reference, r]; pairs++; d1 += d; d2 += d * d
        }
        bias[k] = d1 / pairs
        bias_se[k] = sqrt((d2 - d1 ^ 2 / pairs) / (pairs - 1) / pairs)
        seconds[k] = least[width[key]] * steps[key] / m
        cost[k] = sd[k] ^ 2 * seconds[k]
    }
    for (k = 1; k <= keys; k++) {
        front = 1
        for (j = 1; j <= keys; j++) if (cost[j] < cost[k] && bias[j] ^ 2 < bias[k] ^ 2) front = 0
        printf "%s\t%d\t%.17g\t%.17g\t%.17g\t%.17g\t%.17g\t%.17g\t%d\n", order[k], piles[order[k]], mean[k], sd[k], \
            bias[k], bias_se[k], seconds[k], cost[k], front
    }
}
