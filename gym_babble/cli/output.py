"""Printing results and messages, and checking paths before long work."""

import json
from pathlib import Path
from typing import Any

import typer
from rich.console import Console

from gym_babble.files import check_file, write_files
from gym_babble.viz.style import check_format

__all__ = [
    "check_picture",
    "name_files",
    "print_json",
    "print_results",
    "say",
    "table_files",
    "write_table",
]

# A path or a name is shown as it is: square brackets are no markup in it, and `:x:` is no emoji.
results = Console(markup=False, emoji=False, highlight=False)
messages = Console(markup=False, emoji=False, highlight=False, stderr=True)


def print_results(*parts: Any) -> None:
    """Prints tables or lines of text to stdout."""
    for part in parts:
        results.print(part, soft_wrap=isinstance(part, str))


def print_json(document: Any) -> None:
    """Prints a document of JSON types to stdout."""
    typer.echo(json.dumps(document, indent=2))


def say(text: str) -> None:
    """Prints a message to stderr."""
    messages.print(text, soft_wrap=True)


def name_files(files: list[Path]) -> None:
    """Prints the names of written files to stderr."""
    for file in files[:3]:
        say(str(file))
    if len(files) > 3:
        say(f"... and {len(files) - 3} more")


def check_picture(path: Path) -> None:
    """Checks file, format and the extra `figures` before long work."""
    check_file(path, "--out")
    check_format(path)


def table_files(name: str) -> tuple[str, str]:
    """Names of a table's files."""
    return f"{name}.json", f"{name}.csv"


def write_table(folder: Path, name: str, document: dict[str, Any], csv: str) -> None:
    """Writes a table as JSON and CSV into a folder, which is created if missing."""
    text = json.dumps(document, indent=2) + "\n"
    files = dict(zip(table_files(name), (text, csv), strict=True))
    name_files(write_files(folder, files))
