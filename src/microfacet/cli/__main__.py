"""`python -m microfacet.cli` is `microfacet`."""

from microfacet.cli import main

if __name__ == "__main__":
    main()
