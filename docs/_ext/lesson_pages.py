"""The lessons as pages: the students' executed notebooks, each with a link to download it."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

from writing import write_pages

ROOT = Path(__file__).resolve().parents[2]
NOT_EXECUTED = ". It takes longer than others, and was not executed for this copy of the site."
IN_REPOSITORY = re.compile(r"\(https://[^)]*/blob/main/docs/([^)?]*)(?:\?raw=true)?\)")
"""A link of a notebook to another page, which on the site is beside it."""
EXECUTED = ROOT / "build" / "lessons" / "student"


def sources() -> list[str]:
    """The names of the lessons that the repository has."""
    return sorted(path.stem for path in (ROOT / "docs" / "lessons").glob("[0-9]*.md"))


def page(notebook: Path) -> str:
    """A notebook whose first cell has a link to itself below its title."""
    content: dict[str, Any] = json.loads(notebook.read_text(encoding="utf-8"))
    for cell in content["cells"]:
        if cell["cell_type"] == "markdown":
            cell["source"] = IN_REPOSITORY.sub(r"(../\1)", "".join(cell["source"]))
    first = content["cells"][0]
    title, _, rest = first["source"].partition("\n")
    link = f"{{download}}`Download this notebook <../../build/lessons/student/{notebook.name}>`"
    shown = any(cell.get("outputs") for cell in content["cells"])
    first["source"] = f"{title}\n\n{link}{'' if shown else NOT_EXECUTED}\n{rest}"
    return json.dumps(content, ensure_ascii=False)


def write(folder: Path) -> None:
    """Writes the pages of the lessons that were executed into a folder."""
    write_pages(folder, {path.name: page(path) for path in sorted(EXECUTED.glob("[0-9]*.ipynb"))})
