"""Observes and replays rules, agents and environments of the students' own, for lesson 8."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

import gymnasium as gym
import numpy as np
from gymnasium.spaces.utils import flatten

from gym_babble.agents import HebbBabbling, Random
from gym_babble.agents.base import predictor
from gym_babble.course.answers import UnansweredError, UnsuitableError, unanswered
from gym_babble.study.evaluation import evaluate
from gym_babble.study.outcomes import wilson
from gym_babble.study.scenarios import scenarios

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from gym_babble.study.scenarios import Scenario

    Floats = NDArray[np.float64]

__all__ = [
    "CASES",
    "EPISODES",
    "LEGAL",
    "movements_of_agents",
    "movements_of_rule",
    "played_at_random",
    "random_interval",
    "solved",
]

REACH = "BabbleReachPattern-v0"
CASES = 200
"""Held-out cases of Table I."""
CASE_SEED = 8_000
LEGAL = 300
"""Legal movements that a rule learns from."""
EPISODES = 20
"""Episodes in which an environment is tried."""
MOST_STEPS = 2_000
"""Steps after which an episode that does not end is given up."""


def held_out() -> list[Scenario]:
    """The cases."""
    return scenarios("table1", CASES, CASE_SEED)


def solved(actions: Floats) -> int:
    """How many of the cases these actions (CASES, 2) solve, played in the environment."""
    envs = gym.make_vec(REACH, CASES, threads=1)
    envs.reset(seed=0, options={"scenario": held_out()})
    _, _, _, _, infos = envs.step(actions.astype(np.float32))
    envs.close()
    return int(infos["is_success"].sum())


@cache
def random_interval() -> tuple[float, float]:
    """95 % interval of the success of random movements in the cases."""
    return evaluate(Random(REACH), cases=held_out(), threads=1).interval("success")


def interval(count: int) -> tuple[float, float]:
    """95 % interval of a share of the cases."""
    return wilson(count, CASES)


def movements_of_rule(rule: Any) -> dict[str, Floats]:
    """What agents choose that learnt by a rule: seeds 0 and 1, and seed 0 once more.

    Raises:
        UnansweredError: The rule returns `...`.
        UnsuitableError: It is no function.
    """
    if not callable(rule):
        raise UnsuitableError("Your answer is no function. Give its name without parentheses.")
    rng = np.random.default_rng(0)
    small = [rng.uniform(size=n).astype(np.float32) for n in (4, 4, 3, 3)]
    if unanswered(rule(*small, np.zeros((4, 3), np.float32), 1.0, 0.2)):
        raise UnansweredError

    def learnt(seed: int) -> HebbBabbling:
        return HebbBabbling(REACH, rule=rule, seed=seed, threads=1).learn(LEGAL)

    return movements_of_agents(learnt)


def movements_of_agents(make: Callable[[int], Any]) -> dict[str, Floats]:
    """What agents that are made from a seed choose: seeds 0 and 1, and seed 0 once more.

    Raises:
        UnansweredError: An agent is `...`, or acts so.
        UnsuitableError: `make` makes no agents.
    """
    if not callable(make):
        raise UnsuitableError(
            "Your answer is no class and no function that makes an agent from a seed: write "
            "`MyAgent`, not `MyAgent()`."
        )
    first, other, again = (_chosen(make(seed)) for seed in (0, 1, 0))
    return {"first": first, "other": other, "again": again}


def _chosen(agent: Any) -> Floats:
    """The actions (CASES, 2) of an agent in the cases."""
    if agent is ...:
        raise UnansweredError
    if not hasattr(agent, "predict"):
        raise UnsuitableError("What your answer makes has no method `predict`.")
    envs = gym.make_vec(REACH, CASES, threads=1)
    observation, _ = envs.reset(seed=0, options={"scenario": held_out()})
    envs.close()
    actions, _ = predictor(agent)(observation, None, np.ones(CASES, np.bool_), True)  # noqa: FBT003
    array = np.asarray(actions)
    if array.dtype == object and unanswered(array.ravel().tolist()):
        raise UnansweredError
    if array.shape != (CASES, 2):
        raise UnsuitableError(f"{CASES} actions have shape {array.shape}, expected ({CASES}, 2).")
    return array.astype(np.float32).astype(float)


def played_at_random(make: Any) -> dict[str, Any]:
    """Plays an environment of a student's own with seeded random actions, twice.

    Raises:
        UnansweredError: `make` returns `...`.
        UnsuitableError: It makes no environment, or one that keeps no promise of `gymnasium.Env`.
    """
    if not callable(make):
        raise UnsuitableError("Your answer is no function: give its name without parentheses.")
    env, twin = make(), make()
    if env is ...:
        raise UnansweredError
    if not isinstance(env, gym.Env):
        raise UnsuitableError("What your function returns is no `gymnasium.Env`.")
    if env is twin:
        raise UnsuitableError("Your function returns the same environment twice. Make a new one.")
    first, second = _episodes(env), _episodes(twin)
    return {
        "returns": first["returns"],
        "again": second["returns"],
        "steps": first["steps"],
        "ended": first["ended"],
        "as_before": float(_as_before(env, first)),
    }


def _episodes(env: gym.Env[Any, Any]) -> dict[str, Any]:
    """Sum of rewards, steps, whether it ended (1 or 0), and what is seen first, of each episode.

    Raises:
        UnsuitableError: What it shows is not in its observation space, or a reward is no number.
    """
    found: dict[str, Any] = {name: [] for name in ("returns", "steps", "ended", "seen")}
    for seed in range(EPISODES):
        env.action_space.seed(seed)
        seen, _ = env.reset(seed=seed)
        found["seen"].append(seen)
        total, steps, over = 0.0, 0, False
        while not over and steps < MOST_STEPS:
            _check_seen(env, seen, "reset" if steps == 0 else "step")
            seen, reward, terminated, truncated, _ = env.step(env.action_space.sample())
            total, steps, over = total + _checked_reward(reward), steps + 1, terminated or truncated
        for name, value in (("returns", total), ("steps", steps), ("ended", over)):
            found[name].append(float(value))
    return {**found, "seen": [flatten(env.observation_space, seen) for seen in found["seen"]]}


def _check_seen(env: gym.Env[Any, Any], seen: Any, where: str) -> None:
    if seen not in env.observation_space:
        raise UnsuitableError(f"What `{where}` shows is not in `observation_space`.")


def _checked_reward(reward: Any) -> float:
    try:
        number = float(reward)
    except (TypeError, ValueError) as error:
        raise UnsuitableError(f"The reward {reward!r} is no number.") from error
    if not np.isfinite(number):
        raise UnsuitableError(f"The reward is {number}.")
    return number


def _as_before(env: gym.Env[Any, Any], episodes: dict[str, Any]) -> bool:
    """Whether an environment shows and pays the same as the one that it was made from."""
    spec = env.unwrapped.spec
    if spec is None:
        return False
    plain = gym.make(spec.id)
    spaces = (env.observation_space, env.action_space)
    if spaces != (plain.observation_space, plain.action_space):
        return False
    before = _episodes(plain)
    return all(np.array_equal(before[name], episodes[name]) for name in ("returns", "seen"))
