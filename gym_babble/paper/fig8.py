"""Figure 8: activation of the arm's map, and weights of reaching and grasping.

Drawing needs the extra `figures`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble.viz.style import FAINT, styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from gym_babble.agents import HebbBabbling

__all__ = ["draw"]


@styled
def draw(agent: HebbBabbling, eye: tuple[float, float] = (0.45, 0.85)) -> Figure:
    """Draws the arm's map for an object, weights of an eye neuron, and of two hand neurons.

    Top left: activation potential of the arm's map when the eye looks at an object. Top right:
    weights from the eye neuron nearest to that gaze. Bottom: weights from the fovea to the hand
    neurons nearest to the mean babbled hand, for the smallest and the biggest object.

    Args:
        agent: An agent that has learnt.
        eye: Pan and tilt of the eye, as fractions of their ranges.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.6, 7.2), layout="constrained")
    weights, side = agent.weights, agent.brain["neurons"]
    reach = weights["reach.weights"]
    potential = (reach @ _tuning(eye, side, agent.brain["sigma"])).reshape(side, side)
    grid = np.arange(1, side + 1)
    surface: Any = figure.add_subplot(2, 2, 1, projection="3d")
    surface.plot_surface(*np.meshgrid(grid, grid), potential, cmap="RdBu_r", lw=0.2, ec=FAINT)
    surface.set(title="Arm's map: activation potential", xlabel="shoulder", ylabel="elbow")
    column, row = (round(share * (side - 1)) for share in eye)
    outward = reach[:, row * side + column].reshape(side, side)
    title = f"From eye neuron ({column + 1}, {row + 1})"
    _weights(figure, 2, outward, title=title, axes=("shoulder", "elbow"))
    babbled = agent.experiences()
    sizes = babbled.case["diameter"][:, 0]
    diameters = np.unique(sizes)
    for place, diameter in ((3, diameters[0]), (4, diameters[-1])):
        hand = babbled.actions["hand"][sizes == diameter].mean(axis=0)
        thumb, finger = (round(np.clip(ep / 90.0, 0.0, 1.0) * (side - 1)) for ep in hand.tolist())
        inward = weights["grasp.weights"][finger * side + thumb].reshape(21, 21)[::-1]
        title = f"To the hand for {100 * diameter:g} cm: EP {hand[0]:.0f}°, {hand[1]:.0f}°"
        _weights(figure, place, inward, title=title, axes=("fovea, column", "row from below"))
    return figure


def _tuning(value: tuple[float, float], side: int, sigma: float) -> NDArray[np.float64]:
    """Activities of a map over [0, 1]², Eq. 3."""
    grid = np.arange(side)
    x, y = (np.exp(-((grid - share * (side - 1)) ** 2) / (2 * sigma**2)) for share in value)
    activity: NDArray[np.float64] = np.outer(y, x).ravel()
    return activity


def _weights(
    figure: Figure, place: int, weights: NDArray[np.float32], *, title: str, axes: tuple[str, str]
) -> None:
    ax = figure.add_subplot(2, 2, place)
    most = float(np.abs(weights).max()) or 1.0
    side = len(weights)
    extent = (0.5, side + 0.5, 0.5, side + 0.5)
    picture = ax.imshow(
        weights, origin="lower", extent=extent, cmap="RdBu_r", vmin=-most, vmax=most
    )
    ticks = {"xticks": (1, 11, 21), "yticks": (1, 11, 21)}
    ax.set(title=title, xlabel=axes[0], ylabel=axes[1], **ticks)
    figure.colorbar(picture, ax=ax, shrink=0.8, label="weight")
