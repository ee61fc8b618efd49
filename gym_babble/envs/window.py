"""A window for render_mode="human"."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble.errors import MissingExtraError

if TYPE_CHECKING:
    from numpy.typing import NDArray


class Window:
    """A pygame window that shows frames in real time."""

    def __init__(self, size: tuple[int, int], fps: int) -> None:
        try:
            import pygame
        except ImportError as error:
            raise MissingExtraError("pygame", "human") from error
        pygame.init()
        pygame.display.set_caption("gym-babble")
        self._pygame: Any = pygame
        self._screen = pygame.display.set_mode(size)
        self._clock = pygame.time.Clock()
        self._fps = fps

    def show(self, frame: NDArray[np.uint8]) -> None:
        """Shows a frame (height, width, 3) for its time."""
        surface = self._pygame.surfarray.make_surface(np.transpose(frame, (1, 0, 2)))
        self._screen.blit(surface, (0, 0))
        self._pygame.event.pump()
        self._clock.tick(self._fps)
        self._pygame.display.flip()

    def close(self) -> None:
        """Closes the window."""
        self._pygame.display.quit()
        self._pygame.quit()
