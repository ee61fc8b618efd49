"""Docstrings as Sphinx's autodoc reads them.

The environments' docstrings are Markdown, as in Gymnasium, and have pages of their own: the API
shows their first paragraph and names these pages.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sphinx.application import Sphinx

VALUES = ("attribute", "data", "property")
HIDDEN_COLON = "\ue000"
BULLET = re.compile(r"\s*(?:[-*]|\d+\.) ")


def process(
    _app: Sphinx, what: str, _name: str, _obj: Any, _options: Any, lines: list[str]
) -> None:
    """Rewrites the lines of a docstring in place."""
    if what in VALUES:
        # Napoleon takes what is before a colon in the first line for the type.
        lines[:] = [line.replace(":", HIDDEN_COLON) for line in lines]
    if "## Description" in lines:
        del lines[lines.index("## Description") :]
        lines += ["The specification is on :doc:`the pages of the ids </envs/index>`.", ""]
    lines[:] = [_without_substitutions(line) for line in lines]
    for i in range(len(lines) - 1, 0, -1):
        # Markdown's lists need no empty line before them, reStructuredText's do.
        before, here = lines[i - 1], lines[i]
        begins = BULLET.match(here) and not BULLET.match(before)
        if begins and before.strip() and not before.startswith(" "):
            lines.insert(i, "")


def show_colons(
    _app: Sphinx, what: str, _name: str, _obj: Any, _options: Any, lines: list[str]
) -> None:
    """Brings the colons back that were hidden from napoleon."""
    if what in VALUES:
        lines[:] = [line.replace(HIDDEN_COLON, ":") for line in lines]


def without_factories(*given: Any) -> tuple[str, str] | None:
    """A signature in which a default that is made by a factory reads `...`."""
    signature, returned = given[-2:]
    return signature and (signature.replace("<factory>", "..."), returned)


def _without_substitutions(line: str) -> str:
    """The line with |w| escaped, which would name a substitution, where it is no code."""
    parts = line.split("`")
    parts[::2] = [part.replace("|", r"\|") for part in parts[::2]]
    return "`".join(parts)


def setup(app: Sphinx) -> dict[str, Any]:
    """Called by Sphinx."""
    # Before napoleon, which reads sections of Google's style.
    app.connect("autodoc-process-docstring", process, priority=400)
    app.connect("autodoc-process-docstring", show_colons, priority=900)
    app.connect("autodoc-process-signature", without_factories)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
