"""`python -m microfacet` and the script `microfacet`: the command line, or why it cannot run."""

from __future__ import annotations

import sys

import microfacet

__all__ = ["main"]

# What builds ask for, also where the base is installed alone.
_FOLDERS = {"--include-dir": microfacet.get_include, "--cmake-dir": microfacet.get_cmake_dir}


def main() -> None:
    """Run the command line; without the libraries of the extra ``cli`` say so and exit with status 2."""
    try:
        from microfacet.cli import main as command
    except ImportError as error:
        if len(sys.argv) == 2 and sys.argv[1] in _FOLDERS:
            print(_FOLDERS[sys.argv[1]]())
            return
        print(f"microfacet: {error}", file=sys.stderr)
        sys.exit(2)
    command(prog_name="microfacet")


if __name__ == "__main__":
    main()
