"""The folder of a study: its spec, a file for each run, and the agents that learnt.

```
study.json                          the spec
runs/TASK.LABEL.SEED.HASH.json      a run, finished or failed
agents/TASK.LABEL.SEED.HASH.*       its agent
```

The hash names all that decides a run's result. A run of an earlier spec or of other physics has
another one: it stays in the folder, and is no part of the results.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gym_babble.agents.acting import first_difference
from gym_babble.errors import ConfigError, StudyError
from gym_babble.files import write_file
from gym_babble.study.run import FORMAT, RunSpec, runs_of
from gym_babble.study.spec import Study, study_of
from gym_babble.study.versions import physics_hash

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["Store", "StoredRun"]

SPEC = "study.json"


@dataclass(frozen=True)
class StoredRun:
    """A run of a study, and its record if it has run."""

    spec: RunSpec
    record: dict[str, Any] | None
    """As `execute` returns it; None if the run is missing."""
    agent: Path | None
    """The agent's file, if there is one."""

    @property
    def finished(self) -> bool:
        """Whether it ran to its end."""
        return self.record is not None and self.record["status"] == "finished"

    @property
    def error(self) -> str | None:
        """Why it failed; None if it did not."""
        return None if self.record is None else self.record.get("error")


class Store:
    """The folder of a study.

    Args:
        folder: The folder; `open` makes it.
    """

    def __init__(self, folder: str | Path) -> None:
        self.folder = Path(folder)
        self._opened: Study | None = None

    def open(self, study: Study) -> None:
        """Makes the folder, or goes on in one of a study of the same name.

        Raises:
            StudyError: It is the folder of another study, or of another version.
            OSError: It cannot be written.
        """
        if (self.folder / SPEC).exists() and (there := self.study().name) != study.name:
            raise StudyError(
                f"{self.folder} is the folder of study {there!r}, and this is {study.name!r}: "
                "choose another folder"
            )
        for name in ("runs", "agents"):
            (self.folder / name).mkdir(parents=True, exist_ok=True)
        document = {"format": FORMAT, **study.to_json()}
        write_file(self.folder / SPEC, json.dumps(document, indent=1) + "\n")
        self._opened = study

    def study(self) -> Study:
        """The spec that was opened, also if another process has replaced it; else the stored one.

        Raises:
            FileNotFoundError: The folder is not a study's.
            StudyError: The spec cannot be read, or is of another version.
        """
        if self._opened is not None:
            return self._opened
        path = self.folder / SPEC
        if not path.is_file():
            raise FileNotFoundError(f"{self.folder} is not the folder of a study: no {SPEC} in it")
        document = _read(path)
        del document["format"]
        try:
            return study_of(document)
        except ConfigError as error:
            raise StudyError(f"{path}: {error}") from error

    def runs(self, specs: Sequence[RunSpec] | None = None) -> list[StoredRun]:
        """The runs of the study, in its order, those that are missing too.

        Args:
            specs: The runs to look for; those of the stored spec if not given.

        Raises:
            StudyError: A file cannot be read.
        """
        return [self._run(spec) for spec in (runs_of(self.study()) if specs is None else specs)]

    def write(self, spec: RunSpec, record: dict[str, Any], file: tuple[str, bytes] | None) -> None:
        """Writes a run. It is there whole, with its agent, or not at all.

        Raises:
            OSError: A file cannot be written.
        """
        for old in self._agents(spec):
            old.unlink()
        if file is not None:
            suffix, content = file
            write_file(self.folder / "agents" / f"{_stem(spec)}{suffix}", content)
        write_file(self._path(spec), json.dumps(record) + "\n")

    def unfit(self, specs: Sequence[RunSpec]) -> list[str]:
        """What does not fit the spec: a sentence for each stored run that is no part of it.

        Raises:
            StudyError: A file cannot be read.
        """
        wanted = {self._path(spec) for spec in specs}
        named = {spec.name: spec for spec in specs}
        paths = sorted((self.folder / "runs").glob("*.json"))
        return [_misfit(path, named) for path in paths if path not in wanted]

    def _run(self, spec: RunSpec) -> StoredRun:
        path = self._path(spec)
        record = _read(path) if path.is_file() else None
        return StoredRun(spec, record, next(iter(self._agents(spec)), None))

    def _path(self, spec: RunSpec) -> Path:
        return self.folder / "runs" / f"{_stem(spec)}.json"

    def _agents(self, spec: RunSpec) -> list[Path]:
        return sorted((self.folder / "agents").glob(f"{_stem(spec)}.*"))


def _stem(spec: RunSpec) -> str:
    return f"{spec.name}.{spec.fingerprint}"


def _misfit(path: Path, named: dict[str, RunSpec]) -> str:
    """Why a stored run is no part of the study.

    Raises:
        StudyError: The file is not a run.
    """
    record = _read(path)
    try:
        stored, physics = RunSpec.from_json(record["spec"]), record["physics"]
    except (KeyError, TypeError) as error:
        raise StudyError(f"{path}: not a run of a study: {error}") from error
    now = named.get(stored.name)
    if now is None:
        return f"{stored.name}: the study has no such run"
    field = first_difference(record["spec"], now.to_json(), "run")
    if field is not None:
        name, before, after = field
        return f"{stored.name}: {name.removeprefix('run.')} was {before!r}, and is {after!r} now"
    return f"{stored.name}: ran with physics {physics}, and they are {physics_hash()} now"


def _read(path: Path) -> dict[str, Any]:
    """A document of a store.

    Raises:
        StudyError: It cannot be read, or another version wrote it.
    """
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
        found = document["format"]
    except (KeyError, TypeError, ValueError) as error:
        raise StudyError(f"{path}: not a file of a study: {error}") from error
    if found != FORMAT:
        raise StudyError(f"{path}: format = {found!r}, and this version reads {FORMAT}")
    return document  # type: ignore[no-any-return]
