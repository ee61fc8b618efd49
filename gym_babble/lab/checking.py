"""Checks the records that students hand in, by running them again."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING

from gym_babble import _core
from gym_babble.checks import check_threads
from gym_babble.files.handed_in import UnreadableError, one_line, read_handed_in
from gym_babble.lab import POLICIES

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["COLUMNS", "Checked", "check_record"]

COLUMNS = ("file", "name", "lesson", "tasks", "answers", "commands", "same hash", "verdict")


@dataclass(frozen=True, kw_only=True)
class Checked:
    """What was found in a record."""

    file: str
    """Name of the file."""
    name: str = ""
    """Who handed it in, as the record says."""
    lesson: str = ""
    """The lesson that was done; empty for a session without one."""
    tasks: tuple[bool, ...] = ()
    """Whether each task was done."""
    answers: tuple[bool, ...] = ()
    """Whether each answer is right."""
    commands: int = 0
    """Length of the record."""
    same_hash: bool = False
    """Whether running it again ends in the state that it says."""
    problem: str = ""
    """What is wrong with the record; empty for one that can be run again to the same end."""

    @property
    def verdict(self) -> str:
        """In a few words: "complete", what is missing, or what is wrong."""
        if self.problem:
            return self.problem
        if not self.lesson:
            return "no lesson"
        missing = [
            f"{found.count(False)} of {len(found)} {what}"
            for what, found in (("tasks not done", self.tasks), ("answers not right", self.answers))
            if not all(found)
        ]
        return ", ".join(missing) or "complete"

    def row(self) -> tuple[str, ...]:
        """Its cells in the columns `COLUMNS`."""
        shares = [f"{sum(part)}/{len(part)}" if part else "" for part in (self.tasks, self.answers)]
        hashes = "" if not self.commands and self.problem else ("yes" if self.same_hash else "no")
        return (
            self.file,
            self.name,
            self.lesson,
            *shares,
            str(self.commands),
            hashes,
            self.verdict,
        )


def check_record(path: Path, *, seconds: float = 120.0, threads: int | None = None) -> Checked:
    """Runs a record again. A file that is broken or forged gives a result that says so.

    Args:
        path: The file.
        seconds: How long running it again may take.
        threads: Threads that work; all processors if None.
    """
    file = one_line(path.name)
    try:
        text = read_handed_in(path)
    except UnreadableError as error:
        return Checked(file=file, problem=str(error))
    found = json.loads(_core.check_record(text, _policies(), seconds, check_threads(threads)))
    lesson, name, problem = (one_line(found[key] or "") for key in ("lesson", "name", "problem"))
    return Checked(
        file=file,
        name=name,
        lesson=lesson,
        tasks=tuple(found["tasks"]),
        answers=tuple(found["answers"]),
        commands=found["commands"],
        same_hash=found["same_hash"],
        problem=problem,
    )


def _policies() -> dict[str, bytes]:
    """The networks that the lab knows by name."""
    return {path.stem: path.read_bytes() for path in sorted(POLICIES.glob("*.safetensors"))}
