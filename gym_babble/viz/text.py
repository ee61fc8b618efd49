"""Text in pictures. Needs Pillow, which the extras `figures` and `video` bring."""

from __future__ import annotations

from contextlib import contextmanager
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble.errors import MissingExtraError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

__all__ = ["INK", "PALE", "draw_on", "font", "pillow", "shortened"]

INK, PALE = (31, 41, 51), (97, 110, 124)


def pillow() -> Any:
    """Pillow's module `Image`.

    Raises:
        MissingExtraError: It is not installed.
    """
    try:
        from PIL import Image  # noqa: PLC0415 - an extra brings it
    except ImportError as error:
        raise MissingExtraError("pillow", "figures") from error
    return Image


@lru_cache(maxsize=32)
def font(size: int) -> Any:
    """Pillow's own font, in a size [pixel]."""
    pillow()
    from PIL import ImageFont  # noqa: PLC0415 - an extra brings it

    return ImageFont.load_default(size)


@contextmanager
def draw_on(picture: NDArray[np.uint8]) -> Iterator[Any]:
    """Gives Pillow's `ImageDraw` for a picture (height, width, 3), which it changes."""
    image = pillow().fromarray(picture)
    from PIL import ImageDraw  # noqa: PLC0415 - an extra brings it

    yield ImageDraw.Draw(image)
    picture[:] = np.asarray(image)


def shortened(text: str, letters: Any, width: int) -> str:
    """The text, cut to a width [pixel]."""
    if letters.getlength(text) <= width:
        return text
    while text and letters.getlength(f"{text}…") > width:
        text = text[:-1]
    return f"{text}…"
