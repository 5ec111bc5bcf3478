# Frames of a run for the page: states.tsv, then contacts.tsv, of steps from `from` on. Lengths in thousandths of a cm,
# forces in dyn, one list of numbers per frame: x, y of each grain of the first frame, and a, b, normal force of each
# contact (b is -1 for a wall).
function whole(x) { return sprintf("%.0f", x) }
BEGIN { FS = "\t"; frames = 0 }
FNR == 1 { part++; named = 0 }
/^#/ { next }
!named {
    named = 1
    split("", c)
    for (i = 1; i <= NF; i++) c[$i] = i
    next
}
part == 1 && $c["step"] >= from {
    if (!($c["step"] in frame)) { frame[$c["step"]] = ++frames; steps[frames] = $c["step"] }
    f = frame[$c["step"]]
    id = $c["id"]
    if (f == 1) { grain[id] = n_grains++; ids[grain[id]] = id; radius[grain[id]] = whole(1000*$c["r"]) }
    x[f, grain[id]] = whole(1000*$c["x"]); y[f, grain[id]] = whole(1000*$c["y"])
}
part == 2 && ($c["step"] in frame) && $c["normal_force"] >= 1 {
    f = frame[$c["step"]]
    b = $c["wall"] > 0 ? -1 : grain[$c["id_b"]]
    links[f] = links[f] (links[f] == "" ? "" : ",") grain[$c["id_a"]] "," b "," whole($c["normal_force"])
}
END {
    printf "{\"dt\":%s,\"opens\":%s,\"id\":[", dt, opens
    for (g = 0; g < n_grains; g++) printf "%s%s", (g ? "," : ""), ids[g]
    printf "],\"r\":["
    for (g = 0; g < n_grains; g++) printf "%s%s", (g ? "," : ""), radius[g]
    printf "],\"frames\":["
    for (f = 1; f <= frames; f++) {
        printf "%s\n{\"step\":%s,\"xy\":[", (f > 1 ? "," : ""), steps[f]
        for (g = 0; g < n_grains; g++)
            printf "%s%s", (g ? "," : ""), (((f, g) in x) ? x[f, g] "," y[f, g] : "null,null")
        printf "],\"links\":[%s]}", links[f]
    }
    print "]}"
}
