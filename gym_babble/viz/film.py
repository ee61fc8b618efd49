"""Agents side by side on the same cases, frame by frame."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gym_babble.viz.panel import PanelSize
from gym_babble.viz.text import INK, draw_on, font

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from gym_babble.viz.panel import Panel

__all__ = ["Film", "Scene", "panel_width"]

GAP = 8
"""Space between panels [pixel]."""
COLUMNS = 4
"""Most panels in a row."""
WIDTH = 1280
"""Width of a film of several panels [pixel], unless the panels' own is given."""
SLACK = 1e-6
"""Share of a frame by which times may be wrong."""
HOLD_S = 1.5
"""How long the last picture of a case stands still [s]."""


def panel_width(panels: int) -> int:
    """Width at which so many panels fit into 1280 pixels, and 480 at most; even."""
    columns = min(panels, COLUMNS)
    return min(480, (WIDTH - (columns - 1) * GAP) // columns // 2 * 2)


@dataclass(frozen=True)
class Scene:
    """One case, played by each agent."""

    panels: Sequence[Panel]
    caption: str = ""
    """A line below the panels."""


@dataclass(frozen=True)
class Film:
    """Scenes one after the other. Frames are drawn when they are asked for.

    Agents act in the same simulated time, and one that has ended stands still.
    """

    scenes: Sequence[Scene]
    """The scenes, each with as many panels."""
    width: int
    """Width of a panel [pixel], even."""
    fps: float
    """Frames per second."""
    speed: float = 1.0
    """Simulated time per time of the film."""

    def __len__(self) -> int:
        """Number of frames."""
        return sum(map(self._length, self.scenes))

    def __iter__(self) -> Iterator[NDArray[np.uint8]]:
        """Draws all frames (height, width, 3); height and width are even."""
        return (self.frame(k) for k in range(len(self)))

    def frame(self, k: int) -> NDArray[np.uint8]:
        """Draws frame k."""
        for scene in self.scenes:
            length = self._length(scene)
            if k < length:
                return self._draw(scene, k)
            k -= length
        raise IndexError(k)

    def _length(self, scene: Scene) -> int:
        seconds = max(panel.episode.seconds for panel in scene.panels)
        # Rounding errors must not add a frame, nor hold back a control step below.
        return math.ceil(seconds / self.speed * self.fps - SLACK) + round(HOLD_S * self.fps)

    def _draw(self, scene: Scene, k: int) -> NDArray[np.uint8]:
        size, n = self._panel_size, len(scene.panels)
        columns = min(n, COLUMNS)
        rows = math.ceil(n / columns)
        caption = 2 * size.text if scene.caption else 0
        down, right = size.height + GAP, size.width + GAP
        height, width = rows * down - GAP + caption, columns * right - GAP
        frame = np.full((height + height % 2, width, 3), 255, np.uint8)
        seconds = k / self.fps * self.speed
        for i, panel in enumerate(scene.panels):
            top, left = i // columns * down, i % columns * right
            moment = math.floor(seconds * panel.episode.control_hz + SLACK)
            frame[top : top + size.height, left : left + size.width] = panel.draw(moment, size)
        if scene.caption:
            strip = frame[height - caption :]
            with draw_on(strip) as draw:
                at = (size.margin, caption // 2)
                draw.text(at, scene.caption, INK, font(size.text), anchor="lm")
        return frame

    @property
    def _panel_size(self) -> PanelSize:
        maps = [panel.maps.rows for scene in self.scenes for panel in scene.panels if panel.maps]
        return PanelSize(self.width, max(maps, default=0))
