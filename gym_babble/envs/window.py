"""A window for render_mode="human"."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble.errors import MissingExtraError

if TYPE_CHECKING:
    from numpy.typing import NDArray


class Window:
    """A window of its own that shows frames in real time.

    Closed by its user, it stays closed. Other windows of the process go on, ours and those of other
    environments; where one of these closes every window, this one opens again.
    """

    def __init__(self, size: tuple[int, int], fps: int) -> None:
        try:
            import pygame
        except ImportError as error:
            raise MissingExtraError("pygame-ce", "human") from error
        if not hasattr(pygame, "Window"):  # The other pygame has one window for all.
            raise MissingExtraError("pygame-ce", "human")
        self._pygame: Any = pygame
        self._size = size
        self._fps = fps
        self._window: Any = None
        self.is_closed = False
        """Whether its user closed it."""

    def show(self, frame: NDArray[np.uint8]) -> None:
        """Shows a frame (height, width, 3) for its time."""
        screen = self._screen()
        self._read_events()
        if self.is_closed:
            return
        surface = self._pygame.surfarray.make_surface(np.transpose(frame, (1, 0, 2)))
        screen.blit(surface, (0, 0))
        self._clock.tick(self._fps)
        self._window.flip()

    def close(self) -> None:
        """Closes the window."""
        if self._window is not None:
            with suppress(self._pygame.error):  # Another environment closed it.
                self._window.destroy()
            self._window = None

    def _screen(self) -> Any:
        """The surface of the window, which is opened if need be.

        A surface that is kept would outlast its window, and drawing on it end the process.
        """
        if self._window is not None:
            try:
                return self._window.get_surface()
            except self._pygame.error:
                # Freed before the next one opens: SDL may give that one the same address, and its
                # end would then destroy it.
                self._window = None
        pygame = self._pygame
        pygame.display.init()
        self._window = pygame.Window("gym-babble", self._size)
        self._clock = pygame.time.Clock()
        pygame.register_quit(self._forget)
        return self._window.get_surface()

    def _read_events(self) -> None:
        """Notices that the user closed the window; leaves all other events where they are."""
        pygame = self._pygame
        for event in pygame.event.get(pygame.WINDOWCLOSE):
            if getattr(event, "window", None) is self._window:
                self.is_closed = True
                self.close()
            else:
                pygame.event.post(event)

    def _forget(self) -> None:
        """`pygame.quit`, which any environment may call, has destroyed the window."""
        self._window = None
