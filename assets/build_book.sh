#!/usr/bin/env bash
# Builds the book with mdBook into target/book/docs, with what its pages link to beside it, and checks its links.
set -euo pipefail
cd "$(dirname "$0")/.."
book=${1:-target/book}
rm -rf "$book"
mdbook build --dest-dir "$(mkdir -p "$book" && cd "$book" && pwd)/docs"
cp -r --parents assets/pictures examples/scenes examples/studies/found python/notebooks "$book"
python3 assets/check_book.py "$book/docs"
