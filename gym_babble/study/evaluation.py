"""Outcomes of an agent's tests, as rates with intervals."""

from __future__ import annotations

import difflib
import math
from dataclasses import dataclass, field
from itertools import chain, compress
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
    from collections.abc import Mapping, Sequence

    from gym_babble.agents.base import Agent
    from gym_babble.config import ConfigLike
    from gym_babble.study.scenarios import GraspScenario, Scenario

__all__ = ["Evaluation", "evaluate", "wilson"]

ENVS = 250
"""Environments of a batch."""

MANY_SIZES = 5
"""More sizes than these are split in two halves."""


@dataclass(frozen=True)
class Evaluation:
    """The results of an evaluation, case by case."""

    cases: tuple[Mapping[str, Any], ...]
    """The cases."""
    outcomes: tuple[str, ...]
    """Outcome of each case."""
    steps: tuple[int, ...]
    """Control steps of each case; 1 in `pattern` control."""
    returns: tuple[float, ...]
    """Sum of rewards of each case."""
    facts: dict[str, tuple[bool, ...]] = field(default_factory=dict)
    """Facts at the end of each case, with the names in `info`."""
    possible: tuple[str, ...] = ()
    """All outcomes that an episode can have."""

    def __len__(self) -> int:
        """Number of cases."""
        return len(self.outcomes)

    def count(self, name: str) -> int:
        """Number of cases with this outcome, or in which this fact is true.

        Raises:
            ConfigError: There is no such outcome or fact.
        """
        if name in self.facts:
            return sum(self.facts[name])
        if name in self.possible:
            return self.outcomes.count(name)
        known = (*self.possible, *self.facts)
        near = difflib.get_close_matches(str(name), known, 1)
        meant = f"; did you mean {near[0]!r}?" if near else ""
        raise ConfigError(f"{name!r} is not one of {', '.join(known)}{meant}")

    def rate(self, name: str) -> float:
        """Share of cases with this outcome, or in which this fact is true.

        Raises:
            ConfigError: There is no such outcome or fact.
        """
        return self.count(name) / len(self)

    def interval(self, name: str) -> tuple[float, float]:
        """95 % Wilson interval of the rate: what these cases say about all such cases.

        It says nothing about other seeds of learning.

        Raises:
            ConfigError: There is no such outcome or fact.
        """
        return wilson(self.count(name), len(self))

    def by_size(self) -> dict[str, Evaluation]:
        """The cases of each size of the object, small ones first; empty if all have one size.

        More than five sizes make two halves. In reaching there are no sizes.
        """
        sizes = np.array([case.get("diameter", 0.0) for case in self.cases])
        each = np.unique(sizes).tolist()
        if len(each) < 2:
            return {}
        if len(each) <= MANY_SIZES:
            return {f"{100 * size:g} cm": self._where(sizes == size) for size in each}
        low, middle, high = each[0], (each[0] + each[-1]) / 2, each[-1]
        return {
            f"{100 * low:.2g}–{100 * middle:.2g} cm": self._where(sizes <= middle),
            f"{100 * middle:.2g}–{100 * high:.2g} cm": self._where(sizes > middle),
        }

    def _where(self, chosen: Sequence[bool]) -> Evaluation:
        """Some of the cases."""
        return Evaluation(
            cases=tuple(compress(self.cases, chosen)),
            outcomes=tuple(compress(self.outcomes, chosen)),
            steps=tuple(compress(self.steps, chosen)),
            returns=tuple(compress(self.returns, chosen)),
            facts={name: tuple(compress(held, chosen)) for name, held in self.facts.items()},
            possible=self.possible,
        )


def _joined(parts: Sequence[Evaluation]) -> Evaluation:
    """The cases of one test, played in parts."""
    chained = chain.from_iterable
    return Evaluation(
        cases=tuple(chained(part.cases for part in parts)),
        outcomes=tuple(chained(part.outcomes for part in parts)),
        steps=tuple(chained(part.steps for part in parts)),
        returns=tuple(chained(part.returns for part in parts)),
        facts={name: tuple(chained(part.facts[name] for part in parts)) for name in parts[0].facts},
        possible=parts[0].possible,
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
    parts = []
    sizes = (len(group) for group in groups)
    for i, _ in enumerate(track(sizes, "evaluating", total=len(cases), show=progress_bar)):
        envs = gymnasium.make_vec(env_id, num_envs=len(groups[i]), config=config, **env_kwargs)
        parts.append(_play(agent, envs, groups[i], deterministic=deterministic))
        envs.close()
    return _joined(parts)


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
    spec = envs.get_attr("interface")[0].spec
    facts = {name: np.zeros(n, np.bool_) for name in spec.facts}
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
        tuple(cases),
        tuple(outcomes),
        tuple(steps.tolist()),
        tuple(returns.tolist()),
        {name: tuple(held.tolist()) for name, held in facts.items()},
        tuple(name for name in spec.outcomes if name != "running"),
    )
