"""Tables I and II for the terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from gym_babble.study.rates import OUTCOMES, share
from gym_babble.study.tables import (
    INTERVALS,
    plain_table,
    rate_cell,
    rate_cells,
    rates_table,
    stacked,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rich.table import Table
    from rich.text import Text

__all__ = ["table1_table", "table2_tables"]


def table1_table(document: dict[str, Any], title: str) -> Table:
    """`TableOne.to_json()` as a table: the paper, each seed, and means and ranges of seeds."""
    table = rates_table(title, "legal")
    table.add_row("the paper", *rate_cells(document["paper"]), "≈.20")
    for seed in document["by_seed"]:
        table.add_row(f"seed {seed['seed']}", *rate_cells(seed), share(seed["legal_rate"]))
    means = document["over_seeds"]
    if means["seeds"] > 1:
        cells = [_mean_cell(means[name]) for name in (*OUTCOMES, "legal_rate")]
        table.add_row(stacked("mean", "range of seeds", "bold"), *cells)
    z = ", ".join(
        f"{name} {z:+.1f}" for name, z in document["z_from_paper"].items() if z is not None
    )
    table.caption = (
        "Of each seed: 95 % Wilson intervals over its cases. Difference from the paper over its "
        f"standard error, all cases taken as independent: {z.replace('_', ' ')}."
    )
    return table


def _mean_cell(spread: dict[str, float]) -> Text:
    """A mean of seeds, and their range."""
    return stacked(share(spread["mean"]), f"{share(spread['min'])}–{share(spread['max'])}")


def table2_tables(document: dict[str, Any]) -> list[Table]:
    """`TableTwo.to_json()` as tables: hands as in the paper, rates of each fact, and holding."""
    sizes = document["sizes"]
    paper = [document["paper"]["small"], document["paper"]["big"]]
    names = [f"{100 * size['diameter']:g} cm" for size in sizes]
    # The paper's small and big objects (docs/grasping.md); other sizes have no counterpart.
    printed = dict(zip(("2.4 cm", "6 cm"), paper, strict=True))
    learnt = [stacked(of, "spread") for of in ("recalled", "babbled")]
    heads: list[str | Text] = ["", *learnt, "paper", "paper's\nideal"]
    hands = plain_table("Table II: equilibrium points, 90° − flexion [deg]", heads)
    for name, size in zip(names, sizes, strict=True):
        for digit, found in size["hand"].items():
            cells = [
                "–"
                if found[mean] is None
                else stacked(f"{found[mean]:.2f}", f"{found[spread]:.2f}")
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
            known = printed.get(name) if protocol == "table2" else None
            theirs = [share(known["reach"]), share(known["held"])] if known else ["", ""]
            for title, cases, shares in _fact_rows(found):
                rates.add_row(title or f"{name}, {protocol}", cases, *shares, *theirs)
                theirs = ["", ""]
    rates.caption = INTERVALS
    return [hands, rates, *([_hold_table(document["hold"])] if document["hold"] else [])]


def _fact_rows(found: dict[str, Any]) -> list[tuple[str, str, list[Text]]]:
    """Title, cases and cells of a protocol's rows: means of several seeds, then each seed."""
    facts, by_seed = ("reach", "palm_reach", "held"), found["by_seed"]
    each = [
        (
            f"  seed {one['seed']}" if len(by_seed) > 1 else "",
            f"{one['cases']:,}",
            [rate_cell(one[fact]) for fact in facts],
        )
        for one in by_seed
    ]
    if len(by_seed) == 1:
        return each
    cells = [_mean_cell(found["over_seeds"][fact]) for fact in facts]
    return [("", f"{len(by_seed)} seeds", cells), *each]


def _hold_table(rates: Sequence[dict[str, Any]]) -> Table:
    table = plain_table(
        "\nHeld through 10 s of arm motion without support",
        [
            *("diameter", "held", "of", "rate"),
            *(stacked("deepest", "mm"), stacked("flexion", "thumb, finger")),
        ],
    )
    for rate in rates:
        thumb, finger = rate["flexion_deg"]
        table.add_row(
            f"{100 * rate['diameter']:g} cm",
            str(rate["held"]),
            str(rate["trials"]),
            rate_cell(rate),
            f"{rate['penetration_mm']:.2f}",
            f"{thumb:.1f}° {finger:.1f}°",
        )
    return table
