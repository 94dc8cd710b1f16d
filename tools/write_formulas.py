"""Write the formulas of `_report/formulas.toml` into the pages of the families (`make docs-formulas`)."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parent.parent
SOURCE = ROOT / "src" / "microfacet" / "_report" / "formulas.toml"
BEGIN, END = "<!-- formulas.toml -->", "<!-- end of formulas.toml -->"


def formulas(entries: list[dict[str, Any]]) -> str:
    """A paragraph for each formula: its name, a display for each of its lines, the remark."""
    paragraphs = []
    for entry in entries:
        displays = "\n\n".join(f"$${latex}$$" for latex in entry["latex"])
        paragraphs += [f"**{entry['name']}**", displays, *([entry["remark"]] if "remark" in entry else [])]
    return "\n\n".join(paragraphs)


def page(text: str, entries: list[dict[str, Any]]) -> str:
    """A page with what stands between its two marks written again."""
    block = f"{BEGIN}\n\n{formulas(entries)}\n\n{END}"
    return re.sub(f"{re.escape(BEGIN)}.*?{re.escape(END)}", lambda _: block, text, flags=re.DOTALL)


def pages() -> dict[Path, str]:
    """Every family's page as it should be."""
    families = tomllib.loads(SOURCE.read_text("utf-8"))["families"]
    paths = {name: ROOT / "docs" / "family" / f"{name}.md" for name in families}
    return {path: page(path.read_text("utf-8"), families[name]["formulas"]) for name, path in paths.items()}


if __name__ == "__main__":
    for path, text in pages().items():
        path.write_text(text, "utf-8")
