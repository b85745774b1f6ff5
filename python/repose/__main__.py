"""The command `repose`, as installed with the package."""

import sys

from . import _core


def main() -> int:
    return _core.command(["repose", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
