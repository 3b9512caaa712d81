#!/bin/sh
# Runs one fuzz target for a while. Inputs stay below 100 kB, so that one second and 256 MB bound what a reader may take.
set -eu
cd "$(dirname "$0")/.."
target=$1
seconds=${2:-600}
corpus=fuzz/corpus/$target
mkdir -p "$corpus"
case $target in
json) cp -n fuzz/seeds/json/* tests/data/json/* ../assets/cad/*.json "$corpus" ;;
iges) cp -n fuzz/seeds/iges/* ../assets/cad/*_faces.igs ../assets/sphere.igs "$corpus" ;;
esac
exec cargo +nightly fuzz run "$target" "$corpus" -- \
    -max_total_time="$seconds" -max_len=100000 -timeout=1 -rss_limit_mb=512 -malloc_limit_mb=256
