"""Tables of what a class has handed in."""

import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Annotated, Any, Protocol, TypeVar

import typer

from gym_babble.cli.output import name_files, print_json, print_results
from gym_babble.files import check_file, write_file
from gym_babble.files.handed_in import as_csv
from gym_babble.progress import track
from gym_babble.study.tables import plain_table

__all__ = ["ClassCsv", "print_class"]

PATIENCE_S = 2.0
"""Seconds after which a bar shows how many files are left."""

ClassCsv = Annotated[Path | None, typer.Option(help="Write the table as CSV, too.")]


class CheckedRow(Protocol):
    """What was found in a file."""

    @property
    def verdict(self) -> str:
        """In a few words."""
        ...

    def row(self) -> tuple[str, ...]:
        """Its cells."""
        ...


Row = TypeVar("Row", bound=CheckedRow)


def print_class(
    files: Sequence[Path],
    check: Callable[[Path], Row],
    columns: Sequence[str],
    as_dict: Callable[[Row], dict[str, Any]],
    *,
    csv: Path | None,
    as_json: bool,
) -> None:
    """Checks files, and prints a row for each.

    Args:
        files: What was handed in.
        check: Checks a file; one that is broken gives a row too.
        columns: Heads of the cells.
        as_dict: What a row has in JSON, beside its verdict.
        csv: Where to write the table, too.
        as_json: Print JSON in place of a table.
    """
    if csv is not None:
        check_file(csv, "--csv")
    checked = _checked(files, check)
    if csv is not None:
        write_file(csv, as_csv(columns, [one.row() for one in checked]))
        name_files([csv])
    if as_json:
        print_json([as_dict(one) | {"verdict": one.verdict} for one in checked])
        return
    table = plain_table(None, list(columns), left=len(columns))
    for one in checked:
        table.add_row(*one.row())
    print_results(table)


def _checked(files: Sequence[Path], check: Callable[[Path], Row]) -> list[Row]:
    checked: list[Row] = []
    started = time.monotonic()
    while len(checked) < len(files) and time.monotonic() - started < PATIENCE_S:
        checked.append(check(files[len(checked)]))
    left = len(files) - len(checked)
    for _ in track([1] * left, "checking", total=left, show=left > 0):
        checked.append(check(files[len(checked)]))
    return checked
