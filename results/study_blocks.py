"""The tables of the published study."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from gym_babble.report.formats import count, seconds
from gym_babble.study.rates import share
from results.tables import SIZES, markdown, span

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from results.stores import Stores

LEVELS = (0.5, 0.67, 0.8, 0.9, 0.95)
ABLATION_LEVELS = (0.5, 0.8, 0.95)
PAIRS = {
    "reach": (
        ("ppo-obstacle", "hebb-paper", "both see the obstacle"),
        ("ppo-eye-obstacle", "hebb-conjunctive", "both see obstacle and eye"),
        ("ppo-pattern", "hebb-conjunctive", "PPO sees everything"),
        ("ppo", "hebb-conjunctive", "PPO sees everything, and acts step by step"),
        ("sac", "hebb-conjunctive", "SAC sees everything"),
        ("sac-her", "hebb-conjunctive", "SAC sees everything, and learns from goals it missed"),
    ),
    "grasp": (
        ("ppo", "hebb-paper", "PPO sees everything"),
        ("ppo-reflex", "hebb-paper", "PPO sees everything, and has the reflex"),
        ("ppo-in-hand", "hebb-paper", "PPO sees everything, and has objects in the hand"),
        ("ppo", "goal-babbling", "PPO sees everything"),
        ("ppo", "hebb-chain", "PPO sees everything"),
        ("ppo-reflex", "hebb-chain", "PPO sees everything, and has the reflex"),
        ("ppo-in-hand", "hebb-chain", "PPO sees everything, and has objects in the hand"),
    ),
}
"""Who is compared with whom in steps, and what differs."""

ABLATIONS = {
    "hebb-chain": "the chain",
    "chain-eye-alone": "the eye alone as input, without the size",
    "chain-eq7": "Eq. 7 instead of the outstar",
    "chain-no-jitter": "the arm returns exactly",
    "chain-free-withdrawal": "withdrawal in a random direction",
    "chain-no-opening": "the hand stays closed on its withdrawal",
    "chain-no-reflex": "touch does not stop the arm",
    "chain-no-advance": "no advance beyond the recalled contact",
    "chain-no-squeeze": "the hand closes as recalled, not further",
    "chain-shuffled": "each sight paired with another babble's action",
    "chain-random-reach": "random reaches, with advance and reflex",
    "reflex-only": "random babbles, with the reflex",
    "hebb-paper": "the paper's agent",
    "nearest-neighbour-chain": "nearest neighbours of the chain's babbles",
    "nearest-neighbour": "nearest neighbours of the paper's babbles",
    "goal-babbling": "goal babbling",
    "ppo": "PPO",
    "ppo-reflex": "PPO with the reflex",
    "ppo-in-hand": "PPO that starts with objects in the hand",
    "scripted": "a script that knows the geometry",
}
"""The chain, the chain without a part, and others; the middle ones are in this table alone."""
VARIED = [label for label in ABLATIONS if label.startswith("chain-")]


def task_of(stores: Stores, name: str) -> dict[str, Any]:
    """The numbers of a task of the study."""
    return next(task for task in stores["published"]["tasks"] if task["name"] == name)


def _success(agent: dict[str, Any]) -> list[str]:
    """Interquartile mean, its interval, and the range of the seeds."""
    found = agent["success"]
    iqm, many = found["iqm"], len(agent["runs"])
    sure = "" if iqm["low"] is None else span(iqm["low"], iqm["high"])
    ends = share(found["best"]) if many == 1 else span(found["worst"], found["best"])
    return [share(iqm["estimate"]), sure, f"{many}: {ends}"]


def _learnt(agent: dict[str, Any]) -> list[str]:
    """Trials, control steps and CPU seconds."""
    cost = agent["cost"]
    if not agent["curve"]:
        return ["–"] * 3
    return [count(cost["trials"]), count(cost["control_steps"]), seconds(cost["cpu_seconds"])]


def study_reach(stores: Stores) -> str:
    """All agents in reaching."""
    rows = [
        [
            f"`{agent['label']}`",
            agent["sees"],
            *_success(agent),
            *(share(agent["rates"][name]) for name in ("collision", "joint_limit")),
            *_learnt(agent),
        ]
        for agent in task_of(stores, "reach")["agents"]
    ]
    heads = ["agent", "sees", "success", "95 %", "seeds", "collision", "joint limit"]
    return markdown([*heads, "movements or episodes", "control steps", "CPU"], rows)


def study_grasp(stores: Stores) -> str:
    """All agents in grasping."""
    agents = task_of(stores, "grasp")["agents"]
    rows = [
        [
            f"`{agent['label']}`",
            ", ".join(agent["knows"]) or "–",
            *_success(agent),
            *(share(agent["sizes"][size]["mean"]) for size in SIZES.values()),
            share(agent["rates"]["reach"]),
            *_learnt(agent),
        ]
        for agent in agents
        if agent["label"] not in VARIED
    ]
    heads = ["agent", "knows beforehand", "success", "95 %", "seeds", *SIZES.values()]
    return markdown([*heads, "touched", "babbles or episodes", "control steps", "CPU"], rows)


def _budget(found: dict[str, Any]) -> str:
    """Control steps to a level: the median seed's, or a bound."""
    if found["by"] is None:
        return f"> {count(found['after'])}"
    return count(found["by"])


def _budgets(stores: Stores, name: str) -> str:
    rows = []
    for agent in task_of(stores, name)["agents"]:
        if agent["curve"] and agent["label"] not in VARIED:
            found = {one["level"]: one for one in agent["budgets"]["control_steps"]}
            rows.append([f"`{agent['label']}`", *(_budget(found[level]) for level in LEVELS)])
    return markdown(["control steps to", *(share(level) for level in LEVELS)], rows)


def study_budgets_reach(stores: Stores) -> str:
    """Control steps to each level in reaching."""
    return _budgets(stores, "reach")


def study_budgets_grasp(stores: Stores) -> str:
    """Control steps to each level in grasping."""
    return _budgets(stores, "grasp")


def study_ratios(stores: Stores) -> str:
    """How many times the steps of one agent another one needs."""
    return markdown(["", "differ in", *(share(level) for level in LEVELS)], _ratio_rows(stores))


def _ratio_rows(stores: Stores) -> Iterator[list[str]]:
    for name, pairs in PAIRS.items():
        ratios = task_of(stores, name)["ratios"]["control_steps"]
        for other, reference, differ in pairs:
            texts = [one["text"] for one in ratios[reference][other]]
            yield [f"{name}: `{other}` / `{reference}`", differ, *texts]


def study_short(stores: Stores) -> str:
    """The README's rows: success and what it took, for the agents that say most."""
    shown = {
        "reach": ("hebb-paper", "hebb-conjunctive", "ppo-obstacle", "ppo-pattern", "ppo", "sac"),
        "grasp": ("hebb-paper", "hebb-chain", "goal-babbling", "ppo", "ppo-reflex"),
    }
    rows = []
    for name, labels in shown.items():
        for agent in task_of(stores, name)["agents"]:
            if agent["label"] in labels:
                cost = _learnt(agent)[1:]
                rows.append([name, agent["title"], agent["sees"], *_success(agent), *cost])
    heads = ["task", "agent", "sees", "success", "95 %", "seeds", "control steps", "CPU"]
    return markdown(heads, rows)


def ablations(stores: Stores) -> str:
    """The chain without each of its parts, and others, in grasping."""
    agents = {agent["label"]: agent for agent in task_of(stores, "grasp")["agents"]}
    rows = []
    for label, title in ABLATIONS.items():
        agent = agents[label]
        cells = [title, *_success(agent)]
        cells += [share(agent["sizes"][size]["mean"]) for size in SIZES.values()]
        for axis, form in (("control_steps", count), ("cpu_seconds", seconds)):
            cells += _levels(agent, axis, form)
        rows.append(cells)
    steps = [f"steps to {share(level)}" for level in ABLATION_LEVELS]
    cpu = [f"CPU to {share(level)}" for level in ABLATION_LEVELS]
    return markdown(["", "success", "95 %", "seeds", *SIZES.values(), *steps, *cpu], rows)


def _levels(agent: dict[str, Any], axis: str, form: Callable[[float], str]) -> list[str]:
    if not agent["curve"]:
        return ["–"] * len(ABLATION_LEVELS)
    found = {one["level"]: one for one in agent["budgets"][axis]}
    return [
        "never" if found[level]["by"] is None else form(found[level]["by"])
        for level in ABLATION_LEVELS
    ]


STUDY_BLOCKS: tuple[Callable[[Stores], str], ...] = (
    *(study_short, study_reach, study_grasp, study_budgets_reach, study_budgets_grasp),
    *(study_ratios, ablations),
)
"""The study's tables."""
