"""What `check` and `hand_in` return: text in a terminal, HTML in a notebook."""

from __future__ import annotations

import base64
import html
from dataclasses import dataclass, field
from io import BytesIO
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["HandedIn", "Result", "State"]

State: TypeAlias = Literal["right", "wrong", "unanswered"]

HEADS: dict[State, tuple[str, str]] = {
    "right": ("Right", "#2e7d32"),
    "wrong": ("Not right yet", "#c25e00"),
    "unanswered": ("Not answered yet", "#7b8794"),
}
"""Head and colour of each state. The head says it too, so that nobody needs the colour."""


@dataclass(frozen=True, kw_only=True)
class Result:
    """What `check` says of an answer."""

    exercise: str
    """Id of the exercise."""
    state: State
    """Whether the answer is right, wrong, or missing."""
    text: str
    """What is right or wrong about it."""
    hint: str = ""
    """What helps after a wrong answer."""
    note: str = ""
    """Anything else, such as why there is no picture."""
    figure: Any = field(default=None, repr=False, compare=False)
    """A matplotlib figure of what was seen, or None."""

    @property
    def right(self) -> bool:
        """Whether the answer is right."""
        return self.state == "right"

    def __repr__(self) -> str:
        head = f"{self.exercise}  {HEADS[self.state][0]}. {self.text}"
        hint = self.hint and f"Hint: {self.hint}"
        return "\n".join(line for line in (head, hint, self.note) if line)

    def _repr_html_(self) -> str:
        head, colour = HEADS[self.state]
        name = f"{html.escape(self.exercise)} {head}."
        parts = [f"<strong>{name}</strong> {html.escape(self.text)}"]
        if self.hint:
            parts.append(f"<br><em>Hint:</em> {html.escape(self.hint)}")
        if self.note:
            parts.append(f"<br><small>{html.escape(self.note)}</small>")
        if self.figure is not None:
            parts.append(f"<br>{_picture(self.figure, self.exercise)}")
        return (
            f'<div data-exercise="{html.escape(self.exercise)}" data-state="{self.state}" '
            f'style="border-left: 4px solid {colour}; padding: 0.3em 0.8em;">{"".join(parts)}</div>'
        )


@dataclass(frozen=True, kw_only=True)
class HandedIn:
    """What `hand_in` has done."""

    path: Path | None
    """The file, or None if nothing was written."""
    text: str
    """What was written, or why nothing was."""
    states: dict[str, str]
    """State of each exercise of the lesson, in words."""

    def __repr__(self) -> str:
        return "\n".join(
            [self.text, *(f"  {name}  {state}" for name, state in self.states.items())]
        )

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><td>{html.escape(name)}</td><td>{html.escape(state)}</td></tr>"
            for name, state in self.states.items()
        )
        return f"<div><p>{html.escape(self.text)}</p><table>{rows}</table></div>"


def _picture(figure: Any, exercise: str) -> str:
    buffer = BytesIO()
    figure.savefig(buffer, format="png", dpi=130)
    data = base64.b64encode(buffer.getvalue()).decode()
    width = round(figure.get_figwidth() * 90)
    return (
        f'<img alt="Your answer to {html.escape(exercise)} and what is expected" width="{width}" '
        f'style="max-width: 100%; background: white;" src="data:image/png;base64,{data}">'
    )
