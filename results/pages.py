"""Writes the stored numbers into README and docs, and finds numbers that come from no store."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from gym_babble.files.write import write_file
from results.blocks import BLOCKS
from results.sentences import SENTENCES, Sentences
from results.stores import ROOT, Stores

if TYPE_CHECKING:
    from collections.abc import Callable

BLOCK = re.compile(r"(<!-- results: (\w+) -->\n).*?( *<!-- end -->)", re.DOTALL)
FIELD = re.compile(r"\{([^:{}]+):([^{}]+)\}")
NUMBER = r"([−-]?[\d.,]*\d)"
APART = re.compile(
    r"<!-- (?:bench|results|recorded)\b.*?<!-- end -->|^```.*?^```|`[^`\n]*`|\]\([^)]*\)",
    re.DOTALL | re.MULTILINE,
)
"""What has a check of its own, says where it is from, or is code."""
UNITS = r"s|ms|µs|m|cm|mm|rad|mrad|N|N·m|kN/m|kg|°|µm|KiB|×"
RATE = re.compile(rf"(?<![\w.,/])(?:[01]?\.\d{{2,}}|\.\d)(?![\w.]|\d|\s?(?:{UNITS})\b)|\d+ of \d+")
"""A rate, or a count of trials."""


class PageError(ValueError):
    """A page and its sentences do not fit."""


def names() -> list[str]:
    """README and the pages of docs, also how to do a task."""
    pages = [path for folder in ("docs", "docs/how-to") for path in (ROOT / folder).glob("*.md")]
    return ["README.md", *sorted(str(path.relative_to(ROOT)) for path in pages)]


def read(name: str) -> str:
    """A page's text."""
    return (ROOT / name).read_text(encoding="utf-8")


def filled(name: str, page: str, stores: Stores) -> str:
    """The page with the tables and the sentences' numbers made from the stores.

    Raises:
        PageError: A sentence is not in the page, or more than once.
    """
    page = BLOCK.sub(lambda found: found[1] + BLOCKS[found[2]](stores) + found[3], page)
    for template in SENTENCES.get(name, Sentences()).measured:
        values = [shown(stores.find(path), form) for path, form in FIELD.findall(template)]
        found = place(name, page, template)
        # From the end, so that the earlier places stay where they are.
        for group in range(len(values), 0, -1):
            start, end = found.span(group)
            page = page[:start] + values[group - 1] + page[end:]
    return page


def shown(value: float, form: str) -> str:
    """A number as the page shows it.

    A form of a digit is a rate with so many digits after the point and no zero before it; other
    forms are Python's.
    """
    if form.isdigit():
        return f"{value:.{form}f}".removeprefix("0")[: int(form) + 1]
    return format(value, form).replace("-", "−")


def place(name: str, page: str, template: str) -> re.Match[str]:
    """Where the page has a sentence, whatever its numbers and line breaks."""
    parts = FIELD.split(template)[::3]  # Between them are paths and forms.
    literals = [r"\s+".join(re.escape(word) for word in re.split(r"\s+", part)) for part in parts]
    found = list(re.finditer(NUMBER.join(literals), page))
    if len(found) != 1:
        raise PageError(f"{name} has {len(found)} sentences like {template!r}, not one")
    return found[0]


def unstored(name: str, page: str) -> list[str]:
    """Rates in a page that come from no store and are not listed as fixed, with their context."""
    spaces: Callable[[re.Match[str]], str] = lambda found: " " * len(found[0])  # noqa: E731
    for template in SENTENCES.get(name, Sentences()).measured:
        start, end = place(name, page, template).span()
        page = page[:start] + " " * (end - start) + page[end:]
    for phrase in SENTENCES.get(name, Sentences()).fixed:
        pattern = r"\s+".join(re.escape(word) for word in phrase.split())
        page, count = re.subn(pattern, spaces, page)
        if not count:
            raise PageError(f"{name} has no {phrase!r}: take it from results/sentences.md")
    page = APART.sub(spaces, page)
    return [
        " ".join(page[max(0, found.start() - 40) : found.end() + 20].split())
        for found in RATE.finditer(page)
    ]


def write(stores: Stores) -> None:
    """Writes all pages."""
    for name in names():
        write_file(ROOT / name, filled(name, read(name), stores))


if __name__ == "__main__":
    write(Stores())
