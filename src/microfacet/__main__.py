"""`python -m microfacet` and the script `microfacet`: the command line, or why it cannot run."""

from __future__ import annotations

import sys

__all__ = ["main"]


def main() -> None:
    """Run the command line; without the libraries of the extra ``cli`` say so and exit with status 2."""
    try:
        from microfacet.cli import main as command
    except ImportError as error:
        print(f"microfacet: {error}", file=sys.stderr)
        sys.exit(2)
    command(prog_name="microfacet")


if __name__ == "__main__":
    main()
