#!/bin/sh
# Runs one fuzz target for a while; the targets themselves watch time and memory.
set -eu
cd "$(dirname "$0")"
target=$1
seconds=${2:-600}
corpus=corpus/$target
dictionary=
mkdir -p "$corpus"
case $target in
scene) cp ../../examples/scenes/*.json seeds/scene/* "$corpus" && rm -f "$corpus/schema.json" ;;
msh) cp ../../assets/mesh/*.msh seeds/msh/* "$corpus" ;;
inp) cp ../../assets/mesh/plate.inp seeds/inp/* "$corpus" ;;
esac
[ -f "$target.dict" ] && dictionary=-dict=$target.dict
# Fuzzed is safe Rust: overflow checks and assertions find more than a sanitizer, and sooner.
exec cargo +nightly fuzz run --fuzz-dir . --release --sanitizer none --debug-assertions "$target" "$corpus" -- \
    -max_total_time="$seconds" -max_len="${MAX_LEN:-20000}" -timeout=30 $dictionary
