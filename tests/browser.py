"""A headless Chromium, where there is one, that lays a page out at several widths and measures it."""

from __future__ import annotations

import html
import json
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

from limits import HANG

NAMES = ("chromium", "chromium-browser", "google-chrome", "chrome")

# In the page: whatever reaches beyond the nearest ancestor that scrolls, or beyond the window.
_MEASURE = r"""<script>
addEventListener('load', () => {
  const width = document.documentElement.clientWidth, outside = [], clipped = [];
  const name = e => `${e.tagName} ${e.closest('[id]')?.id ?? ''}: ${e.textContent.trim().slice(0, 50)}`;
  const scroller = e => e.parentElement.closest('.formula, .scroll');
  for (const e of document.querySelectorAll('body *:not(svg *, math *, style, script)')) {
    const {width: w, left, right} = e.getBoundingClientRect();
    const free = w && !scroller(e) && !e.matches('.skip');
    if (free && (right > width + 1 || left < -1)) outside.push(name(e));
    if (e.matches('.formula, .scroll') && e.scrollWidth > e.clientWidth + 1)
      clipped.push([e.className, getComputedStyle(e).overflowX, name(e)]);
  }
  const page = document.documentElement.scrollWidth, tables = [...document.querySelectorAll('.checks')];
  const checks = tables.map(e => e.getBoundingClientRect().width - e.parentElement.clientWidth);
  parent.postMessage({window: innerWidth, width, page, outside, clipped, checks}, '*');
});
</script>"""


def find() -> str | None:
    """The browser's path."""
    return next(filter(None, map(shutil.which, NAMES)), None)


def layouts(browser: str, page: str, widths: tuple[int, ...], folder: Path) -> list[dict[str, Any]]:
    """What the page measures at each width, in this order."""
    (folder / "inner.html").write_text(page.replace("</body>", _MEASURE + "</body>"), "utf-8")
    frames = "".join(
        f'<iframe src="inner.html" style="width:{w}px;height:900px;border:0"></iframe>' for w in widths
    )
    (folder / "outer.html").write_text(
        f"""<!DOCTYPE html><meta charset="utf-8"><pre id="found"></pre>
        <script>const found = []; addEventListener('message', e => {{ found.push(e.data);
        document.getElementById('found').textContent = JSON.stringify(found); }});</script>{frames}""",
        "utf-8",
    )
    flags = "--headless --no-sandbox --disable-gpu --no-first-run --disable-sync --disable-component-update"
    flags += " --disable-background-networking --disable-quic --virtual-time-budget=60000 --dump-dom"
    profile = f"--user-data-dir={folder / 'profile'}"
    command = [browser, *flags.split(), profile, (folder / "outer.html").as_uri()]
    dom = subprocess.run(command, capture_output=True, text=True, timeout=HANG, check=True).stdout
    (text,) = re.findall(r'<pre id="found">(.*?)</pre>', dom, re.DOTALL)
    found = {entry["window"]: entry for entry in json.loads(html.unescape(text))}
    return [found[width] for width in widths]
