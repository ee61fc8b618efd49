"""Files of pages that a script makes."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path


def write_pages(folder: Path, pages: dict[str, str]) -> None:
    """Writes pages by their file names into a folder, and removes others.

    A page that stays the same is left alone: Sphinx reads again what is newer.
    """
    folder.mkdir(exist_ok=True)
    for old in folder.iterdir():
        if old.name not in pages:
            old.unlink()
    for name, text in pages.items():
        path = folder / name
        if not path.is_file() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")
