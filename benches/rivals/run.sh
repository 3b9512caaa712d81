#!/bin/sh
# Runs the cases of README.md with covact, CalculiX and GetFEM and writes results.csv and results.md.
#
#   benches/rivals/run.sh                      all cases, all programs
#   benches/rivals/run.sh hertz units          these cases
#   benches/rivals/run.sh --program calculix   one program (covact, calculix, getfem)
#   benches/rivals/run.sh hertz --setting mortar   settings whose name holds this
#   benches/rivals/run.sh --keep FOLDER        keep scenes, decks and what every program wrote
#
# RIVALS_LIMIT: processor seconds a run may take (180). COVACT: the program (target/release/covact).
# PYTHON: the interpreter that GetFEM is installed for (/usr/bin/python3).
set -eu
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
python=${PYTHON:-/usr/bin/python3}
COVACT=${COVACT:-$root/target/release/covact}
export COVACT
missing=0
if [ ! -x "$COVACT" ]; then
    echo "no program $COVACT: build it with 'cargo build --release', or name another in COVACT" >&2
    missing=1
fi
if ! command -v ccx >/dev/null 2>&1; then
    echo "CalculiX (ccx) is not installed; on Debian and Ubuntu: apt-get install calculix-ccx" >&2
    missing=1
fi
if ! "$python" -c 'import getfem, numpy' >/dev/null 2>&1; then
    echo "GetFEM for $python is not installed; on Debian and Ubuntu: apt-get install python3-getfem" >&2
    missing=1
fi
[ "$missing" = 0 ] || exit 2
PYTHONDONTWRITEBYTECODE=1 exec "$python" "$here/rivals.py" "$@"
