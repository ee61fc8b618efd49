"""Files are replaced whole or not at all, and outputs are checked before long work."""

from __future__ import annotations

import errno
import os
import re
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from gym_babble.errors import ConfigError
from gym_babble.files import (
    check_file,
    check_folder,
    write,  # Its module, to crash in the middle.
    write_file,
    write_files,
)

posix = pytest.mark.skipif(sys.platform == "win32", reason="signals and modes of POSIX")

EARLIER = "earlier\n"


def names(folder):
    return sorted(path.name for path in folder.iterdir())


@pytest.mark.parametrize("content", ["text – é\r\n\n", b"\0\xff", ""])
def test_a_file_holds_what_was_written(tmp_path, content):
    for _ in range(2):  # A new file, and one in the place of another.
        write_file(tmp_path / "out", content)
        expected = content.encode() if isinstance(content, str) else content
        assert (tmp_path / "out").read_bytes() == expected
    assert names(tmp_path) == ["out"]


# A limit on the size of a file stands for a full disk: writing fails in the middle.
LIMITED = """
import resource, signal, sys
from pathlib import Path
from gym_babble.files import write_file, write_files
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (10_000, resource.RLIM_INFINITY))
folder = Path(sys.argv[1])
for write in (
    lambda: write_file(folder / "a", "x" * 100_000),
    lambda: write_files(folder, {"a": "small", "b": "x" * 100_000}),
):
    try:
        write()
    except OSError as error:
        print(error.filename)
"""


@posix
def test_a_full_disk_leaves_the_earlier_files_whole(tmp_path):
    for name in "ab":
        write_file(tmp_path / name, EARLIER)
    run = subprocess.run(
        [sys.executable, "-c", LIMITED, tmp_path], check=True, capture_output=True, text=True
    )
    # The error names what was asked for, not a temporary file.
    assert run.stdout.splitlines() == [str(tmp_path / "a"), str(tmp_path)]
    assert names(tmp_path) == ["a", "b"]
    assert {(tmp_path / name).read_text() for name in "ab"} == {EARLIER}


KILLED = """
import sys
from pathlib import Path
from gym_babble.files import write_file, write_files
folder, size = Path(sys.argv[1]), 2_000_000
print("go", flush=True)
for k in range(1_000_000):
    text = str(k % 10) * size
    write_file(folder / "alone", text)
    write_files(folder, {"a": text, "b": text})
"""


@posix
def test_a_killed_process_leaves_each_file_whole_and_no_two_of_different_runs(tmp_path):
    text = "0" * 2_000_000
    write_file(tmp_path / "alone", text)
    write_files(tmp_path, {"a": text, "b": text})
    for k in range(6):
        process = subprocess.Popen(
            [sys.executable, "-c", KILLED, tmp_path], stdout=subprocess.PIPE, text=True
        )
        process.stdout.readline()
        time.sleep(0.01 + 0.015 * k)
        process.send_signal(signal.SIGKILL)
        process.communicate()
        found = {
            name: (tmp_path / name).read_text()
            for name in ("alone", "a", "b")
            if (tmp_path / name).exists()
        }
        for content in found.values():
            assert content == content[0] * 2_000_000
        assert "alone" in found
        assert "a" in found
        assert found.get("b", found["a"]) == found["a"]


def test_a_crash_between_two_renames_leaves_no_files_of_two_runs(tmp_path, monkeypatch):
    write_files(tmp_path, dict.fromkeys("abc", EARLIER))
    rename, done = write._rename, []

    def crash_after_one(part, target):
        if done:
            raise KeyboardInterrupt
        done.append(target)
        rename(part, target)

    monkeypatch.setattr(write, "_rename", crash_after_one)
    with pytest.raises(KeyboardInterrupt):
        write_files(tmp_path, dict.fromkeys("abc", "new"))
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == {"a": "new"}


def test_two_writers_of_one_folder_take_turns(tmp_path):
    def write_all(k):
        write_files(tmp_path, {name: str(k) * 1000 for name in "abcdef"})

    with ThreadPoolExecutor(8) as pool:
        list(pool.map(write_all, range(200)))
    assert names(tmp_path) == list("abcdef")
    assert len({path.read_text() for path in tmp_path.iterdir()}) == 1


@posix
def test_permissions_links_and_devices_stay(tmp_path):
    target, link = tmp_path / "target", tmp_path / "link"
    target.touch(0o640)
    target.chmod(0o640)
    link.symlink_to(target)
    write_file(link, "new")
    assert link.is_symlink()
    assert target.read_text() == "new"
    assert target.stat().st_mode & 0o777 == 0o640
    write_file(os.devnull, "nothing")
    assert not Path(os.devnull).is_file()
    (tmp_path / "fresh").touch()
    write_file(tmp_path / "other", "")
    assert (tmp_path / "other").stat().st_mode == (tmp_path / "fresh").stat().st_mode


def read_only(_path, flags):
    raise OSError(errno.EACCES if flags & os.O_WRONLY else 0, "no permission")


def test_folders_and_read_only_files_are_not_replaced(tmp_path, monkeypatch):
    (tmp_path / "folder").mkdir()
    write_file(tmp_path / "a", EARLIER)
    with pytest.raises(OSError, match="folder") as caught:
        write_file(tmp_path / "folder", "new")
    assert caught.value.errno == errno.EISDIR
    with pytest.raises(OSError, match=str(errno.EISDIR)):
        write_files(tmp_path, {"a": "new", "folder": "new"})
    monkeypatch.setattr(os, "open", read_only)
    with pytest.raises(PermissionError):
        write_file(tmp_path / "a", "new")
    with pytest.raises(ConfigError, match=r"--out .*: cannot be written: no permission"):
        check_file(tmp_path / "a", "--out")
    assert (tmp_path / "a").read_text() == EARLIER


def check_folder_of_a(path, name):
    check_folder(path, name, ["a"])


def test_a_check_says_what_is_in_the_way_and_leaves_nothing(tmp_path):
    folder, file = tmp_path / "folder", tmp_path / "file"
    folder.mkdir()
    file.touch()
    for check, path, problem in (
        (check_file, folder, "is a folder, expected a file"),
        (check_file, tmp_path / "missing" / "a", "missing is missing; create it first"),
        (check_file, file / "a", "file is not a folder"),
        (check_folder_of_a, file, "is a file, expected a folder"),
        (check_folder_of_a, file / "a", "file is not a folder"),
        (check_folder_of_a, tmp_path / "missing" / "a", "missing is missing; create it first"),
    ):
        with pytest.raises(ConfigError, match=problem) as caught:
            check(path, "--out")
        assert str(caught.value).startswith(f"--out {path}: ")
    for path in (file, tmp_path / "new", os.devnull):
        check_file(path, "--out")
    for path in (folder, tmp_path, tmp_path / "new"):
        check_folder_of_a(path, "--out")
    assert names(tmp_path) == ["file", "folder"]
    assert not names(folder)
    (folder / "a").mkdir()
    with pytest.raises(ConfigError, match="a: is a folder, expected a file"):
        check_folder_of_a(folder, "--out")


@posix
def test_a_check_tries_to_write(tmp_path, monkeypatch):
    # Permissions do not show a read-only file system.
    def refuse(*_, **__):
        raise OSError(errno.EROFS, os.strerror(errno.EROFS))

    monkeypatch.setattr(Path, "touch", refuse)
    for check in (check_file, check_folder_of_a):
        with pytest.raises(ConfigError, match="cannot be written: Read-only file system"):
            check(tmp_path / "a", "--out")
    with pytest.raises(ConfigError, match="cannot be written"):
        check_folder_of_a(tmp_path, "--out")


WRITES = re.compile(r"\.write_(text|bytes)\(|open\([^)]*[\"'][wax]b?[\"']")


def test_nothing_else_of_ours_writes_files(repository):
    # A file written in place is lost when the disk is full. `bench/machine.py` renames by itself.
    found = {
        path.relative_to(repository).as_posix()
        for folder in ("gym_babble", "examples", "docs/experiments", "bench")
        for path in (repository / folder).rglob("*.py")
        if WRITES.search(path.read_text(encoding="utf-8"))
    }
    assert found == {"gym_babble/files/write.py", "bench/machine.py"}
