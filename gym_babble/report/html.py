"""HTML of figures and of rows of a table."""

from __future__ import annotations

from base64 import b64encode
from html import escape
from typing import TYPE_CHECKING, Any

from gym_babble.study.rates import share
from gym_babble.viz.style import svg

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from matplotlib.figure import Figure

    from gym_babble.study.tasks import Task

__all__ = ["figure_html", "named", "png_source", "rates_row", "svg_source"]


def rates_row(name: str, rates: Mapping[str, Any], task: Task, cells: Sequence[str] = ()) -> str:
    """A row with a name in HTML, a bar of outcomes, rates with intervals, and further cells."""
    bar = "".join(
        f'<span class="{outcome}" style="width:{100 * rates[outcome]["rate"]:.1f}%"></span>'
        for outcome in task.outcomes
    )
    shares = "".join(
        f"<td>{share(rates[name]['rate'])}"
        f"<small>{share(rates[name]['low'])}–{share(rates[name]['high'])}</small></td>"
        for name in task.rates
    )
    return (
        f'<tr><td>{name}</td><td><div class="bar">{bar}</div></td>{shares}'
        f"{''.join(f'<td>{cell}</td>' for cell in cells)}</tr>\n"
    )


def named(title: str, detail: str) -> str:
    """A name with a detail below it."""
    return f"{escape(title)}<small>{escape(detail)}</small>"


def figure_html(source: str, caption: str) -> str:
    """A picture with a caption."""
    text = escape(caption)
    return f'<figure><img src="{source}" alt="{text}"><figcaption>{text}</figcaption></figure>\n'


def svg_source(figure: Figure) -> str:
    """A figure as the source of an `img`."""
    return f"data:image/svg+xml;base64,{b64encode(svg(figure)).decode()}"


def png_source(data: bytes) -> str:
    """A PNG file as the source of an `img`."""
    return f"data:image/png;base64,{b64encode(data).decode()}"
