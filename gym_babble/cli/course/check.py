"""`gym-babble course check`."""

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from gym_babble.cli.arguments import AsJson
from gym_babble.cli.handed_in import ClassCsv, print_class
from gym_babble.course.checking import COLUMNS, check_handed_in

__all__ = ["check"]


def check(
    files: Annotated[list[Path], typer.Argument(help="Files that `course.hand_in` wrote.")],
    *,
    csv: ClassCsv = None,
    as_json: AsJson = False,
) -> None:
    """Judge the answers of lessons again, and print a table of the class.

    Files are data: no code of students runs. A file that is broken has a row that says so.
    """
    print_class(files, check_handed_in, COLUMNS, asdict, csv=csv, as_json=as_json)
