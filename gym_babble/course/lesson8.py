"""Exercises of lesson 8: a rule, an agent, an object and a task of one's own."""

from __future__ import annotations

import json
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import gymnasium as gym
import numpy as np

from gym_babble.agents import HebbBabbling, Scripted
from gym_babble.course.answers import Observed
from gym_babble.course.exercise import Exercise, Finding, right, wrong
from gym_babble.course.own_work import (
    CASES,
    EPISODES,
    LEGAL,
    interval,
    movements_of_agents,
    movements_of_rule,
    played_at_random,
    random_interval,
    solved,
)
from gym_babble.course.settings import Settings
from gym_babble.errors import BabbleError
from gym_babble.study.evaluation import evaluate
from gym_babble.study.scenarios import scenarios
from gym_babble.viz.style import FAINT, LEFT

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Movements = dict[str, Floats]

__all__ = ["EXERCISES"]

MOVEMENTS = dict.fromkeys(("first", "other", "again"), (CASES, 2))


def _beats_random(movements: Movements) -> Finding:
    """Whether movements are the same for the same seed, and better than random ones."""
    if not np.allclose(movements["first"], movements["again"], atol=1e-6):
        return wrong(
            "Made twice from seed 0, it acts differently.",
            "All that is random must come from the seed: `np.random.default_rng(seed)`.",
        )
    counts = [solved(movements[name]) for name in ("first", "other")]
    low, high = random_interval()
    rates = " and ".join(f"{count / CASES:.2f}" for count in counts)
    said = f"It solves {rates} of {CASES} held-out cases, random movements {low:.2f}–{high:.2f}"
    if min(interval(count)[0] for count in counts) > high:
        return right(f"{said}. Its 95 % interval lies above with both seeds.")
    return wrong(
        f"{said}. Its 95 % interval is not above that with both seeds.",
        "Look at single cases: to which side does it curve, and on which side is there room?",
    )


@lru_cache(maxsize=4)
def _by_name(rule: str) -> Floats:
    agent = HebbBabbling("BabbleReachPattern-v0", rule=rule, seed=0, threads=1)
    return movements_of_agents(lambda _seed: agent if agent.learnt else agent.learn(LEGAL))["first"]


def _judge_rule(movements: Movements) -> Finding:
    for name, title in (("covariance", "Eq. 7"), ("hebb", "plain Hebb"), ("oja", "Oja's rule")):
        if np.allclose(movements["first"], _by_name(name), atol=1e-4):
            return wrong(
                f"This is {title}: it chooses the same movements.",
                "Change something of which you can say what it should do.",
            )
    return _beats_random(movements)


def _draw_rates(movements: Movements, axes: Axes) -> None:
    low, high = random_interval()
    axes.axhspan(low, high, color=FAINT, alpha=0.4, label="random")
    for k, name in enumerate(("first", "other")):
        count = solved(movements[name])
        bottom, top = interval(count)
        rate = count / CASES
        axes.errorbar(k, rate, [[rate - bottom], [top - rate]], fmt="o", color=LEFT, capsize=3)
    axes.set(xticks=(0, 1), xlim=(-0.5, 1.5), ylim=(0, 1.02), ylabel="success, 95 %")
    axes.set_xticklabels(("seed 0", "seed 1"))
    axes.legend()


NUMBERS = {"density_kg_m3", "friction", "support_friction", "linear_damping", "angular_damping"}
BALLS = 40


@lru_cache(maxsize=8)
def _held(text: str) -> float:
    """Share of balls that the scripted agent holds."""
    ball = json.loads(text)
    config = {
        "profile": "paper",
        "body": {"object": {name: ball[name] for name in ball if name != "diameter_cm"}},
        "grasp": {"diameters_m": [float(ball["diameter_cm"]) / 100]},
    }
    cases = scenarios("palm_side", BALLS, config=config)
    env = gym.make("BabbleGrasp-v0", config=config)
    return evaluate(Scripted(env), cases=cases, threads=1).rate("held")


def _judge_object(text: str) -> Finding:
    ball = json.loads(text)
    if not isinstance(ball.get("diameter_cm"), int | float):
        return wrong("Your ball has no diameter.", "Give a number of cm as `diameter_cm`.")
    if odd := ball.keys() - NUMBERS - {"diameter_cm"}:
        return wrong(
            f"A ball has no {', '.join(map(repr, sorted(odd)))}.",
            f"Beside diameter_cm there are {', '.join(sorted(NUMBERS))}.",
        )
    try:
        held = _held(text)
    except BabbleError as error:
        return wrong(f"This ball cannot be tried: {error}.", "Take numbers nearer to the defaults.")
    said = f"A script that knows the arm's geometry holds it in {held:.2f} of {BALLS} cases"
    if 0.1 <= held <= 0.9:
        return right(f"{said}. Learners can differ on such an object.")
    easy = held > 0.9
    return wrong(
        f"{said}: {'too easy' if easy else 'too hard'} to tell learners apart.",
        "What could let it slip out of the closed hand? Change its size first."
        if easy
        else "Go half-way back to a ball that is held.",
    )


TRIED = dict.fromkeys(("returns", "again", "steps", "ended"), (EPISODES,)) | {"as_before": ()}


def _judge_task(tried: Movements) -> Finding:
    if not np.allclose(tried["returns"], tried["again"]):
        return wrong(
            "With the same seeds and actions the rewards differ.",
            "Let all that is random come from `self.np_random`, which `reset(seed=...)` seeds, and "
            "forget in `reset` what was in the last episode.",
        )
    if (tried["ended"] < 1).any():
        return wrong(
            "An episode did not end within 2,000 steps.",
            "Set a time limit, or keep the original's.",
        )
    if tried["as_before"] >= 0.5:
        return wrong(
            "It shows and pays what the original does.", "Change what is seen, done or paid."
        )
    return right(
        "What it shows is in its space, the same seed gives the same rewards, and episodes end "
        f"after {tried['steps'].mean():.0f} steps on average. Random play gets "
        f"{tried['returns'].mean():.2f}."
    )


def _draw_task(tried: Movements, axes: Axes) -> None:
    axes.hist(tried["returns"], bins=12, color=LEFT)
    axes.set(xlabel="sum of rewards of an episode, random play", ylabel="episodes")


FIELDS = {"question", "prediction", "cases", "mine", "baseline", "conclusion"}
CONCLUSIONS = ("better", "worse", "cannot say")


def _judge_report(text: str) -> Finding:
    report = json.loads(text)
    if missing := FIELDS ^ report.keys():
        return wrong(
            f"Missing or unknown: {', '.join(map(repr, sorted(missing)))}.",
            f"A report has {', '.join(sorted(FIELDS))}.",
        )
    return (
        _unclear(report)
        or _uncountable(report)
        or _concluded(report, *_difference(report["mine"], report["baseline"], report["cases"]))
    )


def _unclear(report: dict[str, Any]) -> Finding | None:
    for name in ("question", "prediction"):
        words = report[name]
        if not isinstance(words, str) or len(words.split()) < 4:
            return wrong(f"The {name} is too short.", "Write a sentence that could turn out wrong.")
    if report["conclusion"] not in CONCLUSIONS:
        return wrong("The conclusion is unknown.", f"One of {', '.join(CONCLUSIONS)}.")
    return None


def _uncountable(report: dict[str, Any]) -> Finding | None:
    cases = report["cases"]
    if not _whole(cases) or not 100 <= cases <= 1_000_000:
        return wrong("The number of cases is no whole number from 100 on.", "Test on 100 or more.")
    for name in ("mine", "baseline"):
        counts = report[name]
        if not isinstance(counts, list) or not all(map(_whole, counts)):
            return wrong(
                f"{name} is no list of whole numbers.",
                'Give the number of cases solved by each seed: `result.count("success")`.',
            )
        if len(counts) < 3:
            return wrong(f"{name} has {len(counts)} seeds.", "Take three seeds or more.")
        if min(counts) < 0 or max(counts) > cases:
            return wrong(f"{name} has more successes than cases.", "Count single cases.")
    return None


def _whole(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool)


def _difference(mine: list[int], baseline: list[int], cases: int) -> tuple[float, float]:
    """95 % bootstrap interval, over seeds, of the difference of mean success."""
    rng = np.random.default_rng(8)
    ours, others = (
        rng.choice(np.array(counts[:1_000], float) / cases, (10_000, len(counts[:1_000]))).mean(
            axis=1
        )
        for counts in (mine, baseline)
    )
    low, high = np.quantile(ours - others, [0.025, 0.975]).tolist()
    return low, high


def _concluded(report: dict[str, Any], low: float, high: float) -> Finding:
    follows = "better" if low > 0 else "worse" if high < 0 else "cannot say"
    said = f"The difference of the means has the 95 % interval {low:+.3f} to {high:+.3f}"
    if report["conclusion"] == follows:
        return right(f"{said}, and “{follows}” follows from it.")
    return wrong(
        f"{said}. “{report['conclusion']}” does not follow.",
        "Say better or worse only if the whole interval lies on one side of zero.",
    )


EXERCISES = (
    Exercise(
        id="8.1",
        asks="a learning rule of your own that beats random movements after 300 legal movements",
        answer=Observed(observe_by=movements_of_rule, parts=MOVEMENTS, low=-1, high=1),
        judge=_judge_rule,
        draw=_draw_rates,
    ),
    Exercise(
        id="8.2",
        asks="a class or function that makes an agent from a seed, which beats random movements",
        answer=Observed(observe_by=movements_of_agents, parts=MOVEMENTS, low=-1, high=1),
        judge=_beats_random,
        draw=_draw_rates,
    ),
    Exercise(
        id="8.3",
        asks="a dict of a ball that a script holds in at least a tenth and at most nine tenths",
        answer=Settings(),
        judge=_judge_object,
    ),
    Exercise(
        id="8.4",
        asks="a function that makes an environment of your own",
        answer=Observed(observe_by=played_at_random, parts=TRIED),
        judge=_judge_task,
        draw=_draw_task,
    ),
    Exercise(
        id="8.5",
        asks="a dict with question, prediction, cases, mine, baseline and conclusion",
        answer=Settings(),
        judge=_judge_report,
    ),
)
