# From one row a pile to one row a setting, by the columns -v by=A,B,...: the largest mu at which it does not stand, the
# smallest at which it does, how many stand below the largest that does not, and how many wells broke at most in those
# that stand.
BEGIN { FS = OFS = "\t"; n_by = split(by, key_name, ",") }
/^#/ { if (last != "" && last !~ /^# units/) print last; last = $0; next }
!n { n = split(substr(last, 3), name, FS); for (i = 1; i <= n; i++) c[name[i]] = i }
{
    key = ""
    for (i = 1; i <= n_by; i++) key = key (i > 1 ? FS : "") $c[key_name[i]]
    if (!(key in piles)) order[++keys] = key
    mu = $c["mu"] + 0; i = ++piles[key]; at[key, i] = mu; stands[key, i] = $c["status"] == "ok"
    if (!stands[key, i]) { if (!(key in falls) || mu > falls[key]) falls[key] = mu; next }
    if (!(key in least) || mu < least[key]) least[key] = mu
    if ($c["broken"] + 0 > broken[key] + 0) broken[key] = $c["broken"]
}
END {
    printf "# units: "
    for (i = 1; i <= n_by + 5; i++) printf "1%s", i < n_by + 5 ? OFS : "\n"
    gsub(",", OFS, by)
    print "# " by, "n", "falls_mu", "stands_mu", "mixed", "broken"
    for (k = 1; k <= keys; k++) {
        key = order[k]; mixed = 0
        for (i = 1; i <= piles[key]; i++) mixed += stands[key, i] && key in falls && at[key, i] < falls[key]
        print key, piles[key], key in falls ? falls[key] : "nan", key in least ? least[key] : "nan", mixed, broken[key] + 0
    }
}
