"""The page: numbers, charts and pictures in the templates. Needs the extra `study`."""

from __future__ import annotations

from base64 import b64encode
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gym_babble.errors import MissingExtraError
from gym_babble.report.formats import count, p_value, seconds
from gym_babble.report.svg import inline_svg
from gym_babble.study.rates import share
from gym_babble.viz.charts import look

if TYPE_CHECKING:
    from collections.abc import Mapping

    from gym_babble.report.charts import Chart

__all__ = ["drawn", "environment", "page", "picture"]

TEMPLATES = Path(__file__).with_name("templates")

DASHES = {"-": "", "--": "7 3", ":": "3 3", "-.": "9 3 3 3"}
"""Line styles of matplotlib as `stroke-dasharray`."""

FACTS = {"reach": "any touch", "palm_reach": "touch of palm"}


def environment() -> Any:
    """The templates, with autoescaping: a name from a store is never markup.

    Raises:
        MissingExtraError: Jinja2 is not installed.
    """
    try:
        import jinja2
    except ImportError as error:
        raise MissingExtraError("jinja2", "study") from error
    found = jinja2.Environment(
        loader=jinja2.FileSystemLoader(TEMPLATES),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    found.filters.update(
        share=share,
        words=lambda name: name.replace("_", " "),
        fact=lambda name: FACTS[name],
        colour=lambda series: look(series)[0],
        dashes=lambda series: DASHES[look(series)[1]],
        count=count,
        cost=lambda value, axis: seconds(value) if axis == "cpu_seconds" else count(value),
        time=seconds,
        p=p_value,
        ratio=lambda value: f"{value:.3g}",
        settings=lambda table: ", ".join(f"{k} = {v}" for k, v in table.items()),
    )
    return found


def page(content: Mapping[str, Any]) -> str:
    """The whole page.

    Args:
        content: The variables of `page.html`.
    """
    return str(environment().get_template("page.html").render(content))


def drawn(chart: Chart, file: bytes) -> dict[str, str]:
    """A chart, and its SVG file, for the macro `figure`."""
    name = chart.name.replace(".", "-")
    return {"svg": inline_svg(file, name, chart.caption), "caption": chart.caption}


def picture(png: bytes, caption: str) -> dict[str, str]:
    """A picture for the macro `picture`."""
    return {"png": b64encode(png).decode(), "caption": caption}
