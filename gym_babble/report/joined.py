"""Learning curves from logs of stable-baselines3 that join a report beside the study's agents."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gym_babble.errors import ConfigError
from gym_babble.report.learning import budget_numbers, curve_numbers
from gym_babble.study.logs import read_curve
from gym_babble.study.spec import NAME

if TYPE_CHECKING:
    from collections.abc import Sequence

    from gym_babble.report.learning import Runs
    from gym_babble.study.efficiency import Curve
    from gym_babble.study.spec import Study

__all__ = ["AXIS", "JoinedRuns", "joined_numbers", "read_joined"]

AXIS = "control_steps"
"""The axis of the curves: logs do not have the others."""


@dataclass(frozen=True, kw_only=True)
class JoinedRuns:
    """Curves of someone's own runs, one for each seed."""

    task: str
    """Name of the task in the study."""
    label: str
    names: tuple[str, ...]
    """Name of each run's log or folder."""
    runs: Runs
    """Control steps and success of each."""


def read_joined(given: str, study: Study, steps_per_action: int = 1) -> JoinedRuns:
    """Reads the runs of "TASK:LABEL=PATH".

    Args:
        given: Task of the study, a new label, and a path: `evaluations.npz`, a `monitor.csv`, the
            folder of a run, or a folder with a folder for each run.
        study: The study that they join.
        steps_per_action: Control steps of one step of the environment.

    Raises:
        ConfigError: It is not of this form, there is no such task or path, or the label is taken.
        StudyError: There is no log, or it cannot be read: names file, line and field.
    """
    place, _, path = given.partition("=")
    task, _, label = place.partition(":")
    if not NAME.fullmatch(label) or not path:
        raise ConfigError(f"join = {given!r} is not of the form TASK:LABEL=PATH")
    if task not in study.tasks:
        raise ConfigError(f"join = {given!r}: {task!r} is not one of {', '.join(study.tasks)}")
    if label in {agent.label for agent in study.agents}:
        raise ConfigError(f"join = {given!r}: the study has an agent {label!r} already")
    logs = _logs(Path(path))
    curves = [read_curve(log, steps_per_action=steps_per_action) for log in logs]
    return JoinedRuns(
        task=task,
        label=label,
        names=tuple(log.name for log in logs),
        runs=[_learnt(curve) for curve in curves],
    )


def _learnt(curve: Curve) -> tuple[list[float], list[float]]:
    """Cost and success at the checkpoints after the start: a logarithmic axis has no 0."""
    later = curve.control_steps > 0
    return curve.control_steps[later].tolist(), curve.success[later].tolist()


def _logs(path: Path) -> list[Path]:
    """The logs or folders of single runs."""
    if not path.exists():
        raise ConfigError(f"join: there is no file or folder {path}")
    if path.is_dir() and not any(one.is_file() for one in path.iterdir()):
        return sorted(one for one in path.iterdir() if one.is_dir())
    return [path]


def joined_numbers(joined: Sequence[JoinedRuns], first: int) -> list[dict[str, Any]]:
    """The numbers of the runs that join a task.

    Args:
        joined: The runs.
        first: Series of the first, after those of the study's agents.
    """
    return [
        {
            "label": one.label,
            "title": one.label,
            "detail": f"joined, {len(one.runs)} {'run' if len(one.runs) == 1 else 'runs'}",
            "series": first + i,
            "names": list(one.names),
            "curve": {AXIS: curve_numbers(one.runs, one.names)},
            "budgets": {AXIS: budget_numbers(one.runs)},
        }
        for i, one in enumerate(joined)
    ]
