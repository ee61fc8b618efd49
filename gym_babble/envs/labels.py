"""What a case says of itself, compared with the environment that shall play it."""

from __future__ import annotations

import hashlib
import json
from typing import TYPE_CHECKING, Any

from gym_babble import _core
from gym_babble.config import config_json
from gym_babble.envs.registry import ENVIRONMENTS, TASKS
from gym_babble.errors import ScenarioError

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = ["SCENARIO_LABELS", "check_labels", "config_label"]

SCENARIO_LABELS = ("protocol", "index", "config")
"""Parts of a scenario that say where it is from."""


def config_label(task: _core.Task, name: str) -> str:
    """A name for the config of the task of that name: its profile, with a hash if it differs.

    The diameters that are sampled do not count, as a case says its own.
    """
    found = task.config()
    profile = str(json.loads(found)["profile"])
    usual = _core.Task(name, config_json(profile), "{}").config()
    if found == usual or _without_sizes(found) == _without_sizes(usual):
        return profile
    return f"{profile}, changed ({hashlib.sha256(found.encode()).hexdigest()[:8]})"


def _without_sizes(config: str) -> Any:
    """A config as JSON types, without the diameters that are sampled."""
    found = json.loads(config)
    for name in ("diameters_m", "any_diameter_between"):
        del found["grasp"][name]
    return found


def check_labels(
    scenario: Mapping[str, Any], task: str, options: Mapping[str, Any], label: str
) -> None:
    """Raises `ScenarioError` for a case of another task, config or environment.

    A case without labels, of your own, passes.

    Args:
        scenario: The case.
        task: The environment's task.
        options: The environment's options.
        label: Its `config_label`.
    """
    name = str(scenario.get("protocol"))
    owners = [entry for entry in TASKS.values() if name in entry.protocols]
    if owners and task not in {entry.name for entry in owners}:
        raise ScenarioError(
            f"scenario: a case of {name!r} is one of {owners[0].title}, and this environment is "
            f"for {TASKS[task].title}"
        )
    if owners:
        presets = TASKS[task].protocols[name].presets
        differing = {key: value for key, value in presets.items() if options[key] != value}
        if differing:
            raise ScenarioError(_elsewhere(name, task, differing, options))
    theirs = scenario.get("config")
    if theirs is not None and theirs != label:
        raise ScenarioError(
            f"scenario: the case is of config {theirs!r}, and this environment has {label!r}: "
            "give both the same config"
        )


def _elsewhere(
    protocol: str, task: str, differing: Mapping[str, Any], options: Mapping[str, Any]
) -> str:
    """Says which environment a case of a protocol is for."""
    ids = [
        row.id
        for row in ENVIRONMENTS
        if row.task == task and all(row.options[key] == value for key, value in differing.items())
    ]
    named = ", ".join(f"{key}={value!r}" for key, value in differing.items())
    here = ", ".join(f"{key}={options[key]!r}" for key in differing)
    where = f"{ids[0]} ({named})" if ids else named
    return f"scenario: a case of {protocol!r} is for {where}, and this environment has {here}"
