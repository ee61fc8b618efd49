"""Learning curves from the logs of stable-baselines3, so that anyone's own runs can join a report.

A log counts steps of the environment. In `pattern` control one step is a whole movement: pass its
number of control steps as `steps_per_action`, so that the costs compare.
"""

from __future__ import annotations

import csv
import json
import math
import zipfile
import zlib
from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble.checks import check_path, check_whole, shown
from gym_babble.errors import ConfigError, StudyError
from gym_babble.study.efficiency import Curve

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from os import PathLike
    from pathlib import Path

__all__ = ["read_curve", "read_evaluations", "read_monitor"]

EVALUATIONS = "evaluations.npz"
MONITOR = "monitor.csv"
SUCCESS = "is_success"
TRUTHS = {"True": True, "1": True, "1.0": True, "False": False, "0": False, "0.0": False}
"""How CSV files write whether an episode succeeded."""
WINDOW = 100
"""Episodes behind each point, as in stable-baselines3's own success rate."""


def read_curve(path: str | PathLike[str], *, steps_per_action: int = 1) -> Curve:
    """The learning curve of one seed, from a log or from the folder of a run.

    A folder's `evaluations.npz` comes first, because its episodes are tests; without it all of its
    `*monitor.csv` count, one for each environment of the run.

    Args:
        path: `evaluations.npz`, a `monitor.csv`, or a folder.
        steps_per_action: Control steps of one step of the environment.

    Raises:
        StudyError: There is no log, or it cannot be read: names file, line and field.
        OSError: A file cannot be opened.
    """
    found = check_path("path", path)
    if found.is_dir():
        if (found / EVALUATIONS).exists():
            return read_evaluations(found / EVALUATIONS, steps_per_action=steps_per_action)
        monitors = sorted(found.glob(f"*{MONITOR}"))
        if not monitors:
            raise StudyError(f"{found}: has neither {EVALUATIONS} nor *{MONITOR}")
        return read_monitor(*monitors, steps_per_action=steps_per_action)
    if found.suffix == ".npz":
        return read_evaluations(found, steps_per_action=steps_per_action)
    if found.name.endswith(MONITOR):
        return read_monitor(found, steps_per_action=steps_per_action)
    raise StudyError(f"{found}: is neither {EVALUATIONS} nor *{MONITOR}")


def read_evaluations(path: str | PathLike[str], *, steps_per_action: int = 1) -> Curve:
    """The curve in an `evaluations.npz`, which stable-baselines3's `EvalCallback` writes.

    Its field `successes` has the tests; the callback writes it if the environment's info has
    `is_success`, as ours has.

    Args:
        path: The file.
        steps_per_action: Control steps of one step of the environment.

    Raises:
        StudyError: It is not such a file, has no successes, or a field is wrong: names it.
        OSError: The file cannot be opened.
    """
    file = check_path("path", path)
    each = _check_steps_per_action(steps_per_action)
    fields = _fields(file, ("timesteps", "successes"))
    steps, successes = fields["timesteps"], fields["successes"]
    for name, array, ndim in (("timesteps", steps, 1), ("successes", successes, 2)):
        if array.ndim != ndim or not array.size or array.dtype.kind not in "biuf":
            raise StudyError(
                f"{file}: {name} has shape {array.shape} and type {array.dtype}, expected numbers,"
                f" {ndim}-dimensional"
            )
    if not np.isin(successes, (0, 1)).all():
        raise StudyError(f"{file}: successes has values other than True and False")
    return _curve(file, steps * each, successes.mean(axis=1))


def read_monitor(*paths: str | PathLike[str], steps_per_action: int = 1) -> Curve:
    """The curve in one or several `monitor.csv`, which stable-baselines3's `Monitor` writes.

    Several files are the environments of one run; their episodes are put in the order of time. Each
    point is the success of 100 episodes of training, so noise of exploration counts too; the rest
    of less than 100 is left out. The column `is_success` is there if `Monitor` was asked for it:
    `Monitor(env, file, info_keywords=("is_success",))`.

    Args:
        *paths: The files.
        steps_per_action: Control steps of one step of the environment.

    Raises:
        ConfigError: No file.
        StudyError: A file is not such a log, or there are fewer than 100 episodes: names file,
            line and field.
        OSError: A file cannot be opened.
    """
    each = _check_steps_per_action(steps_per_action)
    files = [check_path("path", path) for path in paths]
    if not files:
        raise ConfigError("paths is empty, expected 1 monitor.csv or more")
    episodes = sorted(episode for file in files for episode in _episodes(file))
    points = len(episodes) // WINDOW
    if not points:
        raise StudyError(f"{files[0]}: {len(episodes)} episodes, a curve needs {WINDOW} or more")
    _, lengths, successes = np.array(episodes, dtype=np.float64).T
    ends = np.cumsum(lengths)[WINDOW - 1 :: WINDOW]
    rates = successes[: points * WINDOW].reshape(points, WINDOW).mean(axis=1)
    return _curve(files[0], ends * each, rates)


def _check_steps_per_action(steps: int) -> int:
    return check_whole("steps_per_action", steps, 1, 1_000_000, "control steps")


def _curve(file: Path, control_steps: Any, success: Any) -> Curve:
    try:
        return Curve(control_steps, success)
    except ConfigError as error:
        raise StudyError(f"{file}: {error}") from error


def _fields(file: Path, names: Sequence[str]) -> dict[str, np.ndarray[Any, Any]]:
    """Some arrays of an npz file; nothing is unpickled."""
    try:
        with zipfile.ZipFile(file) as archive:
            missing = [name for name in names if f"{name}.npy" not in archive.namelist()]
        if not missing:
            with np.load(file, allow_pickle=False) as arrays:
                return {name: arrays[name] for name in names}
    except (zipfile.BadZipFile, zlib.error, ValueError, EOFError, NotImplementedError) as error:
        raise StudyError(f"{file}: not an {EVALUATIONS}: {error}") from error
    hint = f"; EvalCallback writes it if info has {SUCCESS}" if "successes" in missing else ""
    raise StudyError(f"{file}: has no field {missing[0]}{hint}")


def _episodes(file: Path) -> Iterator[tuple[float, int, bool]]:
    """End [s], length and success of each episode in a monitor file."""
    # A byte that is no text becomes a wrong value, so that its line and field are named.
    with file.open(newline="", encoding="utf-8", errors="backslashreplace") as lines:
        line = 1
        try:
            start = _start(lines.readline())
            line = 2
            rows = csv.DictReader(lines)
            _check_columns(rows.fieldnames or ())
            for row in rows:
                line = 1 + rows.line_num
                _check_count(row)
                yield start + _number("t", row["t"]), _length(row["l"]), _success(row[SUCCESS])
        except (ValueError, csv.Error) as error:
            raise StudyError(f"{file}, line {line}: {error}") from error


def _start(header: str) -> float:
    """Clock time at which the file began [s], from its first line."""
    try:
        return float(json.loads(header.removeprefix("#"))["t_start"])
    except (ValueError, KeyError, TypeError) as error:
        raise ValueError(
            f"{shown(header.rstrip())} is not the first line of a {MONITOR}, which starts with"
            ' #{"t_start": …'
        ) from error


def _check_columns(columns: Sequence[str]) -> None:
    for name in ("t", "l", SUCCESS):
        if name not in columns:
            hint = f'; ask Monitor for it: info_keywords=("{SUCCESS}",)' if name == SUCCESS else ""
            raise ValueError(f"has no column {name}, only {', '.join(columns)}{hint}")


def _check_count(row: dict[Any, Any]) -> None:
    """More values than columns: DictReader puts the rest under None."""
    if None in row:
        columns = len(row) - 1
        raise ValueError(f"has {columns + len(row[None])} values for {columns} columns")


def _number(name: str, text: str | None) -> float:
    try:
        number = float(text or "")
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise ValueError(f"{name} = {shown(text)} is not a finite number")
    return number


def _length(text: str | None) -> int:
    number = _number("l", text)
    if number < 1 or not number.is_integer():
        raise ValueError(f"l = {shown(text)} is not a whole number of steps, 1 or more")
    return int(number)


def _success(text: str | None) -> bool:
    if text not in TRUTHS:
        raise ValueError(f"{SUCCESS} = {shown(text)} is neither True nor False")
    return TRUTHS[text]
