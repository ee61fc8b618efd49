"""Checks outputs before long work, so that a typing error does not cost the results of hours."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from gym_babble.errors import ConfigError
from gym_babble.files.write import check_replaceable, is_special, part_of

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["check_file", "check_folder"]


def check_file(path: str | os.PathLike[str], name: str) -> None:
    """Checks that a file can be written, without touching it.

    Args:
        path: The file.
        name: The argument that gave it, for the error.

    Raises:
        ConfigError: The path is a folder, or its folder is missing or cannot be written to.
    """
    target = Path(os.path.realpath(path))
    if target.is_dir():  # Windows calls it a file without permission.
        raise ConfigError(f"{name} {path}: is a folder, expected a file")
    if not target.parent.is_dir():
        problem = "is not a folder" if target.parent.exists() else "is missing; create it first"
        raise ConfigError(f"{name} {path}: folder {target.parent} {problem}")
    if not is_special(target):
        _try(target, f"{name} {path}")


def check_folder(path: str | os.PathLike[str], name: str, files: Iterable[str]) -> None:
    """Checks that files can be written into a folder, which may be missing in an existing one.

    Args:
        path: The folder.
        name: The argument that gave it, for the error.
        files: Names of the files.

    Raises:
        ConfigError: The path is a file, the folder around it is missing, or a file in it cannot be
            written.
    """
    folder = Path(os.path.realpath(path))
    if folder.is_dir():
        for file in files:
            check_file(Path(path) / file, name)
    elif folder.exists():
        raise ConfigError(f"{name} {path}: is a file, expected a folder")
    else:
        check_file(path, name)


def _try(target: Path, named: str) -> None:
    """Opens `target`, and creates and removes an empty file beside it."""
    part = part_of(target)
    try:
        check_replaceable(target)
        part.touch(exist_ok=False)
        part.unlink()
    except OSError as error:
        raise ConfigError(f"{named}: cannot be written: {error.strerror}") from error
