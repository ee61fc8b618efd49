"""`gym-babble doctor`: what is installed, whether the core computes correctly, and how fast."""

import platform
from time import perf_counter
from typing import Any

import gymnasium
import typer
from rich.table import Table
from rich.text import Text

from gym_babble._core import debug_build
from gym_babble.checks import processors
from gym_babble.cli.arguments import AsJson
from gym_babble.cli.output import print_json, print_results
from gym_babble.config import Config
from gym_babble.envs import BabbleGraspVectorEnv
from gym_babble.study.tables import plain_table
from gym_babble.study.versions import EXTRAS, physics_hash, versions

__all__ = ["PHYSICS_HASH", "doctor", "examine"]

GRASP_STEPS = 20
"""Steps of each random grasp."""
PHYSICS_HASH = "2d23f3116fbd06e4"
"""The value of `physics_hash()` on every platform."""


def doctor(as_json: AsJson = False) -> None:
    """Check what is installed, that the core computes correctly, and how fast it is."""
    found = examine()
    if as_json:
        print_json(found)
    else:
        print_results(_table(found))
    if not found["same_bits"]:
        raise typer.Exit(1)


def examine() -> dict[str, Any]:
    """All findings, as JSON types."""
    found = versions()
    found_hash = physics_hash()
    return {
        "versions": found,
        "extras": {
            extra: all(found[name] is not None for name in names) for extra, names in EXTRAS.items()
        },
        "build": "debug" if debug_build else "release",
        "platform": f"{platform.system()} {platform.machine()}",
        "threads": processors(),
        "physics_hash": found_hash,
        "physics_hash_expected": PHYSICS_HASH,
        "same_bits": found_hash == PHYSICS_HASH,
        "unconverged_steps": _unconverged(),
        "step_us": _time_single(),
        "step_in_batch_of_64_us": _time_batch(),
    }


def _unconverged() -> int:
    """Physics steps in which the solver of contacts did not converge, in 64 random grasps."""
    envs = BabbleGraspVectorEnv(64, control="posture", enclosure_reflex=True)
    envs.action_space.seed(0)
    envs.reset(seed=0)
    for _ in range(GRASP_STEPS):
        envs.step(envs.action_space.sample())
    envs.close()
    return envs.interface.unconverged_steps or 0


def _time_single(steps: int = 4_000) -> float:
    """Clock time of a step with `gymnasium.make`, resets included [µs]."""
    env = gymnasium.make("BabbleReach-v0")
    env.action_space.seed(0)
    actions = [env.action_space.sample() for _ in range(16)]
    env.reset(seed=0)
    began = perf_counter()
    for step in range(steps):
        _, _, terminated, truncated, _ = env.step(actions[step % 16])
        if terminated or truncated:
            env.reset()
    return 1e6 * (perf_counter() - began) / steps


def _time_batch(steps: int = 400, num_envs: int = 64) -> float:
    """Clock time of a step for each environment of a batch of `gymnasium.make_vec` [µs]."""
    envs = gymnasium.make_vec("BabbleReach-v0", num_envs=num_envs)
    envs.action_space.seed(0)
    actions = [envs.action_space.sample() for _ in range(16)]
    envs.reset(seed=0)
    began = perf_counter()
    for step in range(steps):
        envs.step(actions[step % 16])
    seconds = perf_counter() - began
    envs.close()
    return 1e6 * seconds / (steps * num_envs)


def _table(found: dict[str, Any]) -> Table:
    """The findings of `examine` as a table."""
    table = plain_table(None, ["what", "found"], left=2)
    for name, version in found["versions"].items():
        table.add_row(name, version or Text("not installed", "dim"))
    for extra, installed in found["extras"].items():
        table.add_row(
            f"extra {extra}", "yes" if installed else f"no: pip install 'gym-babble[{extra}]'"
        )
    for name in ("platform", "build", "threads"):
        table.add_row(name, str(found[name]))
    state = found["physics_hash"]
    verdict = Text(f"{state}: correct")
    if not found["same_bits"]:
        expected = found["physics_hash_expected"]
        verdict = Text(f"{state}, expected {expected}: run `make setup` to rebuild", "red")
    table.add_row("state after 20 steps of seed 0", verdict)
    physics = f"{64 * GRASP_STEPS * Config().grasp.physics_steps:,} physics steps of grasping"
    table.add_row("contacts not solved", f"{found['unconverged_steps']} of {physics}")
    table.add_row("a step with gymnasium.make", f"{found['step_us']:.1f} µs")
    table.add_row("a step in a batch of 64", f"{found['step_in_batch_of_64_us']:.1f} µs")
    return table
