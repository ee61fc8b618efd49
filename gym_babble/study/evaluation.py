"""Outcomes of an agent's tests, as rates with intervals."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import gymnasium
import numpy as np

from gym_babble.agents.base import predictor
from gym_babble.agents.loading import named_agent
from gym_babble.errors import ConfigError
from gym_babble.progress import track
from gym_babble.study.scenarios import scenarios
from gym_babble.study.tasks import task_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from gym_babble.agents.base import Agent
    from gym_babble.config import ConfigLike
    from gym_babble.study.scenarios import GraspScenario, Scenario

__all__ = ["Evaluation", "evaluate", "wilson"]

ENVS = 250
"""Environments of a batch."""


@dataclass(frozen=True)
class Evaluation:
    """The results of an evaluation, case by case."""

    outcomes: tuple[str, ...]
    """Outcome of each case."""
    steps: tuple[int, ...]
    """Control steps of each case; 1 in `pattern` control."""
    returns: tuple[float, ...]
    """Sum of rewards of each case."""
    facts: dict[str, tuple[bool, ...]] = field(default_factory=dict)
    """Facts at the end of each case, with the names in `info`."""

    def count(self, outcome: str) -> int:
        """Number of cases with this outcome."""
        return Counter(self.outcomes)[outcome]

    def rate(self, outcome: str) -> float:
        """Share of cases with this outcome."""
        return self.count(outcome) / len(self.outcomes)

    def interval(self, outcome: str) -> tuple[float, float]:
        """95 % Wilson interval of the rate."""
        return wilson(self.count(outcome), len(self.outcomes))

    def __add__(self, other: Evaluation) -> Evaluation:
        """The cases of both, as one evaluation."""
        names = {**self.facts, **other.facts}
        return Evaluation(
            self.outcomes + other.outcomes,
            self.steps + other.steps,
            self.returns + other.returns,
            {name: self.facts.get(name, ()) + other.facts.get(name, ()) for name in names},
        )


def wilson(count: int, n: int, z: float = 1.959964) -> tuple[float, float]:
    """Wilson score interval of a rate, 95 % by default (Wilson 1927)."""
    if n == 0:
        return 0.0, 1.0
    p = count / n
    middle = (p + z * z / (2 * n)) / (1 + z * z / n)
    half = z / (1 + z * z / n) * math.sqrt(p * (1 - p) / n + z * z / (4 * n * n))
    # Rounding must not put the rate outside its interval, which could happen at 0 or 1.
    return max(0.0, min(p, middle - half)), min(1.0, max(p, middle + half))


def evaluate(
    agent: Agent | str,
    env_id: str = "BabbleReachPattern-v0",
    cases: Sequence[Scenario | GraspScenario] | None = None,
    *,
    config: ConfigLike = "paper",
    deterministic: bool = True,
    progress_bar: bool = False,
    **env_kwargs: Any,
) -> Evaluation:
    """Plays one episode of each case.

    Args:
        agent: Any object with stable-baselines3's `predict`, or with a `predict(observation)` that
            returns an action; or the name of one: "random", "scripted", "oracle", a file, or
            "module:Class".
        env_id: Id of the environment.
        cases: Cases from `scenarios`. By default 1,000 test cases of seed 0: of Table I for
            reaching, of the region "palm_side" for grasping.
        config: Body and task.
        deterministic: Passed to `predict`.
        progress_bar: Show a progress bar.
        env_kwargs: Further arguments of the environment.

    Raises:
        ConfigError: No cases, or an unknown or invalid argument.
        ScenarioError: A case that cannot be played with this config.
    """
    if cases is None:
        cases = scenarios(task_of(env_id).protocol, 1000, config=config)
    if isinstance(agent, str):
        loaded = named_agent(agent, env_id=env_id, config=config)
        agent, env_kwargs = loaded.agent, {**loaded.env_kwargs, **env_kwargs}
    if not cases:
        raise ConfigError("cases is empty: it must have at least one")
    groups = [cases[i : i + ENVS] for i in range(0, len(cases), ENVS)]
    result = Evaluation((), (), ())
    sizes = (len(group) for group in groups)
    for i, _ in enumerate(track(sizes, "evaluating", total=len(cases), show=progress_bar)):
        envs = gymnasium.make_vec(env_id, num_envs=len(groups[i]), config=config, **env_kwargs)
        result += _play(agent, envs, groups[i], deterministic=deterministic)
        envs.close()
    return result


def _play(
    agent: Agent, envs: Any, cases: Sequence[Scenario | GraspScenario], *, deterministic: bool
) -> Evaluation:
    """Plays one episode in each environment. Ended environments continue, but are ignored."""
    n = len(cases)
    predict = predictor(agent)
    observation, _ = envs.reset(seed=0, options={"scenario": list(cases)})
    state: Any = None
    starts = np.ones(n, np.bool_)
    running = np.ones(n, np.bool_)
    steps, returns = np.zeros(n, np.int64), np.zeros(n)
    outcomes = np.full(n, "running", object)
    names = envs.get_attr("interface")[0].spec.facts
    facts = {name: np.zeros(n, np.bool_) for name in names}
    while running.any():
        actions, state = predict(observation, state, starts, deterministic)
        observation, rewards, terminated, truncated, infos = envs.step(actions)
        ended = terminated | truncated
        steps[running] += 1
        returns[running] += rewards[running]
        ending = running & ended
        outcomes[ending] = infos["outcome"][ending]
        for name, values in facts.items():
            values[ending] = infos[name][ending]
        running &= ~ended
        # Ended environments restart at their next step; their later steps are ignored.
        starts = ended
    return Evaluation(
        tuple(outcomes),
        tuple(steps.tolist()),
        tuple(returns.tolist()),
        {name: tuple(held.tolist()) for name, held in facts.items()},
    )
