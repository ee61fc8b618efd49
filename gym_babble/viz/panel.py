"""One agent's part of a film. Needs Pillow, which the extras `figures` and `video` bring."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble.agents import HebbBabbling
from gym_babble.viz.maps import AgentMaps, colour_map
from gym_babble.viz.text import INK, PALE, draw_on, font, shortened

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from gym_babble.viz.episode import Episode
    from gym_babble.viz.maps import MapPicture

__all__ = ["Panel", "PanelSize"]

WHITE, GREEN, RED, GREY = (255, 255, 255), (31, 122, 77), (180, 35, 24), (82, 96, 109)
OUTCOME = {"success": GREEN, "timeout": GREY}
"""Colours of outcomes; others are red."""


@dataclass(frozen=True)
class PanelSize:
    """Measures of all panels of a film [pixel]."""

    width: int
    """Width of the panel, and of the picture of the robot."""
    map_rows: int
    """Rows of maps."""

    @property
    def margin(self) -> int:
        """Space around text and between maps."""
        return max(4, self.width // 60)

    @property
    def text(self) -> int:
        """Size of small text."""
        return max(12, round(self.width * 0.034))

    @property
    def header(self) -> int:
        """Height of title and detail."""
        return 2 * round(self.width * 0.07)

    @property
    def tile(self) -> int:
        """Edge of a map."""
        return (self.width - 2 * self.margin) // 3

    @property
    def row(self) -> int:
        """Height of a row of maps with their titles."""
        return self.tile + self.text + 2 * self.margin

    @property
    def height(self) -> int:
        """Height of the panel."""
        return self.header + self.width + self.map_rows * self.row

    @property
    def eye(self) -> int:
        """Edge of the eye's view."""
        return 2 * round(self.width * 0.14)


class Panel:
    """Title, picture of the robot with the eye's view inset, and the maps of a Hebb agent.

    Args:
        title: What to call the agent.
        detail: A line on what it is or where it acts; or one for each moment of the episode.
        episode: What it played.
        camera: Camera of the large picture.
    """

    def __init__(
        self,
        title: str,
        detail: str | Sequence[str],
        episode: Episode,
        camera: str = "third_person",
    ) -> None:
        self.title, self.detail, self.episode, self.camera = title, detail, episode, camera
        agent = episode.agent
        self.maps = AgentMaps(agent) if isinstance(agent, HebbBabbling) else None
        self._header: tuple[str, NDArray[np.uint8]] | None = None
        self._rows: tuple[Any, NDArray[np.uint8]] | None = None

    def draw(self, moment: int, size: PanelSize) -> NDArray[np.uint8]:
        """The panel (height, width, 3) at a moment; after the end it stands still."""
        moment = min(moment, self.episode.moments - 1)
        panel = np.full((size.height, size.width, 3), 255, np.uint8)
        panel[: size.header] = self._draw_header(moment, size)
        panel[size.header : size.header + size.width] = self._draw_view(moment, size)
        if self.maps is not None:
            rows = self._draw_rows(self.maps, moment, size)
            top = size.header + size.width
            panel[top : top + len(rows)] = rows
        return panel

    def _draw_rows(self, maps: AgentMaps, moment: int, size: PanelSize) -> NDArray[np.uint8]:
        """The rows of maps; during a whole movement they stay the same."""
        observation = self.episode.observations[moment]
        if self._rows is None or self._rows[0] is not observation:
            drawn = [_draw_maps(row, size) for row in maps.pictures(observation)]
            self._rows = observation, np.vstack(drawn)
        return self._rows[1]

    def _draw_header(self, moment: int, size: PanelSize) -> NDArray[np.uint8]:
        detail = self.detail if isinstance(self.detail, str) else self.detail[moment]
        shape = (size.header, size.width, 3)
        if self._header is None or self._header[0] != detail or self._header[1].shape != shape:
            blank = np.full(shape, 255, np.uint8)
            large, small = font(round(size.header * 0.42)), font(size.text)
            width = size.width - 2 * size.margin
            with draw_on(blank) as draw:
                at = (size.margin, size.header // 16)
                draw.text(at, shortened(self.title, large, width), INK, large)
                at = (size.margin, size.header * 9 // 16)
                draw.text(at, shortened(detail, small, width), PALE, small)
            self._header = detail, blank
        return self._header[1]

    def _draw_view(self, moment: int, size: PanelSize) -> NDArray[np.uint8]:
        """The robot, the eye's view in a corner, and time or outcome."""
        env, edge = self.episode.env, size.eye
        view = env.picture(self.camera, (size.width, size.width), moment)
        top, left = size.margin, size.width - size.margin - edge
        frame = slice(top - 2, top + edge + 2), slice(left - 2, left + edge + 2)
        view[frame] = 255
        inside = slice(top, top + edge), slice(left, left + edge)
        view[inside] = env.picture("eye", (edge, edge), moment)
        small = font(size.text)
        with draw_on(view) as draw:
            draw.text((left + 4, top + 2), "eye", INK, small)
            self._say(draw, moment, size)
        return view

    def _say(self, draw: Any, moment: int, size: PanelSize) -> None:
        """Writes the time, and at the end the outcome, into the lower left corner."""
        ended = moment == self.episode.moments - 1
        text, colour = f"{moment / self.episode.control_hz:.2f} s", INK
        letters = font(round(size.text * 1.25))
        if ended:
            text = f"{self.episode.outcome.replace('_', ' ')}, {text}"
        space = size.margin
        at = (2 * space, size.width - 2 * space)
        if ended:
            x0, y0, x1, y1 = draw.textbbox(at, text, font=letters, anchor="ls")
            box = (x0 - space, y0 - space, x1 + space, y1 + space)
            fill, colour = OUTCOME.get(self.episode.outcome, RED), WHITE
            draw.rounded_rectangle(box, radius=space, fill=fill)
        draw.text(at, text, colour, letters, anchor="ls")


def _draw_maps(pictures: tuple[MapPicture, ...], size: PanelSize) -> NDArray[np.uint8]:
    """A row of maps with their titles."""
    row = np.full((size.row, size.width, 3), 255, np.uint8)
    top = size.text + 2 * size.margin
    tile, small = size.tile, font(size.text)
    for k, picture in enumerate(pictures):
        left = k * (tile + size.margin)
        row[top : top + tile, left : left + tile] = PALE
        row[top + 1 : top + tile - 1, left + 1 : left + tile - 1] = colour_map(picture, tile - 2)
    with draw_on(row) as draw:
        for k, picture in enumerate(pictures):
            left = k * (tile + size.margin)
            title = shortened(picture.title, small, tile)
            draw.text((left + 1, top - 3), title, INK, small, anchor="ls")
            if picture.mark is not None:
                _draw_mark(draw, picture, left, top, tile)
    return row


def _draw_mark(draw: Any, picture: MapPicture, left: int, top: int, tile: int) -> None:
    """A ring where the map is read out."""
    assert picture.mark is not None
    side = len(picture.values)
    x, y = ((0.5 + share * (side - 1)) * tile / side for share in picture.mark)
    for radius, colour, width in ((tile / 18 + 1, WHITE, 4), (tile / 18, RED, 2)):
        box = (left + x - radius, top + y - radius, left + x + radius, top + y + radius)
        draw.ellipse(box, outline=colour, width=width)
