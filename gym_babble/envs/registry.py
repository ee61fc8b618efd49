"""The core's registry: tasks, environments, options, parts of a case, protocols."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import Any

from gym_babble import _core
from gym_babble.checks import check_choice, shown
from gym_babble.errors import ConfigError

__all__ = [
    "ENVIRONMENTS",
    "TASKS",
    "CasePart",
    "Environment",
    "Option",
    "Protocol",
    "TaskEntry",
    "environment",
    "task_entry",
]


@dataclass(frozen=True, kw_only=True)
class Option:
    """A keyword argument of a task's environments."""

    name: str
    kind: str
    """One of "choice", "flag", "whole", "number" and "numbers"."""
    default: Any
    """None where the task or the config decides."""
    doc: str
    values: tuple[str, ...] = ()
    """Names that a choice can have."""
    low: float | None = None
    high: float | None = None
    unit: str = ""

    @property
    def summary(self) -> str:
        """What it decides, with its values or bounds."""
        if self.kind == "choice":
            return f"{self.doc} One of {', '.join(self.values)}."
        if self.low is None:
            return self.doc
        return f"{self.doc} In [{self.low:g}, {self.high:g}]."


@dataclass(frozen=True, kw_only=True)
class CasePart:
    """A part of a case, as `reset(options=...)` takes it."""

    name: str
    lengths: tuple[int, ...]
    """How many numbers it can have; 0 stands for one plain number, and none for True or False."""
    unit: str
    doc: str


@dataclass(frozen=True, kw_only=True)
class Protocol:
    """Test cases by name."""

    name: str
    doc: str
    cases: str
    """What a table calls the cases."""
    presets: dict[str, Any]
    """Options that the task is made with."""
    random: bool
    """Whether cases are sampled by seed; else there is a fixed list."""
    outcomes: tuple[str, ...]
    """How an episode of such a case can end."""


@dataclass(frozen=True, kw_only=True)
class TaskEntry:
    """A task, and what its environments can be made with."""

    name: str
    title: str
    doc: str
    options: tuple[Option, ...]
    case_parts: tuple[CasePart, ...]
    protocols: dict[str, Protocol]
    """The first one is what results are reported on."""
    envs_per_thread: int
    """Minimum environments per thread for threads to pay off."""

    @property
    def defaults(self) -> dict[str, Any]:
        """The options' defaults by name."""
        return {option.name: option.default for option in self.options}


@dataclass(frozen=True, kw_only=True)
class Environment:
    """A registered environment: a task with some options preset."""

    id: str
    task: str
    options: dict[str, Any]
    """All options by name: the task's defaults, and what this environment presets."""
    max_episode_steps: int
    """Time limit in control steps."""
    reward_threshold: float | None
    """Mean return at which the task counts as solved."""
    presets: dict[str, Any] = field(default_factory=dict)
    """Options that differ from the task's defaults; `make` can override those not fixed."""
    fixed: tuple[str, ...] = ()
    """Options that decide the time limit: another value needs another id."""


def _read() -> tuple[dict[str, TaskEntry], tuple[Environment, ...]]:
    tasks: dict[str, TaskEntry] = {}
    environments: list[Environment] = []
    for raw in json.loads(_core.registry_json()):
        rows = raw.pop("environments")
        options = [
            Option(**{**option, "values": tuple(option.get("values", ()))})
            for option in raw.pop("options")
        ]
        parts = [
            CasePart(**{**part, "lengths": tuple(part["lengths"])})
            for part in raw.pop("case_parts")
        ]
        protocols = {
            one["name"]: Protocol(
                **{**one, "presets": dict(one["presets"]), "outcomes": tuple(one["outcomes"])}
            )
            for one in raw.pop("protocols")
        }
        task = TaskEntry(
            **raw, options=tuple(options), case_parts=tuple(parts), protocols=protocols
        )
        tasks[task.name] = task
        environments += [_environment(task, row) for row in rows]
    return tasks, tuple(environments)


def _environment(task: TaskEntry, row: dict[str, Any]) -> Environment:
    presets, fixed = dict(row.pop("presets")), tuple(row.pop("fixed"))
    options = task.defaults | presets
    return Environment(**row, task=task.name, options=options, presets=presets, fixed=fixed)


TASKS: dict[str, TaskEntry]
"""The tasks by name."""
ENVIRONMENTS: tuple[Environment, ...]
"""The registered environments, task by task."""
TASKS, ENVIRONMENTS = _read()


def task_entry(name: str) -> TaskEntry:
    """The task of that name.

    Raises:
        ConfigError: There is no such task.
    """
    return TASKS[check_choice("task", name, TASKS)]


def environment(env_id: str) -> Environment:
    """The registered environment of that id.

    Raises:
        ConfigError: There is no such environment.
    """
    for row in ENVIRONMENTS:
        if row.id == env_id:
            return row
    known = ", ".join(row.id for row in ENVIRONMENTS)
    raise ConfigError(f"{shown(env_id)} is not an environment; there are {known}")
