#!/bin/sh
# Debian's sources of GSL and libconfig, and the headers that `make page` takes, into a folder. A list of its own asks for
# sources: the system's lists stay as they are.
# usage: sources.sh FOLDER
set -eu
mkdir -p "$1/apt/lists/partial" "$1/apt/cache/archives/partial"
cd "$1"
[ ! -d include ] || exit 0
# From where the system has its packages.
apt-get indextargets --format 'deb-src $(REPO_URI) $(CODENAME) $(COMPONENT)' 'Created-By: Packages' |
    grep " $(. /etc/os-release && echo "$VERSION_CODENAME") main$" | sort -u >apt/sources.list
apt() {
    apt-get -q -o Dir::Etc::SourceList="$PWD/apt/sources.list" -o Dir::Etc::SourceParts=/dev/null -o Dir::State::Lists="$PWD/apt/lists" \
        -o Dir::Cache="$PWD/apt/cache" -o APT::Sandbox::User="$(id -un)" "$@" >apt/log 2>&1 || { cat apt/log >&2; exit 1; }
}
apt update
for name in gsl libconfig; do
    apt source --download-only "$name"
    mkdir -p "$name" && tar -xf "$name"_*.orig.tar.* -C "$name" --strip-components=1
done
# The headers of the machine's C library are of no use here: those of plain C alone.
mkdir -p include.new/gsl
find gsl -name 'gsl_*.h' -exec cp {} include.new/gsl \;
cp libconfig/lib/libconfig.h include.new
ln -s /usr/include/xxhash.h /usr/include/Random123 include.new
sed 's/^#undef \(HAVE_DECL_[A-Z0-9_]*\|HAVE_IEEE_[A-Z]*\)$/#define \1 1/' gsl/config.h.in >include.new/config.h
mv include.new include
echo "sources of $(ls -d ./*.dsc | sed 's|^./||; s|.dsc$||' | tr '\n' ' ')in $1"
