"""Files that students hand in: read with care, and listed in a table of the class."""

from __future__ import annotations

import csv
import io
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path

__all__ = ["UnreadableError", "as_csv", "one_line", "read_handed_in"]

MOST_BYTES = 4 * 2**20
"""Bytes of a file, at most."""
FORMULA = "=+-@"
"""What a spreadsheet takes for the beginning of a formula."""


class UnreadableError(Exception):
    """A file cannot be read as text. The message says why."""


def read_handed_in(path: Path) -> str:
    """The text of a file.

    Raises:
        UnreadableError: It is missing, has more than 4 MiB, or is no UTF-8.
    """
    try:
        with path.open("rb") as opened:
            data = opened.read(MOST_BYTES + 1)
    except OSError as error:
        raise UnreadableError(f"it cannot be read: {error.strerror}") from error
    if len(data) > MOST_BYTES:
        raise UnreadableError(f"it has more than {MOST_BYTES:,} bytes")
    try:
        return data.decode()
    except UnicodeDecodeError as error:
        raise UnreadableError("it is no text in UTF-8") from error


def one_line(text: str) -> str:
    """A text of somebody's file on one line, without letters that would command the terminal."""
    return "".join(letter if letter.isprintable() else " " for letter in text)[:300]


def as_csv(columns: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table for spreadsheets. Before what these take for a formula stands an apostrophe."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    for row in rows:
        writer.writerow([f"'{cell}" if cell and cell[0] in FORMULA else cell for cell in row])
    return text.getvalue()
