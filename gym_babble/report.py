"""The report of a comparison: one HTML file with its pictures inside."""

from __future__ import annotations

import json
import os
from base64 import b64encode
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble import figures
from gym_babble.agents import HebbBabbling
from gym_babble.doctor import versions
from gym_babble.film import contact_sheet, png, record
from gym_babble.loading import LoadedAgent
from gym_babble.reproduce import starts_without_case, switched, ways, weight_sets
from gym_babble.scenarios import scenarios
from gym_babble.tables import OUTCOMES, paper_tally, share, tally

if TYPE_CHECKING:
    from gym_babble.compare import Comparison, Result
    from gym_babble.scenarios import Scenario

__all__ = ["write_report"]

HEAD = (
    "agent",
    "",
    "success",
    "collision",
    "joint limit",
    "timeout",
    "movements",
    "steps",
    "clock",
)


def write_report(comparison: Comparison, folder: Path, command: str) -> list[Path]:
    """Writes index.html and results.json into a folder, and returns both.

    Args:
        comparison: What to report.
        folder: Made if it is not there.
        command: The command that makes it again.

    Raises:
        MissingExtraError: matplotlib is not there.
    """
    folder.mkdir(parents=True, exist_ok=True)
    results, page = folder / "results.json", folder / "index.html"
    results.write_text(json.dumps(comparison.to_json(), indent=2) + "\n", encoding="utf-8")
    page.write_text(_page(comparison, command), encoding="utf-8")
    return [page, results]


def _page(comparison: Comparison, command: str) -> str:
    style = Path(__file__).with_name("report.css").read_text(encoding="utf-8")
    sections = (
        _table(comparison),
        _curves(comparison),
        _movement(comparison),
        *(_trajectories(comparison, key) for key in ("hebb-paper", "hebb-conjunctive")),
        _weights(comparison),
        _generators(),
        _made(comparison, command),
    )
    return (
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>Reaching: Hebb babbling beside PPO</title>\n<style>\n{style}</style></head>\n"
        f"<body><main>\n{_lead(comparison)}\n{''.join(sections)}</main></body></html>\n"
    )


def _lead(comparison: Comparison) -> str:
    best = [
        f"{escape(result.contender.title)} ({escape(result.contender.detail)}) "
        f"{share(result.pooled.rate('success'))}"
        for result in comparison.results
        if result.mean("movements")
    ]
    found = f"Success here: {'; '.join(best)}; the paper .670." if best else ""
    return (
        "<h1>Reaching around an obstacle: Hebb babbling beside PPO</h1>\n"
        '<p class="lead">An arm learns to reach a target behind an obstacle: by motor babbling and '
        "a Hebb rule, as Caligiore et al. (2008) modelled it, and by reinforcement learning. All "
        f"agents meet the same cases in the same simulation. {found}</p>"
    )


def _table(comparison: Comparison) -> str:
    head = "".join(f"<th>{name}</th>" for name in HEAD)
    paper = _row(
        "the paper", "Table I", paper_tally(), ["20,000<small>legal ≈ .20</small>", "", ""]
    )
    rows = "".join(_result_row(result) for result in comparison.results)
    left_out = "".join(
        f'<p class="note">Left out: {escape(key)}: {escape(why)}.</p>'
        for key, why in comparison.skipped.items()
    )
    key = "".join(f'<i class="{name}"></i>{name.replace("_", " ")}' for name in OUTCOMES)
    settings = comparison.settings
    return (
        f"<h2>Table I</h2>\n<p>{settings.cases:,} legal cases that no agent learnt from"
        f"{f', for each of {settings.seeds} seeds' if settings.seeds > 1 else ''}; under each rate "
        "its 95 % Wilson interval. Legal means that a babbled movement solved the case: each can "
        "be solved."
        f'</p>\n<div class="scroll"><table><tr>{head}</tr>\n'
        f"{paper.replace('<tr>', '<tr class=paper>')}{rows}</table></div>\n"
        f'<p class="note key">{key}</p>\n'
        '<p class="note">Movements: legal ones learnt from for Hebb, with the share of babbled '
        "movements that were legal; episodes for PPO. Steps: control steps simulated while "
        "learning, in millions; a whole movement counts with all of its steps. Clock: seconds of "
        "learning on this machine. With several seeds, means.</p>\n"
        f"{left_out}"
    )


def _result_row(result: Result) -> str:
    cells = ["", "", ""]
    if result.mean("movements"):
        movements = f"{result.mean('movements'):,.0f}"
        if result.legal_rate is not None:
            legal = result.mean("legal_movements")
            movements = f"{legal:,.0f}<small>legal {share(result.legal_rate)}</small>"
        steps = f"{result.mean('control_steps') / 1e6:.1f} M"
        cells = [movements, steps, f"{result.mean('seconds'):.0f} s"]
    return _row(result.contender.title, result.contender.detail, tally(result.pooled), cells)


def _row(title: str, detail: str, rates: dict[str, Any], cells: list[str]) -> str:
    bar = "".join(
        f'<span class="{name}" style="width:{100 * rates[name]["rate"]:.1f}%"></span>'
        for name in OUTCOMES
    )
    shares = "".join(
        f"<td>{share(rates[name]['rate'])}"
        f"<small>{share(rates[name]['low'])}–{share(rates[name]['high'])}</small></td>"
        for name in OUTCOMES
    )
    return (
        f"<tr><td>{escape(title)}<small>{escape(detail)}</small></td>"
        f'<td><div class="bar">{bar}</div></td>{shares}'
        f"{''.join(f'<td>{cell}</td>' for cell in cells)}</tr>\n"
    )


def _curves(comparison: Comparison) -> str:
    if not any(trained.curve for result in comparison.results for trained in result.trained):
        return ""
    return "<h2>While learning</h2>\n" + _figure(
        _svg(figures.learning_curves(comparison)),
        "Success on 200 validation cases, which are none of the tests. The dotted line is the "
        "paper's .67 on its tests. A curve begins at its first measured point.",
    )


def _movement(comparison: Comparison) -> str:
    """A success of the first agent of the table, to be looked at."""
    result = comparison.results[0]
    trained = result.trained[0]
    body = comparison.settings.body
    cases = scenarios("table1", comparison.settings.cases, body=body)
    good = [
        case
        for case, outcome in zip(cases, result.tests[0].outcomes, strict=True)
        if outcome == "success"
    ]
    case = min(good or cases, key=_off_stage)
    loaded = LoadedAgent(trained.agent, trained.env_id, body, trained.env_kwargs)
    film = record(loaded, options={"scenario": case}, size=600)
    near = [frame[60:400, 80:420] for frame in film.frames]  # The arm keeps to the middle.
    eye = record(loaded, options={"scenario": case}, camera="eye", size=630).frames[0]
    return (
        f"<h2>A movement</h2>\n<p>{escape(result.contender.title)} on case {case['index']}: "
        f"{film.outcome.replace('_', ' ')}.</p>\n"
        '<div class="photos">'
        + _figure(
            _png(png(eye)), "What the eye sees before: 630 × 630 pixels, 120°, on the target."
        )
        + _figure(_png(png(contact_sheet(near))), "The movement, row by row.")
        + "</div>\n"
    )


def _off_stage(case: Scenario) -> float:
    """How little a case has to show: a short way, or one far from the middle of the picture."""
    start, target = np.array(case["start"]), np.array(case["target"])
    middle = 0.5 * (start + target)
    return float(np.linalg.norm(middle - (0.0, 0.3)) - np.linalg.norm(target - start))


def _trajectories(comparison: Comparison, key: str) -> str:
    result = comparison.result(key)
    if result is None:
        return ""
    body, agent = comparison.settings.body, result.trained[0].agent
    cases = scenarios("fig4", body=body)
    missing = starts_without_case(body)
    found = ways(agent, cases, body)
    turned = ways(agent, [switched(case) for case in cases], body)
    return f"<h2>Trajectories of {escape(result.contender.title)} (Fig. 4)</h2>\n" + _figure(
        _svg(figures.fig4(found, turned, missing)),
        "Four targets (circles) and 36 starts around each (dots), obstacles not drawn. Bold: "
        "success; dotted: failure, up to a red cross. Blue curves left, orange right. Grey "
        f"crosses: {len(missing)} starts without a case, out of reach or with the arm in the "
        "obstacle. Right: obstacle and start in each other's place.",
    )


def _weights(comparison: Comparison) -> str:
    result = comparison.result("hebb-paper")
    if result is None or not isinstance(result.trained[0].agent, HebbBabbling):
        return ""
    sets = weight_sets(result.trained[0].agent)
    return "<h2>Weights (Fig. 5)</h2>\n" + _figure(
        _svg(figures.fig5(sets)),
        "Weights from input neurons to the output map. The neurons fall into two compact sets: one "
        "makes the movement curve left, the other right. The mean of one set correlates "
        f"{share(sets.mirror_correlation)} with the mirrored mean of the other.",
    )


def _generators() -> str:
    return "<h2>Pattern generators (Fig. 2)</h2>\n" + _figure(
        _svg(figures.fig2()),
        "The path of a movement for several b1, with b2 = 1 − b1, and the same between a hand and "
        "a target. b1 above ½ curves left.",
    )


def _made(comparison: Comparison, command: str) -> str:
    settings = comparison.settings
    facts = {
        "body": comparison.to_json()["body"],
        "seeds": ", ".join(map(str, range(settings.seeds))),
        "cases": f"protocol table1, split test, {settings.cases:,} for each seed",
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
