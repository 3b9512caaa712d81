#!/bin/sh
# Runs one fuzz target for a while; the targets themselves watch time and memory.
set -eu
cd "$(dirname "$0")/.."
target=$1
seconds=${2:-600}
corpus=fuzz/corpus/$target
dictionary=
mkdir -p "$corpus"
case $target in
json) cp -n fuzz/seeds/json/* tests/data/json/* ../assets/cad/*.json "$corpus" ;;
iges | iges_entities) cp -n fuzz/seeds/iges/* ../assets/cad/*.igs ../assets/sphere.igs "$corpus" ;;
step) cp -n tests/data/step/*.step "$corpus" ;;
stl) cp -n fuzz/seeds/stl/* "$corpus" ;;
esac
[ -f "fuzz/$target.dict" ] && dictionary=-dict=fuzz/$target.dict
# Fuzzed are the readers, which are safe Rust: overflow checks and assertions find more than a sanitizer, and sooner.
exec cargo +nightly fuzz run --release --sanitizer none --debug-assertions "$target" "$corpus" -- \
    -max_total_time="$seconds" -max_len=100000 -timeout=30 $dictionary
