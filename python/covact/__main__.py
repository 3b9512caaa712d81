"""The command line: ``covact run scene.json`` and all the rest."""

import shutil
import signal
import sys
import sysconfig
from pathlib import Path

from . import _covact


def program():
    """Path of the program `covact` that came with this package, or None."""
    name = "covact.exe" if sys.platform == "win32" else "covact"
    own = Path(sysconfig.get_path("scripts")) / name
    if own.is_file():
        return str(own)
    return shutil.which("covact")


def main():
    """Runs the command line with the arguments of the process."""
    # Ctrl-C is the program's: it keeps what is done.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    sys.stdout.flush()
    return _covact.main(["covact", *sys.argv[1:]], program())


if __name__ == "__main__":
    sys.exit(main())
