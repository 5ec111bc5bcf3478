#!/bin/sh
# The page in one file: page.html with page.js, the engine, and the texts of the experiments.
# usage: join.sh ENGINE.wasm FOLDER TEXT...
set -eu
engine=$1 folder=$2
shift 2
while IFS= read -r line; do
    case $line in
    @script@) cat "$folder/page.js" ;;
    @texts@) for text; do printf '<script type="text/plain" id="%s">\n' "$(basename "$text")" && cat "$text" && echo '</script>'; done ;;
    *@engine@*) printf '%s' "${line%%@engine@*}" && gzip -9n <"$engine" | base64 -w0 && echo "${line#*@engine@}" ;;
    *) printf '%s\n' "$line" ;;
    esac
done <"$folder/page.html"
