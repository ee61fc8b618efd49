"""Figure 5: the weights of two sets of input neurons.

Drawing needs the extra `figures`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gym_babble.errors import ConfigError
from gym_babble.viz.style import LEFT, RIGHT, row_of_axes, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from gym_babble.agents import HebbBabbling

__all__ = ["WeightSets", "draw", "strongest_gaze", "weight_sets"]


@dataclass(frozen=True)
class WeightSets:
    """The two sets of input neurons of Fig. 5."""

    patterns: NDArray[np.float32]
    """Weights to the output map, of each input neuron: (rows, columns, b2, b1)."""
    left: NDArray[np.bool_]
    """Input neurons (rows, columns) whose weights alone produce a movement that curves left."""
    right: NDArray[np.bool_]
    """Input neurons (rows, columns) whose weights alone produce one that curves right."""
    field_deg: float
    """Greatest azimuth and elevation of the obstacle in the input map [deg]."""
    w_max: float
    """Bound of the weights; the greatest one if the rule has no bound."""

    def mean(self, members: NDArray[np.bool_]) -> NDArray[np.float32]:
        """Mean weights (b2, b1) of a set."""
        mean: NDArray[np.float32] = self.patterns[members].mean(axis=0)
        return mean

    def typical(self, members: NDArray[np.bool_]) -> tuple[int, int]:
        """The input neuron (row, column) whose weights correlate best with the mean of its set."""
        mean = self.mean(members).ravel()
        neurons = np.argwhere(members)
        likeness = [np.corrcoef(self.patterns[r, c].ravel(), mean)[0, 1] for r, c in neurons]
        row, column = neurons[int(np.argmax(likeness))].tolist()
        return row, column

    @property
    def mirror_correlation(self) -> float:
        """Correlation of the left set's mean with the right set's, after exchanging b1 and b2."""
        left, right = self.mean(self.left), self.mean(self.right)
        return float(np.corrcoef(left.ravel(), right.T.ravel())[0, 1])


def weight_sets(agent: HebbBabbling, *, gaze: tuple[int, int] | None = None) -> WeightSets:
    """Divides the input neurons by how a movement from their weights alone would curve.

    Neurons whose weights are all below half of w_max, or of the greatest weight if the rule has no
    bound, belong to neither set: they have seen too few obstacles.

    Args:
        agent: An agent of reaching.
        gaze: For variant "conjunctive", the neurons (row, column) of the eye's map whose pairs with
            the obstacle's map are shown.

    Raises:
        ConfigError: The agent has another input map than the obstacle's, or has not learnt.
    """
    patterns = _patterns(agent)
    if patterns.ndim != 4:
        if gaze is None:
            raise ConfigError("Fig. 5 needs the paper's input map: use variant 'paper', or gaze")
        patterns = patterns[gaze]
    side = patterns.shape[-1]
    activity = np.maximum(np.tanh(patterns), 0.0)  # Eq. 4 for one active input neuron.
    b1 = (activity * np.linspace(0.0, 1.0, side)).sum((2, 3))
    b1 = b1 / np.maximum(activity.sum((2, 3)), 1e-9)
    w_max = float(agent.brain["rule"].get("w_max", np.abs(patterns).max()))
    taught = np.abs(patterns).max((2, 3)) > 0.5 * w_max
    left, right = taught & (b1 > 0.5), taught & (b1 <= 0.5)
    if not (left.any() and right.any()):
        raise ConfigError("the agent has not learnt both curves yet: babble more movements")
    return WeightSets(patterns, left, right, float(agent.brain["obstacle_field_deg"]), w_max)


def strongest_gaze(agent: HebbBabbling) -> tuple[int, int]:
    """The neurons (row, column) of the eye's map with the strongest weights, of "conjunctive"."""
    strength = np.abs(_patterns(agent)).sum((2, 3, 4, 5))
    row, column = np.unravel_index(int(strength.argmax()), strength.shape)
    return int(row), int(column)


def _patterns(agent: HebbBabbling) -> NDArray[np.float32]:
    """Weights to the output map, of each input neuron: (axes of the input map, b2, b1)."""
    weights = agent.weights["weights"]
    side = round(len(weights) ** 0.5)
    return weights.T.reshape(*agent.input_shape, side, side)


@styled
def draw(sets: WeightSets) -> Figure:
    """Draws the weights to the output map (a neuron and the mean of each set), and the sets."""
    figure, axes = row_of_axes((11.0, 2.7), 5, width_ratios=(1, 1, 1, 1, 1.1))
    left, right = sets.typical(sets.left), sets.typical(sets.right)
    shown = (
        (sets.patterns[left], f"Neuron {left}: left"),
        (sets.mean(sets.left), f"Mean of {sets.left.sum()} left"),
        (sets.patterns[right], f"Neuron {right}: right"),
        (sets.mean(sets.right), f"Mean of {sets.right.sum()} right"),
    )
    for ax, (pattern, title) in zip(axes, shown, strict=False):
        picture = ax.imshow(
            pattern,
            origin="lower",
            extent=(0, 1, 0, 1),
            cmap="RdBu_r",
            vmin=-sets.w_max,
            vmax=sets.w_max,
        )
        ax.set(title=title, xlabel="b1", xticks=(0, 0.5, 1), yticks=(0, 0.5, 1))
    axes[0].set_ylabel("b2")
    figure.colorbar(picture, ax=axes[:4], shrink=0.7, pad=0.01, label="weight")
    _draw_sets(axes[4], sets)
    return figure


def _draw_sets(ax: Axes, sets: WeightSets) -> None:
    from matplotlib.colors import ListedColormap

    members = np.where(sets.left, 1, np.where(sets.right, 2, 0))
    colours = ListedColormap(["#eef1f4", LEFT, RIGHT])
    field = sets.field_deg
    ax.imshow(members, origin="lower", extent=(-field, field) * 2, cmap=colours, vmin=0, vmax=2)
    ticks = (-field, 0, field)
    ax.set(
        title="Input neurons",
        xlabel="obstacle, azimuth [°]",
        ylabel="elevation [°]",
        xticks=ticks,
        yticks=ticks,
    )
