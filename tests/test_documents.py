"""What the documents say is so: their code runs, their links and citations exist, tables are up to date."""

from __future__ import annotations

import doctest
import os
import pathlib
import re
import runpy
import shutil
import subprocess
import sys
import tomllib
from typing import Any

import pytest

import microfacet as mf
import mitsuba_process
import torch_process

ROOT = pathlib.Path(__file__).parent.parent
COMPILER = os.environ.get("CXX") or shutil.which("g++") or shutil.which("clang++")

each_family = pytest.mark.parametrize("family", mf.families(), ids=lambda family: family.name)


def relative(path: pathlib.Path) -> str:
    return path.relative_to(ROOT).as_posix()


BIBLIOGRAPHY = set(re.findall(r"@\w+\{([^,]+),", (ROOT / "references.bib").read_text(encoding="utf-8")))


@each_family
def test_sources_are_in_the_bibliography(family: Any) -> None:
    assert family.sources
    assert set(family.sources) <= BIBLIOGRAPHY


def test_citations_are_in_the_bibliography() -> None:
    """Anything that looks like one of our keys (surname, year, word) is one of our keys."""
    cited = {
        key
        for folder, suffixes in (("include", "hpp"), ("src", "py"), ("docs", "md"))
        for path in (ROOT / folder).rglob(f"*.{suffixes}")
        for key in re.findall(r"\b[a-z]{3,}(?:19|20)\d\d[a-z]{3,}\b", path.read_text(encoding="utf-8"))
    }
    assert cited <= BIBLIOGRAPHY, sorted(cited - BIBLIOGRAPHY)


def test_families_pages_have_the_formulas_of_the_report() -> None:
    for path, text in runpy.run_path(str(ROOT / "tools" / "write_formulas.py"))["pages"]().items():
        assert text.count("$$") > 10
        assert path.read_text(encoding="utf-8") == text, f"{relative(path)}: run `make docs-formulas`"


def test_accuracy_is_documented_for_every_function() -> None:
    text = (ROOT / "docs" / "accuracy.md").read_text(encoding="utf-8")
    for family in mf.families():
        assert re.search(rf"\b{family.name}\b", text), family.name
    for name in ("D", "P22", "P2", "slope_cdf", "sigma", "Lambda", "G1", "survival", "sample_slope"):
        assert re.search(rf"\b{name}\b", text), name


GUIDES = (
    "radial",
    "sampling",
    "slope_tables",
    "materials",
    "compensation",
    "textures",
    "surfaces",
    "profiles",
    "fitting",
    "brdf_tables",
    "arrays",
    "export",
)
DOCUMENTS = ("README.md", *(f"docs/{name}.md" for name in GUIDES))


@pytest.mark.parametrize("document", DOCUMENTS)
def test_the_code_of_a_document_runs(
    document: str, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(
        r"```python\n(.*?)```", (ROOT / document).read_text(encoding="utf-8"), flags=re.DOTALL
    )
    assert blocks
    # A variant of Mitsuba belongs to a whole process.
    if rendering := [block for block in blocks if "mitsuba" in block]:
        mitsuba_process.run("\n".join(rendering), "llvm_ad_rgb")
    # PyTorch may be that of another Python.
    if tensors := [block for block in blocks if "torch" in block]:
        torch_process.run("\n".join(tensors))
    names: dict[str, Any] = {}
    for block in blocks:
        if block in rendering or block in tensors:
            continue
        if ">>>" in block:
            test = doctest.DocTestParser().get_doctest(block, names, document, document, 0)
            outcome = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE).run(
                test, clear_globs=False
            )
            assert outcome.failed == 0
            names.update(test.globs)
        else:
            exec(compile(block, document, "exec"), names)


@pytest.mark.skipif(COMPILER is None, reason="there is no C++ compiler")
def test_readme_compiles(tmp_path: pathlib.Path) -> None:
    blocks = re.findall(
        r"```cpp\n(.*?)```", (ROOT / "README.md").read_text(encoding="utf-8"), flags=re.DOTALL
    )
    assert blocks
    for block in blocks:
        lines = block.splitlines()
        includes = [line for line in lines if line.startswith("#include")]
        body = [line for line in lines if not line.startswith("#include")]
        source = tmp_path / "readme.cpp"
        source.write_text("\n".join([*includes, "int main() {", *body, "}", ""]), encoding="utf-8")
        flags = ["-std=c++20", "-fsyntax-only", f"-I{ROOT / 'include'}"]
        subprocess.run([str(COMPILER), *flags, source], check=True)


def test_the_version_is_one() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert re.search(r"^version: (.*)$", citation, flags=re.MULTILINE)[1] == project["version"]
    assert project["version"] in (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")


def test_links_between_documents_exist() -> None:
    for document in [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")]:
        for target in re.findall(r"\]\(([^)#\s]+)(?:#[^)]*)?\)", document.read_text(encoding="utf-8")):
            if "://" not in target:
                assert (document.parent / target).exists(), f"{relative(document)}: {target}"


@pytest.mark.parametrize(
    ("script", "table"),
    [
        ("tabulate_special.py", "tests/cpp/special_values.hpp"),
    ],
)
def test_generated_tables_are_up_to_date(script: str, table: str) -> None:
    made = subprocess.run(
        [sys.executable, ROOT / "tools" / script], capture_output=True, text=True, check=True
    )
    assert made.stdout == (ROOT / table).read_text(encoding="utf-8")


def test_no_path_of_a_machine() -> None:
    own = pathlib.Path(__file__).name
    tracked = [
        p
        for folder in ("include", "src", "tests", "tools", "docs", "bindings")
        for p in (ROOT / folder).rglob("*")
    ]
    for path in tracked:
        if (
            path.is_file()
            and path.suffix in {".py", ".hpp", ".cpp", ".md", ".txt", ".j2"}
            and path.name != own
        ):
            found = re.search(r"(?<![\w.])/(?:home|root|work|Users)/\w+", path.read_text(encoding="utf-8"))
            assert not found, f"{relative(path)}: {found}"
