"""Figure 8: activation of the arm's map, and weights of reaching and grasping.

Drawing needs the extra `figures`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble.viz.style import FAINT, INK, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from gym_babble.agents import HebbBabbling

__all__ = ["draw", "weights_by_distance"]


def weights_by_distance(agent: HebbBabbling) -> NDArray[np.float64]:
    """Mean weight from an eye neuron to the arm neurons d spacings from its strongest (d,).

    A Mexican hat is positive at the peak, and then lower than far away. The mean is over the eye
    neurons whose peak is at least three quarters of the greatest weight; distances are rounded.

    Args:
        agent: An agent of grasping that has learnt.
    """
    side = agent.brain["neurons"]
    outward = agent.weights["reach.weights"].T
    outward = outward[outward.max(axis=1) >= 0.75 * outward.max()]
    rows, columns = np.divmod(np.arange(side * side), side)
    peaks = outward.argmax(axis=1)[:, None]
    distances = np.hypot(rows - rows[peaks], columns - columns[peaks]).round().astype(int)
    sums, counts = np.bincount(distances.ravel(), outward.ravel()), np.bincount(distances.ravel())
    mean: NDArray[np.float64] = sums / counts
    return mean


@styled
def draw(agent: HebbBabbling, eye: tuple[float, float] = (0.45, 0.85)) -> Figure:
    """Draws the arm's map for an object, weights of the eye neurons, and of two hand neurons.

    Top: activation potential of the arm's map when the eye looks at an object; weights from the eye
    neuron nearest to that gaze; and the mean weight by distance from the peak, over all eye
    neurons. Bottom: weights from the fovea to the hand neurons nearest to the mean babbled hand,
    for the smallest and the biggest object.

    Args:
        agent: An agent that has learnt.
        eye: Pan and tilt of the eye, as fractions of their ranges.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11.4, 7.2), layout="constrained")
    places = figure.add_gridspec(2, 6)
    weights, side = agent.weights, agent.brain["neurons"]
    reach = weights["reach.weights"]
    potential = (reach @ _tuning(eye, side, agent.brain["sigma"])).reshape(side, side)
    grid = np.arange(1, side + 1)
    surface: Any = figure.add_subplot(places[0, :2], projection="3d")
    surface.plot_surface(*np.meshgrid(grid, grid), potential, cmap="RdBu_r", lw=0.2, ec=FAINT)
    surface.set(title="Arm's map: activation potential", xlabel="shoulder", ylabel="elbow")
    column, row = (round(share * (side - 1)) for share in eye)
    outward = reach[:, row * side + column].reshape(side, side)
    title = f"From eye neuron ({column + 1}, {row + 1})"
    axes = figure.add_subplot(places[0, 2:4])
    _weights(axes, outward, title=title, axes=("shoulder", "elbow"))
    _profile(figure.add_subplot(places[0, 4:]), weights_by_distance(agent))
    babbled = agent.experiences()
    sizes = babbled.case["diameter"][:, 0]
    diameters = np.unique(sizes)
    for place, diameter in ((slice(3), diameters[0]), (slice(3, 6), diameters[-1])):
        hand = babbled.actions["hand"][sizes == diameter].mean(axis=0)
        thumb, finger = (round(np.clip(ep / 90.0, 0.0, 1.0) * (side - 1)) for ep in hand.tolist())
        inward = weights["grasp.weights"][finger * side + thumb].reshape(21, 21)[::-1]
        title = f"To the hand for {100 * diameter:g} cm: EP {hand[0]:.0f}°, {hand[1]:.0f}°"
        axes = figure.add_subplot(places[1, place])
        _weights(axes, inward, title=title, axes=("fovea, column", "row from below"))
    return figure


def _tuning(value: tuple[float, float], side: int, sigma: float) -> NDArray[np.float64]:
    """Activities of a map over [0, 1]², Eq. 3."""
    grid = np.arange(side)
    x, y = (np.exp(-((grid - share * (side - 1)) ** 2) / (2 * sigma**2)) for share in value)
    activity: NDArray[np.float64] = np.outer(y, x).ravel()
    return activity


def _weights(ax: Axes, weights: NDArray[np.float32], *, title: str, axes: tuple[str, str]) -> None:
    most = float(np.abs(weights).max()) or 1.0
    side = len(weights)
    extent = (0.5, side + 0.5, 0.5, side + 0.5)
    picture = ax.imshow(
        weights, origin="lower", extent=extent, cmap="RdBu_r", vmin=-most, vmax=most
    )
    ticks = {"xticks": (1, 11, 21), "yticks": (1, 11, 21)}
    ax.set(title=title, xlabel=axes[0], ylabel=axes[1], **ticks)
    ax.figure.colorbar(picture, ax=ax, shrink=0.8, label="weight")


def _profile(ax: Axes, weights: NDArray[np.float64]) -> None:
    ax.axhline(0, color=FAINT, lw=0.8)
    ax.plot(weights, color=INK, marker=".")
    ax.set(title="Mean of all eye neurons", xlabel="neurons from the peak", ylabel="weight")
