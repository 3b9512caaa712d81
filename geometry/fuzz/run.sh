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
step) cp -n tests/data/step/*.step tests/data/round/*.step "$corpus" ;;
stl) cp -n fuzz/seeds/stl/* "$corpus" ;;
esac
[ -f "fuzz/$target.dict" ] && dictionary=-dict=fuzz/$target.dict
set -- "$corpus" -max_total_time="$seconds" -max_len=100000 -timeout=30 -print_final_stats=1 $dictionary
# A backtrace takes memory that the target may refuse; printing it has hung, and a panic looked like a timeout.
export RUST_BACKTRACE=0
# Fuzzed are the readers, which are safe Rust: overflow checks and assertions find more than a sanitizer, and sooner.
if cargo +nightly fuzz --version >/dev/null 2>&1; then
    corpus=$1
    shift
    exec cargo +nightly fuzz run --release --sanitizer none --debug-assertions "$target" "$corpus" -- "$@"
fi
# Without cargo-fuzz: the same flags.
host=$(rustc +nightly -vV | sed -n 's/^host: //p')
coverage='-Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 -Cllvm-args=-sanitizer-coverage-inline-8bit-counters
    -Cllvm-args=-sanitizer-coverage-pc-table -Cllvm-args=-sanitizer-coverage-trace-compares'
RUSTFLAGS="$(echo $coverage) --cfg fuzzing -Cdebug-assertions -Coverflow-checks" \
    cargo +nightly build --manifest-path fuzz/Cargo.toml --release --target "$host" --bin "$target"
exec "${CARGO_TARGET_DIR:-fuzz/target}/$host/release/$target" "$@"
