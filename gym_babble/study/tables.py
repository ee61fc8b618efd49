"""Rates with intervals: as JSON, and in tables for the terminal."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble.study.evaluation import wilson
from gym_babble.study.tasks import REACH

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from rich.table import Table

    from gym_babble.study.evaluation import Evaluation
    from gym_babble.study.tasks import Task

__all__ = [
    "OUTCOMES",
    "counted",
    "doctor_table",
    "info_tables",
    "paper_tally",
    "plain_table",
    "rate_cells",
    "rate_heads",
    "rates_table",
    "share",
    "t_interval",
    "table1_table",
    "table2_tables",
    "tally",
]

OUTCOMES = REACH.outcomes
"""How an episode of reaching can end."""

# 97.5 % points of Student's t for 1, 2, ... 9 degrees of freedom.
T_QUANTILES = (12.7062, 4.3027, 3.1824, 2.7764, 2.5706, 2.4469, 2.3646, 2.3060, 2.2622)


def tally(result: Evaluation, task: Task = REACH) -> dict[str, Any]:
    """Number of cases; of each outcome and fact count, rate and 95 % Wilson interval."""
    counts = {name: result.count(name) for name in task.outcomes}
    counts |= {name: sum(result.facts[name]) for name in task.facts}
    return counted(counts, len(result.outcomes))


def paper_tally() -> dict[str, Any]:
    """The paper's Table I in the form of `tally`."""
    assert REACH.paper is not None
    return counted(REACH.paper, sum(REACH.paper.values()))


def counted(counts: Mapping[str, int], n: int) -> dict[str, Any]:
    """Counts among `n` cases in the form of `tally`."""
    return {"cases": n, **{name: _rate(count, n) for name, count in counts.items()}}


def _rate(count: int, n: int) -> dict[str, Any]:
    low, high = wilson(count, n)
    return {"count": count, "rate": count / n, "low": low, "high": high}


def t_interval(values: Sequence[float]) -> tuple[float, float] | None:
    """95 % interval of the mean over independent values (Student's t); None for a single one."""
    n = len(values)
    if n < 2:
        return None
    mean, spread = float(np.mean(values)), float(np.std(values, ddof=1))
    half = _t_quantile(n - 1) * spread / math.sqrt(n)
    return mean - half, mean + half


def _t_quantile(freedom: int) -> float:
    """97.5 % point of Student's t: tabled, from 10 on by the expansion of Cornish and Fisher."""
    if freedom <= len(T_QUANTILES):
        return T_QUANTILES[freedom - 1]
    z = 1.959964
    first = (z**3 + z) / 4
    second = (5 * z**5 + 16 * z**3 + 3 * z) / 96
    third = (3 * z**7 + 19 * z**5 + 17 * z**3 - 15 * z) / 384
    return z + first / freedom + second / freedom**2 + third / freedom**3


def share(rate: float) -> str:
    """A rate in four characters: three digits without a leading zero, or 1.00."""
    return f"{rate:.3f}".removeprefix("0")[:4]


def rate_heads(task: Task = REACH, between: str = " ") -> list[str]:
    """Heads of the columns of `rate_cells`, with something `between` words."""
    touches = ["any touch\n[dim]of palm[/]"] if task.facts else []
    return [*(name.replace("_", between) for name in task.outcomes), *touches]


def rate_cells(rates: dict[str, Any], task: Task = REACH) -> list[str]:
    """Of each outcome of a `tally` a cell with the rate and the interval; the facts share one."""
    cells = [f"{share(rates[name]['rate'])}\n{_interval(rates[name])}" for name in task.outcomes]
    if task.facts:
        first, second = (share(rates[name]["rate"]) for name in task.facts)
        cells.append(f"{first}\n[dim]{second}[/]")
    return cells


def _interval(rate: dict[str, Any]) -> str:
    return f"[dim]{share(rate['low'])}–{share(rate['high'])}[/]"


def plain_table(
    title: str | None, columns: Sequence[str], *, left: int = 1, padding: int = 1
) -> Table:
    """An empty table without lines; the first `left` columns hold text, the others numbers."""
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    table = Table(
        title=title,
        title_justify="left",
        title_style="bold",
        caption_justify="left",
        box=SIMPLE_HEAD,
        show_edge=False,
        pad_edge=False,
        padding=(0, padding),
    )
    for i, column in enumerate(columns):
        table.add_column(column, justify="left" if i < left else "right", no_wrap=i == 0)
    return table


def rates_table(title: str, *more: str, task: Task = REACH) -> Table:
    """An empty table for `rate_cells`, and more columns."""
    return plain_table(title, ["", *rate_heads(task), *more])


def table1_table(document: dict[str, Any], title: str) -> Table:
    """`TableOne.to_json()` as a table: paper, seeds, pooled, and intervals over seeds."""
    table = rates_table(title, "legal")
    table.add_row("the paper", *rate_cells(document["paper"]), "≈.20")
    for seed in document["by_seed"]:
        table.add_row(f"seed {seed['seed']}", *rate_cells(seed), share(seed["legal_rate"]))
    pooled = document["pooled"]
    table.add_row("[bold]pooled[/]", *rate_cells(pooled), share(pooled["legal_rate"]))
    spreads = document["over_seeds"]
    if spreads["success"]["low"] is not None:
        cells = [
            f"{share(spreads[name]['mean'])}\n{_interval(spreads[name])}"
            for name in (*OUTCOMES, "legal_rate")
        ]
        table.add_row("over seeds\n[dim]t interval[/]", *cells)
    return table


def table2_tables(document: dict[str, Any]) -> list[Table]:
    """`TableTwo.to_json()` in the paper's layout: hands, rates of each reading, and holding."""
    sizes = document["sizes"]
    paper = [document["paper"]["small"], document["paper"]["big"]]
    names = [f"{100 * size['diameter']:g} cm" for size in sizes]
    # The printed sizes stand for these (docs/grasping.md); others have no counterpart.
    printed = dict(zip(("2.4 cm", "6 cm"), paper, strict=True))
    heads = ["", "recalled\n[dim]spread[/]", "babbled\n[dim]spread[/]", "paper", "paper's\nideal"]
    hands = plain_table("Table II: equilibrium points, 90° − flexion [deg]", heads)
    for name, size in zip(names, sizes, strict=True):
        for digit, found in size["hand"].items():
            cells = [
                "–" if found[mean] is None else f"{found[mean]:.2f}\n[dim]{found[spread]:.2f}[/]"
                for mean, spread in (("mean", "spread"), ("babbled_mean", "babbled_spread"))
            ]
            known = printed.get(name, {}).get(digit)
            theirs = [f"{known['mean']:.2f}", f"{known['ideal']:.0f}"] if known else ["", ""]
            hands.add_row(f"{name}, {digit}", *cells, *theirs)
    rates = plain_table(
        "\nReached, and grasped without support",
        ["", "tests", "any part\ntouches", "palm\ntouches", "grasped", "paper:\nreach", "grasp"],
    )
    for name, size in zip(names, sizes, strict=True):
        for protocol, found in size["tests"].items():
            pooled = found["pooled"]
            cells = [
                f"{share(pooled[fact]['rate'])}\n{_interval(pooled[fact])}"
                for fact in ("reach", "palm_reach", "held")
            ]
            known = printed.get(name) if protocol == "table2" else None
            theirs = [share(known["reach"]), share(known["held"])] if known else ["", ""]
            rates.add_row(f"{name}, {protocol}", f"{pooled['tests']:,}", *cells, *theirs)
    return [hands, rates, *([_hold_table(document["hold"])] if document["hold"] else [])]


def _hold_table(rates: Sequence[dict[str, Any]]) -> Table:
    table = plain_table(
        "\nHeld through 10 s of arm motion without support",
        ["diameter", "held", "of", "rate", "deepest\n[dim]mm[/]", "flexion\n[dim]thumb, finger[/]"],
    )
    for rate in rates:
        thumb, finger = rate["flexion_deg"]
        table.add_row(
            f"{100 * rate['diameter']:g} cm",
            str(rate["held"]),
            str(rate["trials"]),
            f"{share(rate['rate'])}\n{_interval(rate)}",
            f"{rate['penetration_mm']:.2f}",
            f"{thumb:.1f}° {finger:.1f}°",
        )
    return table


def info_tables(described: dict[str, Any]) -> list[Table]:
    """An environment's choices and limits, its senses, and its action."""
    facts = plain_table(described["id"], ["", ""], left=2)
    facts.show_header = False
    for name in ("obs", "control", "reward", "max_episode_steps", "control_hz", "reward_threshold"):
        facts.add_row(name, str(described[name]))
    for name in ("reward_terms", "outcomes"):
        facts.add_row(name, ", ".join(described[name]))
    senses, action = described["senses"], [described["action"]]
    return [facts, _entries_table("senses", senses), _entries_table("action", action)]


def _entries_table(title: str, entries: Sequence[dict[str, Any]]) -> Table:
    heads = ["name", "parts", "low", "high", "unit", "meaning"]
    table = plain_table(f"\n{title}", heads, left=len(heads))
    for entry in entries:
        table.add_row(entry["name"], *_parts(entry), entry["unit"], entry["description"])
    return table


def _parts(entry: dict[str, Any]) -> tuple[str, ...]:
    """Labels and bounds of an entry; the parts of a map, which are all alike, are counted."""
    n = len(entry["labels"])
    rows = list(zip(entry["labels"], entry["low"], entry["high"], strict=True))
    if len(set(rows)) == 1 < n:
        rows = [(f"{n} {rows[0][0]}", *rows[0][1:])]
    labels, lows, highs = zip(*rows, strict=True)
    return "\n".join(labels), *("\n".join(f"{x:.4g}" for x in ends) for ends in (lows, highs))


def doctor_table(found: dict[str, Any]) -> Table:
    """What `doctor.examine` found."""
    table = plain_table(None, ["what", "found"], left=2)
    for name, version in found["versions"].items():
        table.add_row(name, version or "[dim]not installed[/]")
    for extra, there in found["extras"].items():
        table.add_row(
            f"extra {extra}", "yes" if there else f"no: pip install 'gym-babble\\[{extra}]'"
        )
    for name in ("platform", "build", "threads"):
        table.add_row(name, str(found[name]))
    state = found["state_hash"]
    told = f"{state}: as it should be"
    if not found["same_bits"]:
        told = f"[red]{state}, expected {found['state_hash_expected']}: `make setup` builds anew[/]"
    table.add_row("state after 20 steps of seed 0", told)
    table.add_row("a step through gymnasium.make", f"{found['step_us']:.1f} µs")
    table.add_row("a step in a batch of 64", f"{found['step_in_batch_of_64_us']:.1f} µs")
    return table
