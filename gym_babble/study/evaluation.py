"""Plays an agent's tests."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from itertools import groupby
from typing import TYPE_CHECKING, Any

import numpy as np
from gymnasium.vector import AutoresetMode

from gym_babble.agents.base import predictor
from gym_babble.agents.loading import acting_agent
from gym_babble.envs.registry import task_entry
from gym_babble.errors import ConfigError, ScenarioError
from gym_babble.progress import track
from gym_babble.study.outcomes import Evaluation, joined
from gym_babble.study.scenarios import scenarios

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from gym_babble.agents.acting import EnvArguments
    from gym_babble.agents.base import Agent
    from gym_babble.agents.loading import LoadedAgent
    from gym_babble.config import ConfigLike
    from gym_babble.envs import BabbleVectorEnv
    from gym_babble.envs.registry import Protocol
    from gym_babble.study.scenarios import GraspScenario, Scenario

__all__ = [
    "default_cases",
    "default_protocol",
    "evaluate",
    "for_cases",
    "needs_goals",
    "play_cases",
]

ENVS = 250
"""Environments of a batch."""


def evaluate(
    agent: Agent | str,
    env_id: str | None = None,
    cases: Sequence[Scenario | GraspScenario] | None = None,
    *,
    config: ConfigLike | None = None,
    deterministic: bool = True,
    progress_bar: bool = False,
    threads: int | None = None,
    autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
    **options: Any,
) -> Evaluation:
    """Plays one episode of each case, in the environment that the agent acts in.

    Our agents and models of stable-baselines3 with an environment say themselves where they act:
    id, config and control. What is given here may choose rewards, observations and time limit; if
    it contradicts the agent, it is an error.

    Args:
        agent: Any object with stable-baselines3's `predict`, or with a `predict(observation)` that
            returns an action; or the name of one: "random", "scripted", "oracle", a file, or
            "module:Class".
        env_id: Id of the environment; needed if the agent has neither `interface` nor `env`.
        cases: Cases from `scenarios`; those of a region are played in it, with its time limit. By
            default 1,000 test cases of seed 0: of Table I for reaching, of the environment's region
            for grasping.
        config: Body and task; the agent's if not given.
        deterministic: Passed to `predict`.
        progress_bar: Show a progress bar.
        threads: Threads that step the environments; results do not depend on it.
        autoreset_mode: Of the batch that plays the cases; results do not depend on it.
        options: Further options of the environment.

    Raises:
        ConfigError: No cases, an unknown or invalid argument, an agent that does not say where it
            acts, or an environment that contradicts it.
        ScenarioError: Cases of another task or config, or one that cannot be played.
    """
    loaded = acting_agent(agent, env_id, config, options)
    return play_cases(
        loaded,
        cases,
        options,
        deterministic=deterministic,
        progress_bar=progress_bar,
        threads=threads,
        autoreset_mode=autoreset_mode,
    )


def play_cases(
    loaded: LoadedAgent,
    cases: Sequence[Scenario | GraspScenario] | None,
    given: Mapping[str, Any],
    *,
    deterministic: bool = True,
    progress_bar: bool = False,
    threads: int | None = None,
    autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
) -> Evaluation:
    """`evaluate` for an agent whose environment is known.

    Args:
        loaded: The agent and its environment.
        cases: As for `evaluate`.
        given: Options that the caller chose; what the cases preset replaces none of them.
        deterministic: As for `evaluate`.
        progress_bar: As for `evaluate`.
        threads: As for `evaluate`.
        autoreset_mode: As for `evaluate`.
    """
    if cases is None:
        cases = default_cases(loaded.arguments)
    cases = list(cases)
    if not cases:
        raise ConfigError("cases is empty: it must have at least one")
    for i, case in enumerate(cases):
        if not isinstance(case, Mapping):
            raise ScenarioError(f"cases[{i}] is a {type(case).__name__}, expected a Scenario")
    groups = list(_groups(cases))
    parts = []
    sizes = (len(group) for group in groups)
    for i, _ in enumerate(track(sizes, "evaluating", total=len(cases), show=progress_bar)):
        arguments = for_cases(loaded.arguments, groups[i], given)
        envs = arguments.batch(len(groups[i]), threads=threads, autoreset_mode=autoreset_mode)
        parts.append(_play(loaded.agent, envs, groups[i], deterministic=deterministic))
        envs.close()
    return joined(parts)


def default_cases(
    arguments: EnvArguments, n: int = 1_000, seed: int = 0, split: str = "test"
) -> list[Any]:
    """The cases that results in an environment are reported on."""
    goal = needs_goals(arguments)
    protocol = default_protocol(arguments).name
    return scenarios(protocol, n, seed, split=split, config=arguments.config, goal=goal)


def default_protocol(arguments: EnvArguments) -> Protocol:
    """The protocol of the cases that results in an environment are reported on."""
    return next(
        one
        for one in task_entry(arguments.task).protocols.values()
        if all(arguments.option(name) == value for name, value in one.presets.items())
    )


def needs_goals(arguments: EnvArguments) -> bool:
    """Whether a case has a goal of its own, in the goal form."""
    parts = {part.name for part in task_entry(arguments.task).case_parts}
    return arguments.option("obs") == "goal" and "goal" in parts


def _groups(cases: Sequence[Any]) -> Iterator[Sequence[Any]]:
    """Batches of cases of one protocol each."""
    for _, same in groupby(cases, lambda case: case.get("protocol")):
        of_protocol = list(same)
        for i in range(0, len(of_protocol), ENVS):
            yield of_protocol[i : i + ENVS]


def for_cases(
    arguments: EnvArguments, cases: Sequence[Any], given: Mapping[str, Any]
) -> EnvArguments:
    """The environment with what the cases' protocol presets, unless the caller gave it.

    Raises:
        ConfigError: The goal form, and cases without goals.
    """
    if needs_goals(arguments) and any("goal" not in case for case in cases):
        raise ConfigError(
            f"{arguments.title} needs cases with goals: scenarios(protocol, ..., goal=True)"
        )
    protocol = task_entry(arguments.task).protocols.get(cases[0].get("protocol", ""))
    presets = {} if protocol is None else protocol.presets
    presets = {name: v for name, v in presets.items() if name not in given}
    changed = {name: v for name, v in presets.items() if arguments.option(name) != v}
    options = arguments.options
    if changed and "max_episode_steps" not in given:  # Another region has another time limit.
        options = {name: v for name, v in options.items() if name != "max_episode_steps"}
    return replace(arguments, options={**options, **changed})


def _play(
    agent: Agent, envs: BabbleVectorEnv, cases: Sequence[Any], *, deterministic: bool
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
    spec, mode = envs.interface.spec, envs.metadata["autoreset_mode"]
    facts = {name: np.zeros(n, np.bool_) for name in spec.facts}
    while running.any():
        actions, state = predict(observation, state, starts, deterministic)
        observation, rewards, terminated, truncated, infos = envs.step(actions)
        ended = terminated | truncated
        steps[running] += 1
        returns[running] += rewards[running]
        ending = running & ended
        last = infos.get("final_info", infos)  # Restarted already, in mode SameStep.
        if ending.any():
            for name in spec.outcomes:
                outcomes[ending & last["outcome"][name]] = name
            for name, values in facts.items():
                values[ending] = last[name][ending]
        running &= ~ended
        if mode is AutoresetMode.DISABLED and ended.any():
            observation, _ = envs.reset(options={"reset_mask": ended})
        # Ended environments restart; their later steps are ignored.
        starts = ended
    return Evaluation(
        tuple(cases),
        tuple(outcomes),
        tuple(steps.tolist()),
        tuple(returns.tolist()),
        {name: tuple(held.tolist()) for name, held in facts.items()},
        tuple(name for name in spec.outcomes if name != "running"),
    )
