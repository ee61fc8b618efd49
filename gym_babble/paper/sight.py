"""What the eye sees of objects: its view, the fovea, and the edges in the fovea.

Drawing needs the extra `figures`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from gym_babble.envs import BabbleGraspEnv
from gym_babble.paper.table2 import table_diameters
from gym_babble.viz.style import styled

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from gym_babble.config import ConfigLike

__all__ = ["draw", "eye_views"]


def eye_views(
    config: ConfigLike = "paper", size: int = 315
) -> list[tuple[str, list[NDArray[np.uint8]]]]:
    """For each diameter its name, and the eye's view, fovea and edges (size, size, 3)."""
    seen = []
    for diameter in table_diameters(config):
        images = []
        for camera in ("eye", "fovea", "edges"):
            env = BabbleGraspEnv("rgb_array", config=config, camera=camera, width=size, height=size)
            env.reset(seed=3, options={"diameter": diameter})
            images.append(env.render())
        seen.append((f"{100 * diameter:g} cm", images))
    return seen


@styled
def draw(pictures: Sequence[tuple[str, Sequence[NDArray[np.uint8]]]]) -> Figure:
    """Draws a row for each object: the eye's view, the fovea and its edges."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.4, 2.9 * len(pictures)), layout="constrained")
    titles = ("the eye's view", "fovea, 63 × 63", "edges (Sobel)")
    for row, (name, images) in enumerate(pictures):
        for column, (image, title) in enumerate(zip(images, titles, strict=True)):
            ax = figure.add_subplot(len(pictures), 3, 3 * row + column + 1)
            ax.imshow(image, interpolation="nearest")
            ax.set(title=f"{name}: {title}", xticks=(), yticks=())
    return figure
