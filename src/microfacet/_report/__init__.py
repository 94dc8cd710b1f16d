"""Pages of one HTML file each: `families` on every formula, figure and check, `surfaces` on a fitted surface.

A page collects its content from the library as plain data, draws its figures (`figure`), and `page` sets it.
"""

from collections.abc import Callable

from microfacet._optional import require

__all__ = ["Progress"]

require("the report needs", "report")

#: Told what begins, how many steps are done, and how many there are.
Progress = Callable[[str, int, int], None]
