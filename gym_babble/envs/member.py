"""One member of a core batch: its state and its pictures."""

from __future__ import annotations

from collections import deque
from copy import copy
from typing import TYPE_CHECKING, Any

import gymnasium

from gym_babble import _core
from gym_babble.envs.spaces import need_reset
from gym_babble.errors import SnapshotError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from gym_babble.envs.interface import Interface

__all__ = ["BatchMember", "check_state"]

MOST_KEPT = 1_000
"""Ended episodes whose frames wait to be fetched; of earlier ones they are dropped."""


def check_state(state: Any) -> None:
    """Raises `SnapshotError` if a state is not made of bytes."""
    if not isinstance(state, bytes):
        raise SnapshotError(f"state is a {type(state).__name__}, expected bytes")


class BatchMember:
    """What belongs to environment `i` of a batch, and not to the batch as a whole."""

    def __init__(self, interface: Interface, batch: _core.Batch, i: int) -> None:
        self._interface = interface
        self._batch = batch
        self._i = i
        self._shown = 0
        self._ended: deque[tuple[bytes, int]] = deque(maxlen=MOST_KEPT)
        """Ended episodes with frames to show: state, and how many frames were shown."""
        self.ready = False
        self.np_random_seed = -1
        """Seed of its cases; −1 where it is unknown: before a reset, and after `set_state`."""
        self.attributes: dict[str, Any] = {}
        """What `set_attr` of the batch set."""

    def seed(self, seed: int) -> None:
        """Starts the stream of cases anew."""
        self._batch.seed(self._i, seed)
        self.np_random_seed = seed

    def get_state(self) -> bytes:
        """The whole state, from which `set_state` continues bit for bit."""
        return self._batch.save(self._i)

    def set_state(self, state: bytes) -> None:
        """Continues from a state of an environment with the same arguments.

        Raises:
            SnapshotError: The bytes are not such a state; the environment is as it was.
        """
        check_state(state)
        self._batch.load(self._i, state)
        self.go_on()

    def go_on(self) -> None:
        """The batch continues from another state, with frames to show from now on."""
        self._ended.clear()
        self._shown = 0 if self._interface.render_mode is None else self._batch.moments(self._i)
        self.ready = True
        self.np_random_seed = -1

    def freeze(self) -> tuple[bytes, dict[str, Any]]:
        """All that a copy needs, before the first reset too."""
        others = ("_interface", "_batch", "_i")
        own = {name: copy(value) for name, value in vars(self).items() if name not in others}
        return self.get_state(), own

    def thaw(self, frozen: tuple[bytes, dict[str, Any]]) -> None:
        """Continues from what `freeze` gave."""
        state, own = frozen
        self.set_state(state)
        vars(self).update(own)

    def state_hash(self) -> int:
        """A number that two states share only if they are the same to the bit."""
        return self._batch.state_hash(self._i)

    @property
    def scenario(self) -> dict[str, Any]:
        """The case of the running episode, as `reset` options."""
        return dict(self._batch.case(self._i))

    @property
    def trajectory(self) -> NDArray[np.float64]:
        """The way of the hand since the reset (k, 2) [m]; recorded with a render_mode."""
        return self._batch.trail(self._i)

    def render(self) -> Any:
        """A frame, or a list of those since the last call, as the render_mode says.

        Raises:
            gymnasium.error.ResetNeeded: There was no reset yet.
        """
        if self._interface.render_mode is None:
            gymnasium.logger.warn(
                "render() was called without a render_mode; make the environment with one, "
                'e.g. render_mode="rgb_array"'
            )
            return None
        if not self.ready:
            raise need_reset()
        if self._interface.render_mode == "rgb_array":
            return self.frame(None)
        return self.new_frames()

    def begin(self) -> None:
        """The user began a new episode, which is shown from its first frame on."""
        self.ready = True
        self._shown = 0
        self._ended.clear()

    def follow(self) -> None:
        """Keeps the frames of the ended episode, if a new one began by itself within the step."""
        state = self._batch.save_ended(self._i)
        if state is not None:
            self._ended.append((state, self._shown))
            self._shown = 0

    def new_frames(self) -> list[NDArray[np.uint8]]:
        """The frames since the last call, one a control step."""
        frames = []
        for state, shown in self._ended:
            ended = _core.Batch(self._interface.task)
            ended.load(0, state)
            frames += [self._picture(ended, 0, k) for k in range(shown, ended.moments(0))]
        self._ended.clear()
        first, self._shown = self._shown, self._batch.moments(self._i)
        return frames + [self.frame(k) for k in range(first, self._shown)]

    def frame(self, moment: int | None) -> NDArray[np.uint8]:
        """The picture (height, width, 3) now, or at a recorded moment."""
        return self._picture(self._batch, self._i, moment)

    def _picture(self, batch: _core.Batch, i: int, moment: int | None) -> NDArray[np.uint8]:
        width, height = self._interface.size
        return batch.render(i, self._interface.camera, width, height, moment)

    def retina(self) -> NDArray[np.uint8]:
        """The eye's image in obs="retina"."""
        return self._batch.retina(self._i, self._interface.retina_size)
