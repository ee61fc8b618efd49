"""Checks outputs before long work, so that a typing error does not cost the results of hours."""

from __future__ import annotations

import os
from pathlib import Path

from gym_babble.errors import ConfigError
from gym_babble.files.write import part_of

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
    if target.is_dir():
        raise ConfigError(f"{name} {path}: is a folder, expected a file")
    if not target.parent.is_dir():
        problem = "is not a folder" if target.parent.exists() else "is missing; create it first"
        raise ConfigError(f"{name} {path}: folder {target.parent} {problem}")
    if target.exists() and not os.access(target, os.W_OK):
        raise ConfigError(f"{name} {path}: is read-only")
    if target.is_file() or not target.exists():
        _try(target, f"{name} {path}")


def check_folder(path: str | os.PathLike[str], name: str) -> None:
    """Checks that files can be written into a folder, which may be missing in an existing one.

    Args:
        path: The folder.
        name: The argument that gave it, for the error.

    Raises:
        ConfigError: The path is a file, or the folder around it is missing, or cannot be written
            to.
    """
    folder = Path(os.path.realpath(path))
    if folder.is_dir():
        _try(folder / "file", f"{name} {path}")
    elif folder.exists():
        raise ConfigError(f"{name} {path}: is a file, expected a folder")
    else:
        check_file(path, name)


def _try(target: Path, named: str) -> None:
    """Creates and removes an empty file beside `target`."""
    part = part_of(target)
    try:
        part.touch(exist_ok=False)
        part.unlink()
    except OSError as error:
        raise ConfigError(
            f"{named}: cannot write into {target.parent}: {error.strerror}"
        ) from error
