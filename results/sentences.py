"""Reads sentences.md: the numbers in the pages' prose."""

from __future__ import annotations

from dataclasses import dataclass, field

from results.stores import FOLDER


@dataclass
class Sentences:
    """What sentences.md lists for a page."""

    measured: list[str] = field(default_factory=list)
    """Templates with stored numbers."""
    fixed: list[str] = field(default_factory=list)
    """Phrases whose numbers no command measures."""


def read() -> dict[str, Sentences]:
    """The sentences of each page."""
    pages: dict[str, Sentences] = {}
    text = (FOLDER / "sentences.md").read_text(encoding="utf-8")
    for section in text.split("\n## ")[1:]:
        page, *paragraphs = (" ".join(part.split()) for part in section.split("\n\n"))
        pages[page] = Sentences(
            [part for part in paragraphs if part and not part.startswith("fixed: ")],
            [part.removeprefix("fixed: ") for part in paragraphs if part.startswith("fixed: ")],
        )
    return pages


SENTENCES = read()
"""The sentences of each page."""
