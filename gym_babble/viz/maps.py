"""The maps of a Hebb agent as small pictures: what it sees, what that recalls, and the weights."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gym_babble.agents import HebbBabbling

__all__ = ["AgentMaps", "MapPicture", "colour_map"]

# Highest read-out of an output map; its lowest is 0.
READ_OUT = {"movement": 1.0, "arm": 1.0, "hand": 90.0, "pregrasp": 1.0, "contact": 1.0}
# Neurons of an output map beyond each end of what it is read out as; the others have none.
MARGIN = {"pregrasp": 2, "contact": 2}
# The input maps of the chain have the names of its output maps; all are of the eye and the size.
EYE_AND_SIZE = ("pregrasp", "contact", "hand")
# The maps whose rows count from the top; the others' count from below.
FROM_TOP = ("fovea",)

ACTIVITY = ((255, 255, 255), (120, 170, 214), (31, 111, 178), (11, 44, 78))
WEIGHTS = ((5, 48, 97), (67, 147, 195), (247, 247, 247), (214, 96, 77), (103, 0, 31))


@dataclass(frozen=True)
class MapPicture:
    """One map at one moment."""

    title: str
    values: NDArray[np.float32]
    """What each neuron stands for (rows, columns), rows from the top of the picture."""
    low: float
    """Value that has the first colour."""
    high: float
    """Value that has the last colour."""
    colours: tuple[tuple[int, int, int], ...]
    mark: tuple[float, float] | None = None
    """Where to mark the map, as shares of its width and height from the left and from the top: the
    centre of the first neuron is 0, and that of the last 1."""


class AgentMaps:
    """The maps of an agent, which does not learn meanwhile.

    Args:
        agent: The agent.
    """

    def __init__(self, agent: HebbBabbling) -> None:
        self._agent = agent
        weights = agent.weights
        found = [value for name, value in weights.items() if name.endswith("weights")]
        # The chain's last two are of its routes, which are no map of what is seen.
        self._weights = found[: len(EYE_AND_SIZE)] if agent.variant == "chain" else found
        w_max = agent.brain["rule"].get("w_max")
        # Oja's rule has no bound.
        self._bounds = [w_max or float(np.abs(value).max()) for value in self._weights]

    @property
    def rows(self) -> int:
        """Number of associations."""
        return len(self._weights)

    def pictures(self, observation: Any) -> list[tuple[MapPicture, ...]]:
        """The maps of each association for an observation.

        Of each association: activity of the input map (Eq. 3), the weights of the neuron that is
        most active, and activity of the output map (Eq. 4) with its read-out marked. The weights
        are those from the most active input neuron, as in Fig. 5 and the top of Fig. 8. Of the
        fovea, where many neurons are equally active, they are those to the most active output
        neuron, as in the bottom of Fig. 8. Of the chain's pairs of eye and size, the eye's map at
        the most active size is shown.

        Args:
            observation: As the environment gives it.
        """
        parts = zip(
            self._agent.perceive(observation).items(),
            self._agent.recall(observation).items(),
            self._weights,
            self._bounds,
            self._agent.decide(observation).reshape(-1, 2),
            strict=True,
        )
        return [
            _association(name, g, output, a, w, w_max=w_max, read_out=value)
            for (name, g), (output, a), w, w_max, value in parts
        ]


def _association(
    name: str,
    g: NDArray[np.float32],
    output: str,
    a: NDArray[np.float32],
    w: NDArray[np.float32],
    *,
    w_max: float,
    read_out: NDArray[np.float64],
) -> tuple[MapPicture, ...]:
    most_seen, most_recalled = int(g.argmax()), int(a.argmax())
    if name in FROM_TOP:
        weights, title = _picture(name, w[most_recalled].reshape(g.shape)), "weights in"
    else:
        weights, title = _picture(output, w[:, most_seen].reshape(a.shape)), "weights out"
    margin = MARGIN.get(output, 0) / (len(a) - 1)
    b1, b2 = (margin + (1 - 2 * margin) * read_out / READ_OUT[output]).tolist()
    mark = (b1, 1.0 - b2) if a.any() else None
    seen_title = "eye" if name in EYE_AND_SIZE else name.replace("_", ", ")
    if g.ndim == 3:
        strongest = most_seen // g[0].size
        seen_title, g = f"eye, size {strongest + 1} of {len(g)}", g[strongest]
    seen = _picture(name, g)
    recalled = _picture(output, a)
    return (
        MapPicture(seen_title, seen, 0.0, _most(seen), ACTIVITY),
        MapPicture(title, weights, -w_max, w_max, WEIGHTS),
        MapPicture(output, recalled, 0.0, _most(recalled), ACTIVITY, mark),
    )


def _most(values: NDArray[np.float32]) -> float:
    return float(values.max())


def _picture(name: str, values: NDArray[np.float32]) -> NDArray[np.float32]:
    """A map (rows, columns) from the top. One of pairs is laid out as maps in a map."""
    if values.ndim == 4:
        outer, inner = values.shape[0], values.shape[2]
        values = values.transpose(0, 2, 1, 3).reshape(outer * inner, outer * inner)
    return values if name in FROM_TOP else values[::-1]


def colour_map(picture: MapPicture, size: int) -> NDArray[np.uint8]:
    """A map in colours, with square neurons (size, size, 3), without its mark."""
    table = _table(picture.colours)
    span = picture.high - picture.low or 1.0
    levels = np.clip((picture.values - picture.low) / span, 0.0, 1.0) * (len(table) - 1)
    rows, columns = (np.arange(size) * n // size for n in picture.values.shape)
    coloured: NDArray[np.uint8] = table[levels.astype(np.intp)][rows[:, None], columns]
    return coloured


def _table(colours: tuple[tuple[int, int, int], ...]) -> NDArray[np.uint8]:
    """256 colours from the first to the last."""
    knots, levels = np.linspace(0.0, 1.0, len(colours)), np.linspace(0.0, 1.0, 256)
    channels = [np.interp(levels, knots, channel) for channel in zip(*colours, strict=True)]
    return np.stack(channels, axis=1).round().astype(np.uint8)
