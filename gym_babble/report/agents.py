"""The sections that play and open the Hebb agents of a store: the paper's figures, and a film.

Only files of this package's own agents are opened, which are data. Files of stable-baselines3 hold
pickled Python, and a report of someone else's study shall not run it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from gym_babble.agents import HebbBabbling
from gym_babble.agents.loading import load_agent
from gym_babble.errors import AgentFileError, ConfigError
from gym_babble.paper import fig2, fig4, fig5, fig7, fig8, sight
from gym_babble.report.charts import Chart
from gym_babble.study.rates import share
from gym_babble.study.scenarios import scenarios

if TYPE_CHECKING:
    from collections.abc import Iterator

    from gym_babble.report.data import AgentRuns, TaskRuns

__all__ = ["hebb_agents", "hebb_sections"]

FIG7_EVERY = 4
"""Every fourth test of Fig. 7 is played."""


def hebb_agents(task: TaskRuns) -> list[tuple[AgentRuns, HebbBabbling]]:
    """The Hebb agents of a task: each agent's first seed."""
    found = []
    for agent in task.agents:
        path = agent.runs[0].agent
        if path is None or path.suffix != ".safetensors":
            continue
        try:
            opened = load_agent(path)
        except AgentFileError:
            continue  # Another agent's file.
        if isinstance(opened, HebbBabbling):
            found.append((agent, opened))
    return found


def hebb_sections(task: TaskRuns) -> Iterator[dict[str, Any]]:
    """The paper's figures for each Hebb agent, and those of the task."""
    make = {"reach": _reaching, "grasp": _grasping}[task.spec.task]
    for agent, hebb in hebb_agents(task):
        yield from make(task, agent, hebb)
    if task.spec.task == "reach":
        yield _section("Pattern generators (Fig. 2)", [_generators(task)])
    else:
        yield _section("What the eye sees", [_sight(task)])


def _section(title: str, broad: list[Chart], text: str = "") -> dict[str, Any]:
    return {
        "title": title,
        "text": text,
        "legend": False,
        "panels": [],
        "broad": broad,
        "photos": [],
    }


def _who(agent: AgentRuns) -> str:
    return f"{agent.title[0]}, seed {agent.seeds[0]}"


def _reaching(task: TaskRuns, agent: AgentRuns, hebb: HebbBabbling) -> Iterator[dict[str, Any]]:
    cases, config = scenarios("fig4", config=task.spec.config), task.spec.config
    halfway = fig4.trajectories(hebb, cases, config)
    exchanged = fig4.trajectories(hebb, [fig4.switched(case) for case in cases], config)
    chart = Chart(
        f"{task.name}.{agent.spec.label}.fig4",
        fig4.draw(halfway, exchanged),
        "Four targets (circles) and 36 starts around each (dots), obstacles not drawn. Bold: "
        "success; dotted: failure, up to a red cross. Blue curves left, orange right. On the "
        "right, obstacle and start are exchanged: the obstacle stands behind the hand, and a "
        "straight movement reaches the target too.",
    )
    yield _section(f"Trajectories of {_who(agent)} (Fig. 4)", [chart])
    title = f"Weights of {_who(agent)} (Fig. 5)"
    gaze = fig5.strongest_gaze(hebb) if hebb.variant == "conjunctive" else None
    try:
        sets = fig5.weight_sets(hebb, gaze=gaze)
    except ConfigError as error:
        yield _section(title, [], f"No figure: {error}.")
        return
    of_gaze = "" if gaze is None else f", for one neuron of the eye's map, {gaze}"
    chart = Chart(
        f"{task.name}.{agent.spec.label}.fig5",
        fig5.draw(sets),
        f"Weights from input neurons to the output map{of_gaze}. With one set of neurons the "
        "movement curves left, with the other right. Of each, the neuron most like its set's mean, "
        "and the mean. The mean of one set correlates "
        f"{share(sets.mirror_correlation)} with the mirrored mean of the other.",
    )
    yield _section(title, [chart])


def _grasping(task: TaskRuns, agent: AgentRuns, hebb: HebbBabbling) -> Iterator[dict[str, Any]]:
    cases = scenarios("fig7", config=task.spec.config)[::FIG7_EVERY]
    chart = Chart(
        f"{task.name}.{agent.spec.label}.fig7",
        fig7.draw(fig7.trajectories(hebb, cases)),
        "Final portions of the palm's trajectories to 12 places of each object, all around the "
        "arm, in a quarter of the figure's tests. Thin: touched; bold: grasped; dotted grey: "
        "missed. Circles are the objects, to scale.",
    )
    yield _section(f"Trajectories of the hand of {_who(agent)} (Fig. 7)", [chart])
    if hebb.variant == "chain":
        return  # Fig. 8 shows maps that only the paper's agent has.
    chart = Chart(
        f"{task.name}.{agent.spec.label}.fig8",
        fig8.draw(hebb),
        "Top: the arm's map when the eye looks at an object, and the weights from one neuron of "
        "the eye's map. Bottom: weights from the fovea to the neurons of the hands for the "
        "smallest and the biggest object.",
    )
    yield _section(f"Activation and weights of {_who(agent)} (Fig. 8)", [chart])


def _generators(task: TaskRuns) -> Chart:
    return Chart(
        f"{task.name}.fig2",
        fig2.draw(),
        "Left: the path of a movement for several b1, with b2 = 1 − b1. Right: the same from hand "
        "to target. With b1 above ½ the path curves left.",
    )


def _sight(task: TaskRuns) -> Chart:
    return Chart(
        f"{task.name}.sight",
        sight.draw(sight.eye_views(task.spec.config)),
        "Objects of each size: the eye's view, the fovea in its middle, and the edges in the "
        "fovea, from which the hand learns the size.",
    )
