"""Agents that play the same case, for a film."""

from __future__ import annotations

from copy import copy
from typing import TYPE_CHECKING, Any

from gym_babble.agents import HebbBabbling
from gym_babble.agents.acting import EnvArguments
from gym_babble.agents.loading import LoadedAgent
from gym_babble.checks import check_choice
from gym_babble.envs.registry import TASKS
from gym_babble.errors import ActionError, ConfigError, ScenarioError
from gym_babble.study.evaluation import default_protocol, needs_goals
from gym_babble.study.scenarios import PROTOCOLS, scenarios
from gym_babble.viz.episode import play
from gym_babble.viz.film import Scene
from gym_babble.viz.panel import Panel

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from gym_babble.viz.episode import Episode

__all__ = ["check_same_task", "find_cases", "play_scene", "stages"]


def check_same_task(agents: Mapping[str, LoadedAgent]) -> None:
    """Raises `ConfigError` unless all agents act in the same task.

    Args:
        agents: Agents by their titles.
    """
    (first, one), *others = agents.items()
    for title, other in others:
        if other.arguments.task != one.arguments.task:
            here, there = TASKS[one.arguments.task].title, TASKS[other.arguments.task].title
            raise ConfigError(f"{first} acts in {here}, and {title} in {there}: no case is of both")


def find_cases(
    agents: Sequence[LoadedAgent],
    indices: Sequence[int],
    protocol: str | None = None,
    seed: int = 0,
    split: str = "test",
) -> list[Any]:
    """Test cases for agents of one task.

    Args:
        agents: The agents; cases have the config of the first, and goals if one needs them.
        indices: Indices of the cases in their protocol.
        protocol: Name of the test cases; those that `evaluate` uses for the first agent if None.
        seed: Seed of the cases, unless they are a fixed list.
        split: "test" or "validation".

    Raises:
        ConfigError: There is no such protocol or case.
    """
    first = agents[0].arguments
    if protocol is None:
        protocol = default_protocol(first).name
    task = TASKS[PROTOCOLS[check_choice("protocol", protocol, PROTOCOLS)]]
    sampled = task.protocols[protocol].random
    drawn: dict[str, Any] = {"n": max(indices) + 1, "seed": seed, "split": split} if sampled else {}
    goal = any(needs_goals(loaded.arguments) for loaded in agents)
    cases = {
        case["index"]: case for case in scenarios(protocol, config=first.config, goal=goal, **drawn)
    }
    for index in indices:
        if index not in cases:
            raise ConfigError(
                f"case = {index}: {protocol!r} has no such case; there are {len(cases)}, the last "
                f"is {max(cases)}"
            )
    return [cases[index] for index in indices]


def play_scene(
    agents: Mapping[str, LoadedAgent],
    case: Mapping[str, Any],
    caption: str = "",
    camera: str = "third_person",
) -> Scene:
    """Lets each agent play a case.

    Args:
        agents: Agents by their titles.
        case: The case.
        caption: A line below the panels.
        camera: Camera of the large pictures.

    Raises:
        ScenarioError: An agent, which is named, cannot play the case in its environment.
        ActionError: An agent, which is named, returned no valid action.
        ConfigError: The case does not fit the environment of an agent, which is named.
    """
    panels = []
    for title, loaded in agents.items():
        try:
            episode = play(loaded, case)
        except (ActionError, ConfigError, ScenarioError) as error:
            raise type(error)(f"{title}: {error}") from error
        panels.append(Panel(title, _detail(episode), episode, camera))
    return Scene(panels, caption)


def _detail(episode: Episode) -> str:
    """Where the agent played, which is the case's region, and how much it has learnt."""
    where = EnvArguments.of(episode.env.interface).title
    if isinstance(episode.agent, HebbBabbling):
        return f"{where}, {episode.agent.learnt:,} babbles learnt"
    return where


def stages(
    loaded: LoadedAgent, babbles: Sequence[int], *, progress_bar: bool = False
) -> dict[str, LoadedAgent]:
    """An agent as it was while it learnt, by titles: it learns again from its seed.

    Args:
        loaded: The agent, one that babbles.
        babbles: How many babbles it had learnt from, ascending.
        progress_bar: Show a progress bar.

    Raises:
        ConfigError: The agent does not babble, or the numbers do not ascend.
    """
    if not isinstance(loaded.agent, HebbBabbling):
        raise ConfigError(f"learning: {loaded.agent!r} does not learn by babbling")
    if sorted(set(babbles)) != list(babbles) or not babbles or babbles[0] < 0:
        raise ConfigError(f"learning = {list(babbles)}: expected ascending numbers, at least one")
    agent, found = loaded.agent.untaught(), {}
    for n in babbles:
        agent.learn(n - agent.learnt, progress_bar=progress_bar)
        found[f"after {n:,} babbles"] = LoadedAgent(copy(agent), loaded.arguments)
    return found
