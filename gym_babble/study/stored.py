"""Stored studies of PPO: `gym-babble compare` shows them."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from gym_babble.errors import StudyError
from gym_babble.files import write_file

__all__ = ["STUDIES", "Run", "Study"]

STUDIES = Path(__file__).with_name("results")
"""Folder of the studies that the package contains."""


@dataclass(frozen=True, kw_only=True)
class Run:
    """One training with a seed, and its test."""

    preset: str
    """Name of the preset."""
    steps: int
    """Steps asked for."""
    seed: int
    """Seed of the networks and of the training cases."""
    counts: dict[str, int]
    """Number of test cases, and how many had each outcome and fact."""
    by_size: dict[str, dict[str, int]] = field(default_factory=dict)
    """The same for each size of the objects."""
    movements: int
    """Episodes that ended during learning."""
    control_steps: int
    """Control steps learnt from."""
    seconds: float
    """Clock time of learning without validation [s]."""
    processor_seconds: float
    """Processor time of learning and validation [s]."""
    curve: list[list[float]]
    """Steps, seconds and success on the validation cases, during learning."""
    validation: dict[str, Any]
    """Protocol, split, seed and number of the validation cases."""
    versions: dict[str, str | None]
    """Versions of Python, this package and its dependencies."""
    machine: dict[str, Any]
    """System, processor, and threads of PyTorch."""

    @property
    def key(self) -> tuple[str, int, int]:
        """Preset, steps and seed: what distinguishes the runs of a study."""
        return self.preset, self.steps, self.seed


@dataclass(frozen=True, kw_only=True)
class Study:
    """The runs of a task's presets."""

    command: str
    """The command that ran them."""
    config: str
    """Body and task."""
    test: dict[str, Any]
    """Protocol, split and seed of the test cases, which are the same for each run."""
    presets: dict[str, Any]
    """The presets by name, as JSON types."""
    runs: list[Run]
    """The runs, in their order."""

    @classmethod
    def read(cls, path: Path) -> Study:
        """Reads a study.

        Raises:
            StudyError: The file is not one.
        """
        try:
            document = json.loads(path.read_text(encoding="utf-8"))
            runs = [Run(**run) for run in document.pop("runs")]
            return cls(**document, runs=runs)
        except (AttributeError, KeyError, TypeError, ValueError) as error:
            raise StudyError(f"{path}: not a stored study: {error}") from error

    def write(self, path: Path) -> None:
        """Writes the study, a run a line; an interruption leaves the file as it was.

        Raises:
            OSError: The file cannot be written; the earlier one is whole.
        """
        head = {name: value for name, value in vars(self).items() if name != "runs"}
        lines = [f"{json.dumps(name)}: {json.dumps(value)}" for name, value in head.items()]
        runs = ",\n".join(json.dumps(asdict(run)) for run in self.runs)
        write_file(path, "{\n" + ",\n".join([*lines, f'"runs": [\n{runs}\n]']) + "\n}\n")
