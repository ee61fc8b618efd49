"""Tables in Markdown, and the cells that many of them have."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gym_babble.study.rates import share

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

SIZES = {"small": "2.4 cm", "big": "6 cm"}


def markdown(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A Markdown table."""
    lines = [heads, ["---"] * len(heads), *rows]
    return "".join(f"| {' | '.join(cells)} |\n" for cells in lines)


def span(low: float, high: float) -> str:
    """A range of rates."""
    return f"{share(low)}–{share(high)}"


def interval(rate: dict[str, float]) -> str:
    """The 95 % interval of one seed's rate."""
    return span(rate["low"], rate["high"])
