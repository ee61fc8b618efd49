"""Arguments that several commands share."""

from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any

import typer

from gym_babble.agents.hebb import VARIANTS
from gym_babble.study.tasks import TASKS

__all__ = [
    "AgentName",
    "AsJson",
    "Babbles",
    "Cases",
    "ConfigName",
    "ControlName",
    "EnvId",
    "FirstSeed",
    "Movements",
    "OwnConfig",
    "Picture",
    "QuasiStatic",
    "Seed",
    "Seeds",
    "TaskName",
    "Variant",
    "VecNormalizeFile",
    "given_options",
    "one_of",
]


def one_of(values: Iterable[str]) -> Any:
    """Typer's metavar and callback of an option with these values."""
    known = tuple(values)

    def check(value: str) -> str:
        if value not in known:
            raise typer.BadParameter(f"{value!r} is not one of {', '.join(known)}.")
        return value

    return {"metavar": f"<{'|'.join(known)}>", "callback": check}


AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON document to stdout.")]
TaskName = Annotated[str, typer.Option(help="Task.", **one_of(TASKS))]
ConfigName = Annotated[str, typer.Option(help="paper, icub, or a TOML or JSON file.")]
Seed = Annotated[int, typer.Option(min=0, help="Seed.")]
FirstSeed = Annotated[int, typer.Option("--seed", min=0, help="First seed.")]
Seeds = Annotated[int, typer.Option(min=1, help="Number of seeds: --seed, --seed + 1, ...")]
Cases = Annotated[int, typer.Option(min=1, help="Tests for each seed.")]
Movements = Annotated[int, typer.Option(min=1, help="Legal movements to learn from (reaching).")]
Babbles = Annotated[int, typer.Option(min=1, help="Babbles to learn from (grasping).")]
Variant = Annotated[str, typer.Option(help="Variant of the agent.", **one_of(VARIANTS))]
QuasiStatic = Annotated[
    bool, typer.Option("--quasi-static", help="Babble without the muscles' lag: faster (reaching).")
]
EnvId = Annotated[
    str | None,
    typer.Option(
        help="Environment of the test. Default: the agent's own; BabbleReachPattern-v0 for agents "
        "by name and for a file of an agent that babbled reaching. Needed for module:Class without "
        "`env`, and for a zip that train_tuned did not make."
    ),
]
ControlName = Annotated[
    str | None,
    typer.Option(
        help="Control of the test. Default: the environment's. A zip needs it as it needs --env-id."
    ),
]
OwnConfig = Annotated[
    str | None,
    typer.Option(
        help="paper, icub, or a file. Default: the config that the agent learnt with, else paper."
    ),
]
VecNormalizeFile = Annotated[
    Path | None,
    typer.Option(
        help="For a zip: the statistics that VecNormalize.save wrote (pickled Python too)."
    ),
]


def given_options(**options: Any) -> dict[str, Any]:
    """The options that are given."""
    return {name: value for name, value in options.items() if value is not None}


AgentName = Annotated[
    str,
    typer.Argument(
        help="random, scripted, oracle; a file written by `babble` (./random if it is called like "
        "an agent); module:Class, an agent of your own; or a zip of stable-baselines3 (which "
        "contains pickled Python: use only files you trust)."
    ),
]
Picture = Annotated[Path, typer.Option("--out", help="Picture: png, svg or pdf.")]
