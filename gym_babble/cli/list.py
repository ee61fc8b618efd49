"""`gym-babble list`."""

from typing import Any

from gym_babble.cli.arguments import AsJson
from gym_babble.cli.output import print_json, print_results
from gym_babble.envs.registry import ENVIRONMENTS, Environment
from gym_babble.study.tables import plain_table

__all__ = ["described", "list_environments"]


def list_environments(as_json: AsJson = False) -> None:
    """List the environments."""
    listed = [described(row) for row in ENVIRONMENTS]
    if as_json:
        print_json(listed)
        return
    table = plain_table(None, ["id", "obs", "control", "reward", "steps", "solved at"], left=4)
    for found in listed:
        threshold = found["reward_threshold"]
        cells = (str(found[name]) for name in ("id", "obs", "control", "reward"))
        steps = str(found["max_episode_steps"])
        table.add_row(*cells, steps, "" if threshold is None else f"{threshold:g}")
    print_results(table)


def described(row: Environment) -> dict[str, Any]:
    """An id, its task, and the options that ids differ in."""
    options = {name: row.options.get(name, "") for name in ("obs", "control", "reward")}
    return {
        "id": row.id,
        "task": row.task,
        **options,
        "max_episode_steps": row.max_episode_steps,
        "reward_threshold": row.reward_threshold,
    }
