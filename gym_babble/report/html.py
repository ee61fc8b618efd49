"""HTML of figures and of rows of a table."""

from __future__ import annotations

from base64 import b64encode
from html import escape
from typing import TYPE_CHECKING, Any

from gym_babble.study.rates import share
from gym_babble.viz.style import svg

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure

    from gym_babble.study.tasks import Task

__all__ = ["figure_html", "png_source", "rates_row", "svg_source"]


def rates_row(
    title: str, detail: str, rates: dict[str, Any], task: Task, cells: Sequence[str]
) -> str:
    """A row with a contender's name, a bar of its outcomes, its rates, and further cells."""
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
