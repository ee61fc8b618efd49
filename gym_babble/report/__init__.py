"""The report of a comparison: one HTML file with its pictures inside, and its numbers as JSON."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from gym_babble.files import write_files
from gym_babble.report.page import page_of

if TYPE_CHECKING:
    from pathlib import Path

    from gym_babble.study.comparison import Comparison

__all__ = ["REPORT_FILES", "write_report"]

REPORT_FILES = ("index.html", "results.json")
"""Names of the files of a report."""


def write_report(
    comparison: Comparison, folder: Path, command: str, other: str | None = None
) -> list[Path]:
    """Writes index.html and results.json into a folder, both or neither.

    Args:
        comparison: The results to report.
        folder: Folder of the report; created if missing.
        command: The command that creates this report.
        other: Path from this page to the other task's page, for a link.

    Returns:
        The page and the JSON file.

    Raises:
        MissingExtraError: matplotlib is not installed.
        OSError: The files cannot be written; an earlier report is whole.
    """
    results = json.dumps(comparison.to_json(), indent=2) + "\n"
    page = page_of(comparison, command, other)
    return write_files(folder, dict(zip(REPORT_FILES, (page, results), strict=True)))
