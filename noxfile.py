"""`nox -s NAME` runs `make NAME`: the Makefile is the one place where a command is written."""

import nox

nox.options.default_venv_backend = "none"  # make keeps the virtual environment
nox.options.sessions = ["lint", "test"]


def delegate(target: str) -> None:
    @nox.session(name=target)
    def run(session: nox.Session) -> None:
        session.run("make", target, *session.posargs, external=True)


DOCUMENTS = ("docs-accuracy", "docs-sampling", "docs-furnace", "docs-traced", "docs-mitsuba", "fit-coverage")
for target in (
    "report",
    "lint",
    "format",
    "headers",
    "sanitize",
    "test",
    *DOCUMENTS,
    "bench-fit",
    "bench-materials",
    "bench-mitsuba",
):
    delegate(target)
