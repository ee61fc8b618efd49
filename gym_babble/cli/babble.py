"""`gym-babble babble`."""

from pathlib import Path
from typing import Annotated, Any

import typer

from gym_babble.cli.arguments import (
    AsJson,
    Babbles,
    ConfigName,
    Movements,
    QuasiStatic,
    Seed,
    TaskName,
    Variant,
)
from gym_babble.cli.learning import learn_grasping, learn_reaching
from gym_babble.cli.output import print_json, print_results
from gym_babble.files import check_file
from gym_babble.study.rates import share
from gym_babble.study.tasks import TASKS

__all__ = ["babble"]


def babble(
    *,
    file: Annotated[Path, typer.Option("--out", help="File for the agent.")],
    task: TaskName = "reach",
    variant: Variant = "paper",
    movements: Movements = 20_000,
    babbles: Babbles = 1_000,
    seed: Seed = 0,
    config: ConfigName = "paper",
    quasi_static: QuasiStatic = False,
    as_json: AsJson = False,
) -> None:
    """Let an agent babble and learn, and save it."""
    check_file(file, "--out")
    settings: dict[str, Any] = {"variant": variant, "config": config, "seed": seed}
    if task == "reach":
        agent = learn_reaching(variant, movements, seed, config, quasi_static=quasi_static)
        settings["quasi_static"] = quasi_static
    else:
        agent = learn_grasping(babbles, seed, config, variant=variant)
    trials, accepted = agent.babbled, agent.learnt
    names, rate = TASKS[task], accepted / trials
    if as_json:
        counts = {names.trials: trials, f"{names.accepted}_{names.trials}": accepted}
        print_json({"file": str(file), **settings, **counts, f"{names.accepted}_rate": rate})
    else:
        shares = f"{accepted:,} of them {names.accepted} ({share(rate)})"
        print_results(f"{trials:,} {names.trials}, {shares}: {file}")
    agent.save(file)
