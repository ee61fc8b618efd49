"""`gym-babble lab check`."""

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from gym_babble.cli.arguments import AsJson
from gym_babble.cli.handed_in import ClassCsv, print_class
from gym_babble.lab.checking import COLUMNS, Checked, check_record

__all__ = ["check"]


def check(
    files: Annotated[list[Path], typer.Argument(help="Records that the lab's page wrote.")],
    *,
    seconds: Annotated[
        float, typer.Option(min=0.1, help="Seconds that running a record again may take.")
    ] = 120.0,
    csv: ClassCsv = None,
    as_json: AsJson = False,
) -> None:
    """Run records of lessons again, and print a table of the class.

    A record that was broken or forged has a row that says so.
    """

    def checked(file: Path) -> Checked:
        return check_record(file, seconds=seconds)

    print_class(files, checked, COLUMNS, asdict, csv=csv, as_json=as_json)
