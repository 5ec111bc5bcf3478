# One table of the rows of several, each of which has a header, with a line in it: "# slope:" of log N_error_rms against log eps
# by least squares, over the rows of states that are stable.
BEGIN { FS = "\t" }
/^# eps\t/ { n = split(substr($0, 3), name, FS); for (i = 1; i <= n; i++) c[name[i]] = i }
/^#/ { if (!rows) header = header $0 "\n"; next }
{ row[++rows] = $0 }
$c["negative_modes"] == 0 {
    x = log($c["eps"]); y = log($c["N_error_rms"])
    m++; sx += x; sy += y; sxx += x * x; sxy += x * y; syy += y * y
    if (m == 1 || $c["eps"] + 0 < lo) lo = $c["eps"] + 0
    if (m == 1 || $c["eps"] + 0 > hi) hi = $c["eps"] + 0
}
END {
    slope = (sxy - sx * sy / m) / (sxx - sx * sx / m)
    se = sqrt((syy - sy * sy / m - slope * (sxy - sx * sy / m)) / (m - 2) / (sxx - sx * sx / m))
    at = index(header, "# units:")
    printf "%s# slope: %.4f\n# slope_se: %.4f\n# slope_from: %g\n# slope_to: %g\n%s", \
        substr(header, 1, at - 1), slope, se, lo, hi, substr(header, at)
    for (i = 1; i <= rows; i++) print row[i]
}
