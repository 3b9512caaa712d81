#!/usr/bin/env bash
# Archives of the program for releases, with checksums:
#   assets/build_release.sh FOLDER [TARGET ...]
# builds the program for every target that rustc knows by this name and can link (default: this machine), and leaves
# covact-VERSION-TARGET.tar.gz for each, and SHA256SUMS, in FOLDER. The same commit gives the same archives: files are sorted and
# have the time of the commit.
#   assets/build_release.sh --binary FILE FOLDER
# takes a program that is built already, for this machine.
set -euo pipefail
binary=
if [ "${1:-}" = --binary ]; then
  binary=$(realpath "$2")
  shift 2
fi
if [ $# -lt 1 ]; then
  sed -n '2,8s/^# //p' "$0" >&2
  exit 2
fi
mkdir -p "$1"
out=$(realpath "$1")
shift
cd "$(dirname "$0")/.."
version=$(sed -n '/^\[workspace.package\]/,/^$/s/^version = "\(.*\)"/\1/p' Cargo.toml)
host=$(rustc -vV | sed -n 's/^host: //p')
export SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct 2>/dev/null || echo 0)}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
if [ -n "$binary" ] || [ $# -eq 0 ]; then
  set -- "$host"
fi
made=()
for target in "$@"; do
  program=$binary
  if [ -z "$program" ]; then
    cargo build --release --locked --package covact --bin covact --target "$target"
    program=${CARGO_TARGET_DIR:-target}/$target/release/covact
    [ -f "$program" ] || program=$program.exe
  fi
  name=covact-$version-$target
  folder=$work/$name
  mkdir -p "$folder"
  cp "$program" README.md LICENSE-APACHE LICENSE-MIT docs/changelog.md "$folder"
  # What is there for people comes from the program itself, where it runs here.
  if [ "$target" = "$host" ]; then
    strip "$folder/$(basename "$program")" 2>/dev/null || true
    "$program" man -o "$folder/man1"
    mkdir "$folder/completions"
    for shell in bash zsh fish; do
      "$program" completions "$shell" > "$folder/completions/covact.$shell"
    done
  fi
  tar -C "$work" --sort=name --mtime="@$SOURCE_DATE_EPOCH" --owner=0 --group=0 --numeric-owner -cf - "$name" |
    gzip -9n > "$out/$name.tar.gz"
  made+=("$name.tar.gz")
done
(cd "$out" && sha256sum "${made[@]}" > SHA256SUMS)
echo "${made[*]} and SHA256SUMS in $out"
