"""An inverse model of local linear maps that learns online (Rolf, Steil & Gienger 2011)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["LocalMaps"]


class LocalMaps:
    """g(x) = Σ_i f_i(x) (M_i (x − p_i) / r + q_i), with f_i(x) = exp(−|x − p_i|² / 2r²) / Σ_j ….

    A map is added where no other one is within the radius r: at first it continues g. Then all maps
    descend the gradient of w |q − g(x)|², each by its share f_i.

    Args:
        radius: Radius r, in units of x.
        rate: Learning rate.
        home: What g is before it has learnt (m,).
        inputs: Numbers in x.
    """

    def __init__(self, radius: float, rate: float, home: NDArray[np.float64], inputs: int) -> None:
        self._radius, self._rate, self._home = radius, rate, home
        self.places = np.zeros((0, inputs), np.float32)
        """Places p (n, inputs)."""
        self.maps = np.zeros((0, len(home), inputs + 1), np.float32)
        """Slopes M and, in the last column, offsets q (n, m, inputs + 1)."""

    def __call__(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """g(x) (m,) for x (inputs,)."""
        if not len(self.places):
            return self._home
        shares, sides, _ = self._near(x)
        value: NDArray[np.float64] = np.einsum("i,imk,ik->m", shares, self.maps, sides)
        return value

    def learn(self, x: NDArray[np.float64], q: NDArray[np.float64], weight: float) -> None:
        """Learns that q (m,) leads to x (inputs,), with some weight."""
        if weight <= 0:
            return
        if not len(self.places) or self._near(x)[2] > self._radius:
            self._add(x)
        shares, sides, _ = self._near(x)
        error = q - self(x)
        step = self._rate * weight * shares[:, None, None] * error[None, :, None]
        self.maps = (self.maps + step * sides[:, None, :]).astype(np.float32)

    def _add(self, x: NDArray[np.float64]) -> None:
        """Adds a map at x that has the value and slope of g there."""
        new = np.zeros((1, *self.maps.shape[1:]), np.float32)
        new[0, :, -1] = self(x)
        if len(self.places):
            new[0, :, :-1] = np.einsum("i,imk->mk", self._near(x)[0], self.maps[:, :, :-1])
        self.places = np.vstack([self.places, x[None].astype(np.float32)])
        self.maps = np.concatenate([self.maps, new])

    def _near(
        self, x: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
        """Shares f (n,), ((x − p) / r, 1) (n, inputs + 1), and distance to the nearest place."""
        offsets = x - self.places
        squares = np.square(offsets).sum(axis=1)
        least = squares.min()
        shares = np.exp((least - squares) / (2 * self._radius**2))
        sides = np.hstack([offsets / self._radius, np.ones((len(offsets), 1))])
        return shares / shares.sum(), sides, float(np.sqrt(least))
