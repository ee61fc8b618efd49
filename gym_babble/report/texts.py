"""The sentences of a report, with its numbers filled in."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from gym_babble.report.formats import seconds
from gym_babble.study.rates import share
from gym_babble.study.tasks import task_named

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = [
    "about",
    "axis_words",
    "lead",
    "made",
    "methods",
    "notes",
    "task_warnings",
    "title_of_task",
    "warnings",
]

HEADINGS = {
    "reach": "Reaching around an obstacle",
    "grasp": "Grasping an object",
}

ABOUT = {
    "reach": "An arm reaches for a target behind an obstacle. A case is legal if a babbled "
    "movement solves it, so every case can be solved.",
    "grasp": "An arm with a hand reaches for an object that it sees, and grasps it. Success: the "
    "hand has held the object without support for a second. Touch: any part of arm or hand has "
    "touched the object, successful or not; palm: the palm has.",
}
"""What each task is about, and what its rates mean."""


def title_of_task(task: dict[str, Any]) -> str:
    """Heading of a task; its name in the study follows where that says more."""
    heading = HEADINGS[task["task"]]
    return heading if task["name"] == task["task"] else f"{heading}: {task['name']}"


def about(task: dict[str, Any]) -> str:
    """What a task is, and on which cases it is tested."""
    protocol = f"protocol {_protocol(task)}, config {task['config']}"
    if task["cases"] is None:
        return f"{ABOUT[task['task']]} No run is finished yet ({protocol})."
    return (
        f"{ABOUT[task['task']]} All agents and seeds are tested on the same {task['cases']:,} "
        f"cases ({protocol}), which no agent has learnt from."
    )


def _protocol(task: dict[str, Any]) -> str:
    """The protocol of a task's cases, with their seed if they are random."""
    if task["case_seed"] is None:
        return f"{task['protocol']}, one fixed list"
    return f"{task['protocol']} with case seed {task['case_seed']:,}"


def axis_words(task: dict[str, Any], axis: str) -> str:
    """What an axis of learning counts."""
    trials = task_named(task["task"]).trials
    return {
        "trials": f"{trials} or episodes",
        "control_steps": "control steps",
        "cpu_seconds": "CPU seconds",
    }[axis]


def lead(tasks: Sequence[dict[str, Any]]) -> str:
    """The first paragraph: who was compared, and who succeeds most often on each task."""
    labels = {agent["label"] for task in tasks for agent in task["agents"]}
    seeds = sorted({len(agent["runs"]) for task in tasks for agent in task["agents"]})
    if not seeds:
        return "No run of this study is finished yet."
    many = f"{seeds[0]}" if len(seeds) == 1 else f"{seeds[0]} to {seeds[-1]}"
    found = " ".join(_best(task) for task in tasks if task["agents"])
    return (
        f"{_count(len(labels), 'agent')} on {_count(len(tasks), 'task')}, {many} "
        f"{'seed' if seeds == [1] else 'seeds'} each. {found}"
    )


def _best(task: dict[str, Any]) -> str:
    """Success on a task: of the three best agents that learn, or of all if none does."""
    learners = [agent for agent in task["agents"] if agent["curve"]]
    ranked = sorted(
        learners or task["agents"], key=lambda agent: -agent["success"]["iqm"]["estimate"]
    )
    who = "agents that learn" if learners else "agents"
    whose = f"the best three of {len(ranked)} {who}" if len(ranked) > 3 else f"the {who}"
    named = [f"{agent['title']} {_with_interval(agent)}" for agent in ranked[:3]]
    if task["paper"]:
        named.append(f"the paper {share(task['paper']['success'])}")
    return f"{HEADINGS[task['task']]}, success of {whose}: {'; '.join(named)}."


def _with_interval(agent: dict[str, Any]) -> str:
    iqm = agent["success"]["iqm"]
    if iqm["low"] is None:
        return share(iqm["estimate"])
    return f"{share(iqm['estimate'])} ({share(iqm['low'])}–{share(iqm['high'])})"


def _count(n: int, what: str) -> str:
    return f"{n} {what}" if n == 1 else f"{n} {what}s"


def warnings(tasks: Sequence[dict[str, Any]], unfit: Sequence[str]) -> list[str]:
    """What a reader must know before the numbers: runs that are not there, other versions."""
    found = []
    absent = [run for task in tasks for run in task["absent"]]
    for status in ("failed", "missing"):
        many = sum(run["status"] == status for run in absent)
        if many:
            found.append(f"{_count(many, 'run')} {status}: the tables name them.")
    if unfit:
        found.append(
            f"{_count(len(unfit), 'stored run')} left out, because they do not fit the study: the "
            "table of runs says why."
        )
    return found


def task_warnings(task: dict[str, Any]) -> list[str]:
    """Which agents have too few seeds, one sentence for each number of seeds."""
    few: dict[str, list[str]] = {}
    for agent in task["agents"]:
        if agent["warning"] is not None:
            few.setdefault(agent["warning"], []).append(agent["title"])
    return [f"{', '.join(titles)}: {warning}" for warning, titles in few.items()]


def notes(task: dict[str, Any]) -> dict[str, str]:
    """The small print below each table."""
    words = task_named(task["task"])
    return {
        "rates": "Success: interquartile mean over the seeds; small: its 95 % interval from a "
        "bootstrap over seeds and cases. The other rates are means over the seeds. "
        f"{words.trials.capitalize()}, control steps and CPU: what a run has used to learn, mean "
        f"over the seeds. Everything counts, failed {words.trials} too; small: the share that was "
        f"{words.accepted}. The time of tests does not count.",
        "learning": f"At each checkpoint an agent plays the first {task['checkpoint_cases']:,} of "
        "the test cases, while the clocks stand still. Thick: interquartile mean over the seeds. "
        f"Bands: its 95 % interval. Thin: single runs.{_joined(task)}",
        "budgets": "The median seed. A run is tested at checkpoints only, so it has needed more "
        "than the checkpoint before, and at most the number shown. Small: 95 % interval from a "
        "bootstrap over seeds, with the distance of the checkpoints in it. “>” means that the "
        "median seed did not get there within its budget: there is no number, only a bound. A "
        "ratio above 1 means that the agent in the row needs more.",
        "improvement": "How probably a seed of the agent in the row succeeds more often than a "
        "seed of the agent in the column, ties counted half; below, the 95 % interval from a "
        "bootstrap over the seeds. .500 means that neither is better. Grey: the interval holds "
        ".500. p: two-sided Mann-Whitney test over the seeds; 3 seeds against 3 cannot give less "
        "than .1.",
        "mcnemar": "Each pair is the first seed of two agents, on the same cases. The exact test "
        "is about these two trained agents, and says nothing about other seeds.",
    }


def _joined(task: dict[str, Any]) -> str:
    """What a reader must know of curves from elsewhere."""
    if not task["joined"]:
        return ""
    titles = ", ".join(one["title"] for one in task["joined"])
    return f" {titles}: from logs of stable-baselines3; their episodes are not this study's cases."


def methods(document: dict[str, Any]) -> dict[str, str]:
    """The methods as sentences that a paper can use, with the numbers of this study."""
    tasks = document["tasks"]
    tests = " ".join(_tests(task) for task in tasks if task["cases"])
    runs = sum(len(agent["runs"]) for task in tasks for agent in task["agents"])
    return {
        "tests": f"{tests} All agents of a task were tested on the same cases, with deterministic "
        "actions and one episode for each case.",
        "costs": "Every control step that an agent took while it learnt was counted, those of "
        "failed movements and dropped objects too; a whole movement counts with all its steps. "
        "CPU time is that of one process with one thread. At checkpoints at 1, 2, 5, 10 … thousand "
        "control steps, clocks were stopped and the agent was tested.",
        "seeds": _seeds(tasks),
        "statistics": "Scores are success rates of seeds. We report interquartile means (the mean "
        "of the middle half of the seeds) with 95 % percentile intervals from a bootstrap of "
        f"{document['statistics']['resamples']:,} resamples over seeds and cases (Agarwal et al. "
        "2021; Owen 2007), performance profiles, and probabilities of improvement (Mann–Whitney). "
        "Two trained agents are compared by McNemar's exact test; intervals of single runs are "
        "Wilson's, over cases.",
        "budgets": "A seed's budget for a level of success is that of the first checkpoint that "
        "reached it. Seeds that did not reach it within their budget are censored: medians over "
        "seeds and ratios of medians are then bounds.",
        "machines": f"{_count(runs, 'run')} used {seconds(document['cpu_seconds'])} of CPU time "
        "for learning, on "
        f"{' and '.join(document['machines'])}, with gym-babble {_listed(document, 'gym-babble')}, "
        f"physics {', '.join(document['physics'])}.",
    }


def _tests(task: dict[str, Any]) -> str:
    return (
        f"{HEADINGS[task['task']]} was tested on {task['cases']:,} cases of protocol "
        f"{_protocol(task)} (config {task['config']})."
    )


def _seeds(tasks: Sequence[dict[str, Any]]) -> str:
    """Which agents learnt with which seeds, those with the same seeds together."""
    groups: dict[str, list[str]] = {}
    for task in tasks:
        for agent in task["agents"]:
            seeds = ", ".join(str(run["seed"]) for run in agent["runs"])
            groups.setdefault(seeds, []).append(f"{agent['title']} ({task['name']})")
    return " ".join(
        f"Seed{'s' if ',' in seeds else ''} {seeds}: {', '.join(names)}."
        for seeds, names in groups.items()
    )


def _listed(document: dict[str, Any], package: str) -> str:
    return ", ".join(document["versions"].get(package, ()))


def made(document: dict[str, Any]) -> dict[str, str]:
    """What the runs were made with; several values where runs differ."""
    return {
        "machine": "; ".join(document["machines"]),
        "physics": ", ".join(document["physics"]),
        "code": ", ".join(document["code"]),
        **{name: ", ".join(found) for name, found in document["versions"].items()},
    }
