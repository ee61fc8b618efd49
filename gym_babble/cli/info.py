"""`gym-babble info`."""

from collections.abc import Sequence
from dataclasses import asdict
from typing import Annotated, Any

import gymnasium
import typer
from rich.table import Table

from gym_babble.cli.arguments import AsJson, ConfigName
from gym_babble.cli.list import described
from gym_babble.cli.output import print_json, print_results
from gym_babble.envs import registry
from gym_babble.study.tables import plain_table

__all__ = ["info"]


def info(
    env_id: Annotated[str, typer.Argument(metavar="ID", help="An id from `list`.")],
    config: ConfigName = "paper",
    as_json: AsJson = False,
) -> None:
    """Show an environment: limits, senses, action, options, parts of a case, protocols."""
    row = registry.environment(env_id)
    task = registry.TASKS[row.task]
    env: Any = gymnasium.make(env_id, config=config)
    spec = env.unwrapped.interface.spec
    goals = list(spec.goals) if row.options["obs"] == "goal" else []
    shown = {
        **described(row),
        "observation_space": str(env.observation_space),
        "action_space": str(env.action_space),
        "senses": [asdict(entry) for entry in (*spec.senses, *goals)],
        "action": asdict(spec.action),
        "reward_terms": spec.reward_terms,
        "outcomes": spec.outcomes,
        "facts": spec.facts,
        "measures": [asdict(measure) for measure in spec.measures],
        "control_hz": spec.control_hz,
        "options": [asdict(option) for option in task.options],
        "case_parts": [asdict(part) for part in task.case_parts],
        "protocols": [asdict(protocol) for protocol in task.protocols.values()],
    }
    if as_json:
        print_json(shown)
    else:
        print_results(*_tables(shown), *_registry_tables(task))


def _tables(described: dict[str, Any]) -> list[Table]:
    """Limits of an environment, its senses, and its action."""
    facts = plain_table(described["id"], ["", ""], left=2)
    facts.show_header = False
    for name in ("obs", "control", "reward", "max_episode_steps", "control_hz", "reward_threshold"):
        facts.add_row(name, str(described[name]))
    for name in ("reward_terms", "outcomes"):
        facts.add_row(name, ", ".join(described[name]))
    senses, action = described["senses"], [described["action"]]
    tables = [facts, _entries_table("senses", senses), _entries_table("action", action)]
    if described["measures"]:
        heads = ["name", "parts", "unit", "meaning"]
        measures = plain_table("\nnumbers in info", heads, left=len(heads))
        for one in described["measures"]:
            parts = ", ".join(one["labels"])
            measures.add_row(one["name"], parts, one["unit"], one["description"])
        tables.append(measures)
    return tables


def _registry_tables(task: registry.TaskEntry) -> list[Table]:
    """Options, parts of a case, and protocols of a task."""
    options = plain_table("\noptions of make", ["name", "default", "meaning"], left=3)
    for option in task.options:
        default = "" if option.default is None else str(option.default)
        options.add_row(option.name, default, option.summary)
    parts = plain_table("\noptions of reset: parts of a case", ["name", "unit", "meaning"], left=3)
    for part in task.case_parts:
        parts.add_row(part.name, part.unit, part.doc)
    protocols = plain_table("\nprotocols: test cases", ["name", "meaning"], left=2)
    for protocol in task.protocols.values():
        protocols.add_row(protocol.name, protocol.doc)
    return [options, parts, protocols]


def _entries_table(title: str, entries: Sequence[dict[str, Any]]) -> Table:
    heads = ["name", "parts", "low", "high", "unit", "meaning"]
    table = plain_table(f"\n{title}", heads, left=len(heads))
    for entry in entries:
        table.add_row(entry["name"], *_parts(entry), entry["unit"], entry["description"])
    return table


def _parts(entry: dict[str, Any]) -> tuple[str, ...]:
    """Labels and bounds of an entry. The parts of a map are identical: one row counts them."""
    n = len(entry["labels"])
    rows = list(zip(entry["labels"], entry["low"], entry["high"], strict=True))
    if len(set(rows)) == 1 < n:
        rows = [(f"{n} {rows[0][0]}", *rows[0][1:])]
    labels, lows, highs = zip(*rows, strict=True)
    return "\n".join(labels), *("\n".join(f"{x:.4g}" for x in ends) for ends in (lows, highs))
