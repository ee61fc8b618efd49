"""The report of a comparison: one HTML file with its pictures inside."""

from __future__ import annotations

import json
import os
from base64 import b64encode
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from gym_babble.agents import HebbBabbling, HebbGrasping
from gym_babble.agents.loading import LoadedAgent
from gym_babble.cli.doctor import versions
from gym_babble.paper.reproduce import starts_without_case, switched, ways, weight_sets
from gym_babble.paper.table2 import grasp_ways, sights
from gym_babble.study.compare import Played, Stored
from gym_babble.study.scenarios import scenarios
from gym_babble.study.tables import paper_tally, share
from gym_babble.viz import figures
from gym_babble.viz.film import contact_sheet, png, record

if TYPE_CHECKING:
    from collections.abc import Callable

    from gym_babble.study.compare import Comparison, Result
    from gym_babble.study.scenarios import GraspScenario, Scenario
    from gym_babble.study.tasks import Task
    from gym_babble.viz.film import Film

__all__ = ["write_report"]


class Words(NamedTuple):
    """What the page of a task says."""

    heading: str
    lead: str
    cases: str
    meaning: str
    """What the table's rates mean."""
    learnt_from: str
    """What its other numbers mean."""


WORDS = {
    "reach": Words(
        heading="Reaching around an obstacle: Hebb babbling beside PPO",
        lead="An arm learns to reach a target behind an obstacle: by motor babbling and a Hebb "
        "rule, as Caligiore et al. (2008) modelled it, and by reinforcement learning. All agents "
        "meet the same cases in the same simulation.",
        cases="legal cases that no agent learnt from",
        meaning="Legal means that a babbled movement solved the case: each can be solved.",
        learnt_from="Movements: legal ones learnt from for Hebb, with the share of babbled "
        "movements that were legal; episodes for PPO. Steps: control steps simulated while "
        "learning, in millions; a whole movement counts with all of its steps.",
    ),
    "grasp": Words(
        heading="Grasping an object: Hebb babbling beside PPO",
        lead="An arm with a hand learns to reach for an object that it sees and to grasp it: by "
        "motor babbling with the object in the hand and a Hebb rule, as Caligiore et al. (2008) "
        "modelled it, and by reinforcement learning. All agents meet the same cases in the same "
        "simulation.",
        cases="objects on the palm's side of the arm that no agent learnt from",
        meaning="Success: the hand has held the object without support for a second. Touch: any "
        "part of arm or hand has touched the object, whatever came of it; of palm: the palm has.",
        learnt_from="Babbles: those learnt from for Hebb, with the share of all babbles in which "
        "the hand kept the object; episodes for PPO. Steps: control steps simulated while "
        "learning, in millions; a babble counts with its 4 s.",
    ),
}
FIG7_EVERY = 4
"""One in so many of Fig. 7's tests is played."""


def write_report(
    comparison: Comparison, folder: Path, command: str, other: str | None = None
) -> list[Path]:
    """Writes index.html and results.json into a folder, and returns both.

    Args:
        comparison: What to report.
        folder: Made if it is not there.
        command: The command that makes it again.
        other: Where the other task's page is, seen from this one, to link to.

    Raises:
        MissingExtraError: matplotlib is not there.
    """
    folder.mkdir(parents=True, exist_ok=True)
    results, page = folder / "results.json", folder / "index.html"
    results.write_text(json.dumps(comparison.to_json(), indent=2) + "\n", encoding="utf-8")
    page.write_text(_page(comparison, command, other), encoding="utf-8")
    return [page, results]


def _page(comparison: Comparison, command: str, other: str | None) -> str:
    style = Path(__file__).with_name("report.css").read_text(encoding="utf-8")
    task = comparison.task
    sections = "".join(section(comparison) for section in SECTIONS[task.name])
    return (
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{task.title}: Hebb babbling beside PPO</title>\n<style>\n{style}</style></head>\n"
        f"<body><main>\n{_lead(comparison)}\n{_link(task, other)}{sections}"
        f"{_made(comparison, command)}</main></body></html>\n"
    )


def _link(task: Task, other: str | None) -> str:
    if other is None:
        return ""
    (title,) = (words.heading for name, words in WORDS.items() if name != task.name)
    return f'<p class="note">See also: <a href="{escape(other)}">{title}</a></p>\n'


def _lead(comparison: Comparison) -> str:
    task = comparison.task
    best = [
        f"{escape(result.contender.title)} ({escape(result.contender.detail)}) "
        f"{share(result.rates['success']['rate'])}"
        for result in comparison.results
        if result.mean("movements")
    ]
    paper = f"; the paper {share(paper_tally()['success']['rate'])}" if task.paper else ""
    found = f"Success here: {'; '.join(best)}{paper}." if best else ""
    words = WORDS[task.name]
    return f'<h1>{words.heading}</h1>\n<p class="lead">{words.lead} {found}</p>'


def _table(comparison: Comparison) -> str:
    task, settings = comparison.task, comparison.settings
    names = [*task.outcomes, *("touch" if name == "reach" else "of palm" for name in task.facts)]
    names = ["agent", "", *(name.replace("_", " ") for name in names), task.made, "steps", "clock"]
    head = "".join(f"<th>{name}</th>" for name in names)
    rows = ""
    if task.paper is not None:
        cells = ["20,000<small>legal ≈ .20</small>", "", ""]
        paper = _row("the paper", "Table I", paper_tally(), task, cells)
        rows = paper.replace("<tr>", "<tr class=paper>")
    rows += "".join(_result_row(result) for result in comparison.results)
    notes = "".join(
        f'<p class="note">{escape(note[0].upper() + note[1:])}.</p>' for note in comparison.notes
    )
    key = "".join(f'<i class="{name}"></i>{name.replace("_", " ")}' for name in task.outcomes)
    words = WORDS[task.name]
    stored = any(isinstance(result, Stored) for result in comparison.results)
    elsewhere = ", of a stored study on the one that ran it" if stored else ""
    return (
        f"<h2>{'Table I' if task.paper else 'Success'}</h2>\n<p>{settings.cases:,} {words.cases}"
        f"{f', for each of {settings.seeds} seeds' if settings.seeds > 1 else ''}; under each rate "
        f"its 95 % Wilson interval. {words.meaning}"
        f'</p>\n<div class="scroll"><table><tr>{head}</tr>\n{rows}</table></div>\n'
        f'<p class="note key">{key}</p>\n'
        f'<p class="note">{words.learnt_from} Clock: seconds of '
        f"learning on this machine{elsewhere}. With several seeds, means.</p>\n"
        f"{notes}"
    )


def _result_row(result: Result) -> str:
    task, cells = result.task, ["", "", ""]
    if result.mean("movements"):
        movements = f"{result.mean('movements'):,.0f}"
        if result.legal_rate is not None:
            legal = result.mean("legal_movements")
            movements = f"{legal:,.0f}<small>{task.good} {share(result.legal_rate)}</small>"
        steps = f"{result.mean('control_steps') / 1e6:.1f} M"
        cells = [movements, steps, f"{result.mean('seconds'):.0f} s"]
    return _row(result.contender.title, result.contender.detail, result.rates, task, cells)


def _row(title: str, detail: str, rates: dict[str, Any], task: Task, cells: list[str]) -> str:
    bar = "".join(
        f'<span class="{name}" style="width:{100 * rates[name]["rate"]:.1f}%"></span>'
        for name in task.outcomes
    )
    shares = "".join(
        f"<td>{share(rates[name]['rate'])}"
        f"<small>{share(rates[name]['low'])}–{share(rates[name]['high'])}</small></td>"
        for name in (*task.outcomes, *task.facts)
    )
    return (
        f"<tr><td>{escape(title)}<small>{escape(detail)}</small></td>"
        f'<td><div class="bar">{bar}</div></td>{shares}'
        f"{''.join(f'<td>{cell}</td>' for cell in cells)}</tr>\n"
    )


def _curves(comparison: Comparison) -> str:
    if not any(trained.curve for result in comparison.results for trained in result.trained):
        return ""
    dotted = " The dotted line is the paper's .67 on its tests." if comparison.task.paper else ""
    return "<h2>While learning</h2>\n" + _figure(
        _svg(figures.learning_curves(comparison)),
        f"Success on 200 validation cases, which are none of the tests.{dotted} A curve begins at "
        "its first measured point.",
    )


def _filmed(
    comparison: Comparison, worth: Callable[[Any], float]
) -> tuple[Played, Any, Film, bytes] | None:
    """A success of the first agent of the table that played, the one most worth looking at.

    The result, the case, a film of it, and what the eye saw before.
    """
    played = [result for result in comparison.results if isinstance(result, Played)]
    if not played:
        return None
    result = played[0]
    trained, config = result.trained[0], comparison.settings.config
    cases = scenarios(comparison.task.protocol, comparison.settings.cases, config=config)
    good = [
        case
        for case, outcome in zip(cases, result.tests[0].outcomes, strict=True)
        if outcome == "success"
    ]
    case = max(good or cases, key=worth)
    loaded = LoadedAgent(trained.agent, trained.env_id, config, trained.env_kwargs)
    film = record(loaded, options={"scenario": case}, size=600)
    eye = record(loaded, options={"scenario": case}, camera="eye", size=630).frames[0]
    return result, case, film, png(eye)


def _movement(comparison: Comparison) -> str:
    filmed = _filmed(comparison, _on_stage)
    if filmed is None:
        return ""
    result, case, film, eye = filmed
    near = [frame[60:400, 80:420] for frame in film.frames]  # The arm keeps to the middle.
    return (
        f"<h2>A movement</h2>\n<p>{escape(result.contender.title)} on case {case['index']}: "
        f"{film.outcome.replace('_', ' ')}.</p>\n"
        '<div class="photos">'
        + _figure(_png(eye), "What the eye sees before: 630 × 630 pixels, 120°, on the target.")
        + _figure(_png(png(contact_sheet(near))), "The movement, row by row.")
        + "</div>\n"
    )


def _on_stage(case: Scenario) -> float:
    """How much a case has to show: a long way near the middle of the picture."""
    start, target = np.array(case["start"]), np.array(case["target"])
    middle = 0.5 * (start + target)
    return float(np.linalg.norm(target - start) - np.linalg.norm(middle - (0.0, 0.3)))


def _grasp(comparison: Comparison) -> str:
    filmed = _filmed(comparison, _size)
    if filmed is None:
        return ""
    result, case, film, eye = filmed
    return (
        f"<h2>A grasp</h2>\n<p>{escape(result.contender.title)} on case {case['index']}: "
        f"{film.outcome.replace('_', ' ')}.</p>\n"
        '<div class="photos">'
        + _figure(_png(eye), "What the eye sees before: 630 × 630 pixels, 120°, on the object.")
        + _figure(_png(png(contact_sheet(film.frames))), "The grasp, row by row.")
        + "</div>\n"
    )


def _size(case: GraspScenario) -> float:
    """How much a case has to show: a big object."""
    return case["diameter"]


def _trajectories_of(key: str) -> Callable[[Comparison], str]:
    return lambda comparison: _trajectories(comparison, key)


def _trajectories(comparison: Comparison, key: str) -> str:
    result = comparison.result(key)
    if not isinstance(result, Played):
        return ""
    config, agent = comparison.settings.config, result.trained[0].agent
    cases = scenarios("fig4", config=config)
    missing = starts_without_case(config)
    found = ways(agent, cases, config)
    turned = ways(agent, [switched(case) for case in cases], config)
    return f"<h2>Trajectories of {escape(result.contender.title)} (Fig. 4)</h2>\n" + _figure(
        _svg(figures.fig4(found, turned, missing)),
        "Four targets (circles) and 36 starts around each (dots), obstacles not drawn. Bold: "
        "success; dotted: failure, up to a red cross. Blue curves left, orange right. Grey "
        f"crosses: {len(missing)} starts without a case, out of reach or with the arm in the "
        "obstacle. Right: obstacle and start in each other's place.",
    )


def _weights(comparison: Comparison) -> str:
    result = comparison.result("hebb-paper")
    agent = result.trained[0].agent if isinstance(result, Played) else None
    if not isinstance(agent, HebbBabbling):
        return ""
    sets = weight_sets(agent)
    return "<h2>Weights (Fig. 5)</h2>\n" + _figure(
        _svg(figures.fig5(sets)),
        "Weights from input neurons to the output map. The neurons fall into two compact sets: one "
        "makes the movement curve left, the other right. The mean of one set correlates "
        f"{share(sets.mirror_correlation)} with the mirrored mean of the other.",
    )


def _generators(_: Comparison) -> str:
    return "<h2>Pattern generators (Fig. 2)</h2>\n" + _figure(
        _svg(figures.fig2()),
        "The path of a movement for several b1, with b2 = 1 − b1, and the same between a hand and "
        "a target. b1 above ½ curves left.",
    )


def _hands(comparison: Comparison) -> str:
    """Where seed 0's Hebb agent goes, and what it has learnt."""
    result = comparison.result("hebb-paper")
    agent = result.trained[0].agent if isinstance(result, Played) else None
    if not isinstance(agent, HebbGrasping):
        return ""
    config = comparison.settings.config
    ways = grasp_ways(agent, scenarios("fig7", config=config)[::FIG7_EVERY], config)
    return (
        "<h2>Ways of the hand (Fig. 7)</h2>\n"
        + _figure(
            _svg(figures.fig7(ways)),
            "Final portions of the palm's ways to 12 places of each object, which lie all around, "
            "in a quarter of the figure's tests. Thin: touched; bold: grasped; dotted grey: "
            "missed. Circles are the objects in their size.",
        )
        + "<h2>Activation and weights (Fig. 8)</h2>\n"
        + _figure(
            _svg(figures.fig8(agent)),
            "Top: the arm's map for an object seen, and the weights from one neuron of the eye's "
            "map. Bottom: weights from the fovea to the neurons of the small and of the big "
            "object's hand.",
        )
    )


def _sight(comparison: Comparison) -> str:
    return "<h2>What the eye sees</h2>\n" + _figure(
        _svg(figures.sight(sights(comparison.settings.config))),
        "Objects of each size: the eye's view, the fovea in its middle, and the edges there, which "
        "tell the hand the size.",
    )


def _made(comparison: Comparison, command: str) -> str:
    settings, protocol = comparison.settings, comparison.task.protocol
    facts = {
        "config": comparison.to_json()["config"],
        "seeds": ", ".join(map(str, range(settings.seeds))),
        "cases": f"protocol {protocol}, split test, {settings.cases:,} for each seed",
        "processors": str(os.cpu_count()),
        "time": f"{comparison.seconds:.0f} s in all",
        **{name: found or "not installed" for name, found in versions().items()},
    }
    listed = "".join(f"<dt>{escape(k)}</dt><dd>{escape(v)}</dd>" for k, v in facts.items())
    return (
        f"<h2>How it was made</h2>\n<pre>{escape(command)}</pre>\n<dl>{listed}</dl>\n"
        '<p class="note">All numbers of this page are in results.json beside it. The paper: D. '
        "Caligiore, T. Ferrauto, D. Parisi, N. Accornero, M. Capozza, G. Baldassarre: Using motor "
        "babbling and Hebb rules for modeling the development of reaching with obstacles and "
        "grasping (2008).</p>\n"
    )


def _figure(source: str, caption: str) -> str:
    text = escape(caption)
    return f'<figure><img src="{source}" alt="{text}"><figcaption>{text}</figcaption></figure>\n'


def _svg(figure: Any) -> str:
    return f"data:image/svg+xml;base64,{b64encode(figures.svg(figure)).decode()}"


def _png(data: bytes) -> str:
    return f"data:image/png;base64,{b64encode(data).decode()}"


SECTIONS: dict[str, tuple[Callable[[Comparison], str], ...]] = {
    "reach": (
        _table,
        _curves,
        _movement,
        _trajectories_of("hebb-paper"),
        _trajectories_of("hebb-conjunctive"),
        _weights,
        _generators,
    ),
    "grasp": (_table, _curves, _grasp, _hands, _sight),
}
"""What the page of a task shows between its head and how it was made."""
