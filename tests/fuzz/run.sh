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
surface)
    # The first byte chooses the format: gmsh, inp, Nastran, legacy VTK, VTU, STL.
    number=0
    for kind in msh inp bdf vtk vtu stl; do
        for file in ../../assets/mesh/*.$kind seeds/*/*.$kind; do
            [ -f "$file" ] || continue
            { printf "\\$(printf %03o "$number")"; cat "$file"; } >"$corpus/$kind.$(basename "$file")"
        done
        number=$((number + 1))
    done
    ;;
esac
[ -f "$target.dict" ] && dictionary=-dict=$target.dict
set -- "$corpus" -max_total_time="$seconds" -max_len="${MAX_LEN:-20000}" -timeout=30 -print_final_stats=1 $dictionary
# A backtrace takes memory that the target may refuse; printing it has hung, and a panic looked like a timeout.
export RUST_BACKTRACE=0
# Fuzzed is safe Rust: overflow checks and assertions find more than a sanitizer, and sooner.
if cargo +nightly fuzz --version >/dev/null 2>&1; then
    corpus=$1
    shift
    exec cargo +nightly fuzz run --fuzz-dir . --release --sanitizer none --debug-assertions "$target" "$corpus" -- "$@"
fi
# Without cargo-fuzz: the same flags.
host=$(rustc +nightly -vV | sed -n 's/^host: //p')
coverage='-Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 -Cllvm-args=-sanitizer-coverage-inline-8bit-counters
    -Cllvm-args=-sanitizer-coverage-pc-table -Cllvm-args=-sanitizer-coverage-trace-compares'
RUSTFLAGS="$(echo $coverage) --cfg fuzzing -Cdebug-assertions -Coverflow-checks" \
    cargo +nightly build --release --target "$host" --bin "$target"
exec "${CARGO_TARGET_DIR:-target}/$host/release/$target" "$@"
