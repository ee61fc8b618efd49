"""Replaces files whole: a full disk, a crash or a second writer leaves no file half written."""

from __future__ import annotations

import os
import secrets
import stat
import sys
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

__all__ = ["part_of", "write_file", "write_files"]

Content = bytes | str
"""What a file shall contain; text is written as UTF-8, its line ends unchanged."""


def write_file(path: str | os.PathLike[str], content: Content) -> None:
    """Writes a file aside, in the same folder, and renames it.

    Until the new content is on the disk, the path leads to the earlier file. A link stays a link,
    permissions stay, and a pipe or a device is written to. A process killed while it writes leaves
    a hidden file `.*.part`, which may be removed.

    Raises:
        OSError: The file cannot be written; the earlier one is whole, and nothing else is left.
    """
    target = Path(os.path.realpath(path))
    with _naming(path):
        check_replaceable(target)
        if is_special(target):
            target.write_bytes(_bytes(content))
            return
        part = _write_part(target, content)
        _rename(part, target)
        _sync_folder(target.parent)


def write_files(
    folder: str | os.PathLike[str], contents: Mapping[str, Content], *, stale: Iterable[str] = ()
) -> list[Path]:
    """Writes files that belong together: the folder never has files of two runs.

    All are written aside before the first is renamed. The earlier files go first, so that a crash
    between two renames leaves some of them missing, never old beside new ones. Two writers take
    turns.

    Args:
        folder: Folder of the files; created if missing.
        contents: Content of each file, by name.
        stale: Names of earlier files that the new ones do not replace, and that go too.

    Returns:
        The files.

    Raises:
        OSError: A file cannot be written; the earlier ones are whole.
    """
    with _naming(folder):
        place = Path(folder)
        place.mkdir(parents=True, exist_ok=True)
        targets = [Path(os.path.realpath(place / name)) for name in contents]
        for target in targets:
            check_replaceable(target)
        parts: list[Path] = []
        try:
            for target, content in zip(targets, contents.values(), strict=True):
                parts.append(_write_part(target, content))
            with _locked(place):
                for earlier in [*(place / name for name in stale), *targets[1:]]:
                    earlier.unlink(missing_ok=True)
                for part, target in zip(parts, targets, strict=True):
                    _rename(part, target)
                _sync_folder(place)
        except BaseException:  # Ctrl-C too.
            for part in parts:
                part.unlink(missing_ok=True)
            raise
        return [place / name for name in contents]


def part_of(target: Path) -> Path:
    """A new name beside a file, for what is not complete yet."""
    return target.with_name(f".{secrets.token_hex(8)}.part")


def is_special(target: Path) -> bool:
    """Whether it is a pipe or a device."""
    try:
        mode = target.stat().st_mode
    except FileNotFoundError:
        return False
    return not stat.S_ISREG(mode) and not stat.S_ISDIR(mode)


def check_replaceable(target: Path) -> None:
    """Raises `OSError` for a folder, and for a file that is read-only.

    Renaming asks only what the folder permits.
    """
    if not is_special(target):  # Opening a pipe would wait for a reader.
        with suppress(FileNotFoundError):
            os.close(os.open(target, os.O_WRONLY))


def _bytes(content: Content) -> bytes:
    return content.encode("utf-8") if isinstance(content, str) else content


def _write_part(target: Path, content: Content) -> Path:
    """Writes a new file beside `target`, with its permissions, through to the disk."""
    part = part_of(target)
    try:
        with part.open("xb") as file:
            file.write(_bytes(content))
            file.flush()
            os.fsync(file.fileno())
        with suppress(OSError):  # A new file, or a file system without permissions.
            part.chmod(stat.S_IMODE(target.stat().st_mode))
    except BaseException:  # Ctrl-C too.
        part.unlink(missing_ok=True)
        raise
    return part


def _rename(part: Path, target: Path) -> None:
    try:
        part.replace(target)
    except BaseException:
        part.unlink(missing_ok=True)
        raise


def _sync_folder(folder: Path) -> None:
    """Makes renames survive a power cut; Windows does so by itself."""
    if sys.platform != "win32":
        handle = os.open(folder, os.O_RDONLY)
        try:
            with suppress(OSError):  # Some network file systems cannot.
                os.fsync(handle)
        finally:
            os.close(handle)


@contextmanager
def _naming(path: str | os.PathLike[str]) -> Iterator[None]:
    """Lets an error name the path that was asked for, not that of a part."""
    try:
        yield
    except OSError as error:
        raise OSError(error.errno, error.strerror, os.fspath(path)) from error


if sys.platform == "win32":
    import msvcrt

    @contextmanager
    def _locked(folder: Path) -> Iterator[None]:
        """One process at a time; a crash gives way to the next."""
        lock = folder / ".lock"
        with lock.open("ab") as file:
            msvcrt.locking(file.fileno(), msvcrt.LK_LOCK, 1)
            yield
        with suppress(OSError):  # The next process has it open.
            lock.unlink()

else:
    import fcntl

    @contextmanager
    def _locked(folder: Path) -> Iterator[None]:
        """One process at a time; a crash gives way to the next."""
        handle = os.open(folder, os.O_RDONLY)
        try:
            with suppress(OSError):  # Some network file systems have no locks.
                fcntl.flock(handle, fcntl.LOCK_EX)
            yield
        finally:
            os.close(handle)
