"""`gym-babble lab check`."""

import time
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from gym_babble.cli.arguments import AsJson
from gym_babble.cli.output import name_files, print_json, print_results
from gym_babble.files import check_file, write_file
from gym_babble.lab.checking import COLUMNS, Checked, as_csv, check_record
from gym_babble.progress import track
from gym_babble.study.tables import plain_table

__all__ = ["check"]

PATIENCE_S = 2.0
"""Seconds after which a bar shows how many records are left."""


def check(
    files: Annotated[list[Path], typer.Argument(help="Records that the lab's page wrote.")],
    *,
    seconds: Annotated[
        float, typer.Option(min=0.1, help="Seconds that running a record again may take.")
    ] = 120.0,
    csv: Annotated[Path | None, typer.Option(help="Write the table as CSV, too.")] = None,
    as_json: AsJson = False,
) -> None:
    """Run records of lessons again, and print a table of the class.

    A record that was broken or forged has a row that says so.
    """
    if csv is not None:
        check_file(csv, "--csv")
    checked = _checked(files, seconds)
    if csv is not None:
        write_file(csv, as_csv(checked))
        name_files([csv])
    if as_json:
        print_json([asdict(one) | {"verdict": one.verdict} for one in checked])
        return
    table = plain_table(None, list(COLUMNS), left=len(COLUMNS))
    for one in checked:
        table.add_row(*one.row())
    print_results(table)


def _checked(files: list[Path], seconds: float) -> list[Checked]:
    checked: list[Checked] = []
    started = time.monotonic()
    while len(checked) < len(files) and time.monotonic() - started < PATIENCE_S:
        checked.append(check_record(files[len(checked)], seconds=seconds))
    left = len(files) - len(checked)
    for _ in track([1] * left, "checking", total=left, show=left > 0):
        checked.append(check_record(files[len(checked)], seconds=seconds))
    return checked
