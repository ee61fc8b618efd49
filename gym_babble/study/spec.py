"""A study as data: agents, tasks, seeds, budgets and cases, from a TOML or JSON file."""

from __future__ import annotations

import difflib
import json
import re
import sys
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gym_babble.checks import check_path, check_seed, check_text, check_whole, plain, shown
from gym_babble.config import config_json
from gym_babble.envs.registry import TASKS
from gym_babble.errors import ConfigError, StudyError
from gym_babble.study.scenarios import PROTOCOLS
from gym_babble.study.specs import SPECS

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping

__all__ = ["Study", "StudyAgent", "StudyTask", "read_study", "study_of"]

NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_+-]{0,63}")
MOST_SEEDS = 1_000
MOST_STEPS = 10**12


@dataclass(frozen=True, kw_only=True)
class StudyTask:
    """The cases that all agents of a task are tested on."""

    protocol: str
    """Protocol of the cases, for `scenarios`; it decides the task."""
    config: Any = "paper"
    """Body and task: a profile's name, or a whole config as JSON types."""
    cases: int = 1_000
    """Cases of the final test; a protocol that is a fixed list has all of its cases."""
    case_seed: int = 1_000
    """Seed of the cases. Nothing should have been chosen on them."""
    checkpoint_cases: int = 200
    """How many of these cases, the first ones, each checkpoint plays."""
    budget: int | None = None
    """Control steps that each agent learns from; each agent's own if not given."""

    @property
    def task(self) -> str:
        """The task, "reach" or "grasp"."""
        return PROTOCOLS[self.protocol]


@dataclass(frozen=True, kw_only=True)
class StudyAgent:
    """An agent of a study, and how it learns."""

    agent: str
    """Name in the roster, a file, or "module:Class"."""
    label: str
    """Name in tables and files; the agent's name unless given."""
    tasks: tuple[str, ...] = ()
    """Names of the study's tasks that it takes part in; all that it can do if empty."""
    seeds: tuple[int, ...] = ()
    """Its seeds; the study's if empty."""
    budget: int | None = None
    """Control steps that it learns from; the task's if not given."""
    env_id: str | None = None
    """Environment to learn and act in; the agent's own choice if not given."""
    options: dict[str, Any] = field(default_factory=dict)
    """Further options of the environment."""
    settings: dict[str, Any] = field(default_factory=dict)
    """Settings of the agent itself."""


@dataclass(frozen=True, kw_only=True)
class Study:
    """What a study runs."""

    name: str
    title: str
    tasks: dict[str, StudyTask]
    """The tasks by name."""
    agents: tuple[StudyAgent, ...]
    """The agents, in the order of tables."""
    seeds: tuple[int, ...]
    """Seeds of learning."""

    def to_json(self) -> dict[str, Any]:
        """The study as JSON types, which `study_of` reads."""
        return json.loads(json.dumps(asdict(self)))  # type: ignore[no-any-return]


def read_study(name: str | Path) -> Study:
    """The study of a TOML or JSON file, or one that comes with the package.

    Args:
        name: A path that ends in .toml or .json, or a name that `gym-babble study list` shows.

    Raises:
        FileNotFoundError: There is no such file.
        ConfigError: Neither such a name nor such a path.
        StudyError: The file is not a study; the error names file and field.
    """
    path = check_path("study", name)
    if path.suffix not in (".toml", ".json"):
        if str(name) not in SPECS:
            raise ConfigError(
                f"study = {shown(str(name))} is not one of {', '.join(SPECS)}, and not a file that "
                f"ends in .toml or .json{_near(str(name), SPECS)}"
            )
        path = SPECS[str(name)]
    try:
        text = path.read_text(encoding="utf-8")
        document = tomllib.loads(text) if path.suffix == ".toml" else json.loads(text)
    except ValueError as error:
        raise StudyError(f"{path}: {error}") from error
    try:
        return study_of(document, path.parent)
    except ConfigError as error:
        raise StudyError(f"{path}: {error}") from error


def study_of(document: Mapping[str, Any], folder: Path | None = None) -> Study:
    """A study from JSON types.

    Args:
        document: The fields of `Study`. `seeds` may be a number n, for 0 to n − 1; an agent may be
            its name alone.
        folder: Where relative paths of configs begin; the current folder if not given.

    Raises:
        ConfigError: A field is missing, unknown, of another kind or out of bounds.
    """
    found = plain(document, "")
    known = ("name", "title", "tasks", "agents", "seeds")
    _check_fields("", found, known, ("name", "tasks", "agents"))
    name = _name("name", found["name"])
    tasks = {
        _name("tasks", key): _task(f"tasks.{key}", value, folder or Path())
        for key, value in _table("tasks", found["tasks"]).items()
    }
    agents = tuple(
        _agent(f"agents[{i}]", value, tasks) for i, value in enumerate(_list("agents", found))
    )
    if not tasks or not agents:
        raise ConfigError("a study needs at least one of tasks and one of agents")
    labels = [agent.label for agent in agents]
    for i, label in enumerate(labels):
        if label in labels[:i]:
            raise ConfigError(f"agents[{i}].label = {label!r} is there twice: give it another one")
    return Study(
        name=name,
        title=check_text("title", found.get("title", name)),
        tasks=tasks,
        agents=agents,
        seeds=_seeds("seeds", found.get("seeds", 1)),
    )


def _task(path: str, value: Any, folder: Path) -> StudyTask:
    table = _table(path, value)
    _check_fields(path, table, _names(StudyTask), ("protocol",))
    if table["protocol"] not in PROTOCOLS:
        known = ", ".join(PROTOCOLS)
        raise ConfigError(f"{path}.protocol = {shown(table['protocol'])} is not one of {known}")
    protocol = TASKS[PROTOCOLS[table["protocol"]]].protocols[table["protocol"]]
    for name in ("cases", "case_seed"):
        if name in table and not protocol.random:
            raise ConfigError(f"{path}.{name}: {protocol.name!r} is one fixed list of cases")
    bounds = {"cases": 1_000_000, "checkpoint_cases": 1_000_000, "budget": MOST_STEPS}
    for name in bounds.keys() & table.keys():
        if table[name] is not None:
            check_whole(f"{path}.{name}", table[name], 1, bounds[name], name)
    try:
        check_seed(table.get("case_seed", 0))
        table["config"] = _config(table.get("config", "paper"), folder)
    except ConfigError as error:
        raise ConfigError(f"{path}: {error}") from error
    return StudyTask(**table)


def _config(config: Any, folder: Path) -> Any:
    """A profile's name as it is, and any other config whole: a store has no paths in it."""
    if isinstance(config, str) and not config.endswith((".toml", ".json")):
        config_json(config)
        return config
    return json.loads(config_json(folder / config if isinstance(config, str) else config))


def _agent(path: str, value: Any, tasks: Mapping[str, StudyTask]) -> StudyAgent:
    table: dict[str, Any] = {"agent": value} if isinstance(value, str) else _table(path, value)
    _check_fields(path, table, _names(StudyAgent), ("agent",))
    agent = check_text(f"{path}.agent", table["agent"])
    if not agent:
        raise ConfigError(f"{path}.agent is empty: it is a name, a file, or module:Class")
    table["label"] = _name(f"{path}.label", table.get("label") or _label(agent))
    if "seeds" in table:
        table["seeds"] = _seeds(f"{path}.seeds", table["seeds"]) if table["seeds"] else ()
    if table.get("budget") is not None:
        check_whole(f"{path}.budget", table["budget"], 1, MOST_STEPS, "control steps")
    if table.get("env_id") is not None:
        check_text(f"{path}.env_id", table["env_id"])
    for name in ("options", "settings"):
        _table(f"{path}.{name}", table.get(name, {}))
    table["tasks"] = tuple(_list("tasks", table)) if "tasks" in table else ()
    for name in table["tasks"]:
        if name not in tasks:
            raise ConfigError(
                f"{path}.tasks: {shown(name)} is not one of {', '.join(tasks)}{_near(name, tasks)}"
            )
    return StudyAgent(**table)


def _label(agent: str) -> str:
    """A label from an agent's name: of a file its stem, of "module:Class" the class."""
    last = re.split(r"[/\\:]", agent)[-1]
    return re.sub(r"[^A-Za-z0-9_+-]", "-", last.rpartition(".")[0] or last)


def _seeds(path: str, value: Any) -> tuple[int, ...]:
    if isinstance(value, list):
        seeds = tuple(check_seed(seed) for seed in value)
        if not seeds or len(set(seeds)) < len(seeds) or len(seeds) > MOST_SEEDS:
            raise ConfigError(f"{path} = {shown(value)}: 1 to {MOST_SEEDS} seeds, each once")
        return seeds
    return tuple(range(check_whole(path, value, 1, MOST_SEEDS, "seeds")))


def _name(path: str, value: Any) -> str:
    if not isinstance(value, str) or not NAME.fullmatch(value):
        raise ConfigError(
            f"{path} = {shown(value)} is not a name of up to 64 letters, digits, -, _ and +"
        )
    return value


def _table(path: str, value: Any) -> dict[str, Any]:
    if not isinstance(value, dict):
        raise ConfigError(f"{path} = {shown(value)} is not a table")
    return value


def _list(name: str, table: Mapping[str, Any]) -> list[Any]:
    found = table[name]
    if not isinstance(found, list):
        raise ConfigError(f"{name} = {shown(found)} is not a list")
    return found


def _names(kind: type) -> list[str]:
    return [one.name for one in fields(kind)]


def _check_fields(
    path: str, table: Mapping[str, Any], known: Collection[str], needed: Collection[str]
) -> None:
    at = f"{path}." if path else ""
    for name in table:
        if name not in known:
            raise ConfigError(
                f"{at}{name}: unknown field; there are {', '.join(known)}{_near(name, known)}"
            )
    for name in needed:
        if name not in table:
            raise ConfigError(f"{at}{name} is missing")


def _near(name: Any, known: Collection[str]) -> str:
    """A question after the one known name that is most like a name."""
    found = difflib.get_close_matches(str(name), known, 1)
    return f"; did you mean {found[0]!r}?" if found else ""
