# Mutants of C files, one a line, tab-separated. One sign, factor, index or comparison is changed at a time. A
# comparison is turned round; with a whole number its limit is let in or out too, which among measured numbers
# changes nothing. Comments, strings, messages of errors, the preprocessor, enumerations, named settings (static
# const NAME) and sizes of memory are left alone; binary operators are known by the blanks that the format puts
# around them. The lines come in the order in which to take them: by turns from each operator in each file, within
# these at random, by their text alone.
BEGIN {
    FS = "\n"
    for (i = 1; i < 128; i++) code_of[sprintf("%c", i)] = i
    n_pairs = split("+ - * / < >= > <= == != && || += -= *= /=", pair, " ")
    for (i = 1; i <= n_pairs; i++) other[pair[i]] = pair[i % 2 ? i + 1 : i - 1]
    split("+ - += -=", pair, " ")
    for (i in pair) kind_of[pair[i]] = "sign"
    split("* / *= /=", pair, " ")
    for (i in pair) kind_of[pair[i]] = "factor"
}

# The line with what is not to change blanked, all else in its place.
function bare(text,   out, i, c) {
    out = ""
    for (i = 1; i <= length(text); i++) {
        c = substr(text, i, 1)
        if (comment) {
            if (substr(text, i, 2) == "*/") { comment = 0; out = out " "; i++ }
            c = " "
        } else if (quote) {
            if (c == "\\") { out = out " "; i++ } else if (c == quote) quote = ""
            c = " "
        } else if (substr(text, i, 2) == "/*") { comment = 1; out = out " "; i++; c = " " }
        else if (c == "\"" || c == "'") { quote = c; c = " " }
        else if (substr(text, i, 8) == "rp_fail(") message = 1
        if (message && c == ";") message = 0
        out = out (message ? " " : c)
    }
    return out
}

# Park-Miller numbers, so that every awk agrees.
function number_of(text,   h, i) {
    h = 1
    for (i = 1; i <= length(text); i++) h = (h * 31 + code_of[substr(text, i, 1)]) % 2147483647
    for (i = 0; i < 4; i++) h = (h * 48271) % 2147483647
    return h
}

function offer(kind, at, len, new,   mutant, key) {
    mutant = substr($0, 1, at - 1) new substr($0, at + len)
    key = FILENAME $0 at new
    printf "%s\t%s\t%010d\t%d\t%s\t%s\n", FILENAME, kind, number_of(key (++seen[key])), FNR, $0, mutant
}

# Offer what is made of every place where the code matches.
function each(regex, form,   at, len, rest) {
    rest = 1
    while (match(substr(code, rest), regex)) {
        at = rest + RSTART - 1
        len = RLENGTH
        found(form, at, len, substr(code, at, len))
        rest = at + len - 1 # the blank after it may be the next one's
    }
}

function found(form, at, len, text,   word, value) {
    if (form == "operator") {
        word = substr(text, 2, len - 2)
        if (loop && word ~ /^[<>]/) return # past the end is what the sanitizers are for
        offer(word in kind_of ? kind_of[word] : "comparison", at + 1, len - 2, other[word])
    } else if (form == "loop end")
        offer("index", at + len - 3, 3, " + 1 < ")
    else if (form == "loop start")
        offer("index", at + len - 2, 1, 1)
    else if (form == "limit") {
        word = substr(text, 2, 2)
        offer("comparison", at + 1, 2, word ~ /=/ ? substr(word, 1, 1) " " : substr(word, 1, 1) "= ")
    } else if (form == "count") {
        word = substr(text, 2, 2)
        offer("sign", at + 1, 2, word == "++" ? "--" : "++")
    } else if (form == "minus")
        offer("sign", at + len - 2, 1, "")
    else if (form == "number") {
        match(text, /[0-9.]+/)
        word = substr(text, RSTART, RLENGTH)
        if (loop && substr(code, 1, at) ~ /< $/) return
        value = word + 0 == int(word) ? word + 1 : 1.2 * word
        offer("factor", at + RSTART - 1, RLENGTH, sprintf(word ~ /[.]/ && value == int(value) ? "%.1f" : "%.15g", value))
    } else { # an index
        word = substr(text, 2, len - 2)
        offer("index", at + 1, len - 2, word ~ /^[0-9]+$/ ? (word > 0 ? word - 1 : 1) : word " + 1")
    }
}

FNR == 1 { comment = message = skipping = 0; quote = "" }
{
    code = bare($0) " "
    directive = continued || code ~ /^ *#/
    continued = directive && code ~ /\\ $/
    if (code ~ /^(typedef )?(enum|struct)( [a-z_]+)? \{/ || code ~ /^static const double [A-Z_]+ =/) skipping = 1
    if (skipping || directive || code ~ /alloc\(/ || code ~ /if \((![a-z_>-]+ \|\| )+![a-z_>-]+\)/) {
        if (code ~ /;/ && code !~ /^    /) skipping = 0
        next
    }
    loop = code ~ /for \(/
    each(" ([-+*/<>]|<=|>=|==|!=|&&|[|][|]|[-+*/]=) ", "operator")
    if (loop) {
        each("[a-z_]+ < ", "loop end")
        each("for \\([a-z_]+ [a-z_]+ = 0;", "loop start")
    } else {
        each(" [<>]=? [1-9][0-9]*[ ;,)]", "limit")
        each("[a-z_)](\\+\\+|--)[^+-]", "count")
    }
    each("([ (,{]|return )-[a-zA-Z_(]", "minus")
    each("[ (][0-9]+[.][0-9]+[ ;,)]", "number")
    each("[ (][0-9]+ [*/] ", "number")
    each("[*/] [0-9]+[ ;,)]", "number")
    if (code !~ /^([a-z]| *(static |const )*(double|size_t|long|int|uint32_t|bool|dem_vec|char|an_point) [a-z_, ]+\[)/)
        each("[[][a-z0-9_]+[]]", "index")
}
