"""Style and files of all figures. Needs the extra `figures`."""

from __future__ import annotations

from functools import wraps
from io import BytesIO
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

from gym_babble.errors import ConfigError, MissingExtraError
from gym_babble.files import write_file

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = [
    "FAINT",
    "GRID",
    "INK",
    "LEFT",
    "OBJECT",
    "RED",
    "RIGHT",
    "check_format",
    "row_of_axes",
    "save",
    "styled",
    "svg",
]

P = ParamSpec("P")
T = TypeVar("T")

INK, FAINT, GRID, RED = "#1f2933", "#9aa5b1", "#e4e7eb", "#b42318"

LEFT, RIGHT = "#1f6fb2", "#c2571a"

OBJECT = "#fbe3e0"

STYLE: Any = {
    "font.size": 9,
    "axes.titlesize": 9,
    "axes.titlelocation": "left",
    "axes.edgecolor": FAINT,
    "axes.labelcolor": INK,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "xtick.color": INK,
    "ytick.color": INK,
    "legend.frameon": False,
    "text.color": INK,
    "svg.hashsalt": "gym-babble",  # Identical figures give identical files.
}


def _matplotlib() -> Any:
    try:
        import matplotlib as mpl
    except ImportError as error:
        raise MissingExtraError("matplotlib", "figures") from error
    return mpl


def styled(draw: Callable[P, T]) -> Callable[P, T]:
    """Makes a drawing function use this module's style and ignore the user's settings."""

    @wraps(draw)
    def styled(*args: P.args, **kwargs: P.kwargs) -> T:
        with _matplotlib().rc_context(STYLE):
            return draw(*args, **kwargs)

    return styled


def row_of_axes(
    size: tuple[float, float], columns: int, **kwargs: Any
) -> tuple[Figure, list[Axes]]:
    """A figure with a row of axes. pyplot would keep the figure and need a display."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=size, layout="constrained")
    axes = figure.subplots(1, columns, squeeze=False, **kwargs)
    return figure, list(axes[0])


@styled
def svg(figure: Figure) -> bytes:
    """The figure as an SVG file. The same figure gives the same bytes."""
    buffer = BytesIO()
    figure.savefig(
        buffer, format="svg", metadata={"Date": None}, transparent=True, bbox_inches="tight"
    )
    return buffer.getvalue()


def check_format(path: Path) -> None:
    """Raises `ConfigError` if matplotlib cannot write files with this ending."""
    _matplotlib()
    from matplotlib.backend_bases import FigureCanvasBase

    known = FigureCanvasBase.get_supported_filetypes()
    if path.suffix.removeprefix(".") not in known:
        raise ConfigError(
            f"{path}: the name of a picture must end with one of {', '.join(sorted(known))}"
        )


@styled
def save(figure: Figure, path: Path) -> None:
    """Writes the figure; the file's ending chooses the format (png, svg, pdf ...)."""
    check_format(path)
    buffer, kind = BytesIO(), path.suffix.removeprefix(".")
    figure.savefig(buffer, format=kind, dpi=160, bbox_inches="tight")
    write_file(path, buffer.getvalue())
