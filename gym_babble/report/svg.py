"""Figures as SVG inside a page: without addresses, and in the page's own colours."""

from __future__ import annotations

import re
from html import escape
from typing import TYPE_CHECKING

from gym_babble.viz.style import FAINT, GRID, INK, OBJECT, RED

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = ["inline_svg"]

VARIABLES: Mapping[str, str] = {
    INK: "var(--ink)",
    FAINT: "var(--faint)",
    GRID: "var(--line)",
    "#ffffff": "var(--page)",
    OBJECT: "var(--object)",
    RED: "var(--red)",
}
"""Colours of figures that the page's style replaces, on light and on dark paper."""


def inline_svg(svg: bytes, name: str, text: str) -> str:
    """A figure of matplotlib as an `svg` element.

    Args:
        svg: The SVG file.
        name: Begins all ids, which are then unique on the page.
        text: What a reader hears who cannot see the figure.
    """
    code = svg.decode()
    code = code[code.index("<svg") :]
    code = re.sub(r"\s*<(metadata|style)\b.*?</\1>|\s*<!--.*?-->", "", code, flags=re.DOTALL)
    code = re.sub(r'\s(xmlns(:\w+)?|version|width|height)="[^"]*"', "", code, count=5)
    code = re.sub(r'\bid="', f'id="{name}-', code)
    code = re.sub(r'(url\(|xlink:href=")#', rf"\g<1>#{name}-", code)
    for colour, variable in VARIABLES.items():
        code = code.replace(colour, variable)
    width = float(re.search(r'viewBox="0 0 ([\d.]+)', code)[1])  # type: ignore[index]
    shown = f'role="img" aria-label="{escape(text)}" style="max-width:{width / 0.75:.0f}px"'
    return code.replace("<svg", f"<svg {shown}", 1)
