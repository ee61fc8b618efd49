"""Frames as files: PNG, GIF and MP4."""

from __future__ import annotations

from io import BytesIO
from itertools import repeat
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from gym_babble.errors import ConfigError, MissingExtraError
from gym_babble.progress import track
from gym_babble.viz.text import pillow

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from gym_babble.viz.film import Film

    Frame: TypeAlias = NDArray[np.uint8]

__all__ = ["check_film", "contact_sheet", "film_bytes", "png"]

ENDINGS = (".mp4", ".gif", ".png")
GAP = 6
"""Width of the white gaps in a contact sheet [pixel]."""
SHEET = 6
"""Frames of a film on a contact sheet."""
SHEET_WIDTH = 1920
"""Width that a contact sheet need not exceed [pixel]."""
PALETTE = 9
"""Frames that the colours of a GIF are chosen from."""


def check_film(path: Path) -> None:
    """Checks, before long work, that a film can be made.

    Args:
        path: The file; its ending is the format.

    Raises:
        ConfigError: The format is unknown.
        MissingExtraError: Pillow (extra `figures`) or moviepy (extra `video`) is not installed.
    """
    if path.suffix not in ENDINGS:
        raise ConfigError(f"{path}: the name of a film must end with one of {', '.join(ENDINGS)}")
    pillow()
    if path.suffix == ".mp4":
        _video_writer()


def film_bytes(film: Film, ending: str, *, progress_bar: bool = False) -> bytes:
    """Draws a film into the bytes of a file.

    Args:
        film: The film.
        ending: ".mp4", ".gif", or ".png", which is a contact sheet of frames at equal intervals.
        progress_bar: Show a progress bar.

    Raises:
        MissingExtraError: As for `check_film`.
    """
    if ending == ".png":
        chosen = np.linspace(0, len(film) - 1, SHEET).round().astype(int).tolist()
        columns = max(1, min(3, SHEET_WIDTH // film.frame(0).shape[1]))
        six = list(_drawn(film, chosen, progress_bar=progress_bar))
        return png(contact_sheet(six, columns=columns, rows=SHEET // columns))
    frames = _drawn(film, range(len(film)), progress_bar=progress_bar)
    return _mp4(film, frames) if ending == ".mp4" else _gif(film, frames)


def _drawn(film: Film, frames: Sequence[int], *, progress_bar: bool) -> Iterator[Frame]:
    """Draws frames and shows progress."""
    n = len(frames)
    for k, _ in enumerate(track(repeat(1, n), "drawing", total=n, show=progress_bar)):
        yield film.frame(frames[k])


def contact_sheet(frames: list[Frame], *, columns: int = 3, rows: int = 2) -> Frame:
    """One picture of frames at equal intervals, from the first to the last."""
    chosen = np.linspace(0, len(frames) - 1, columns * rows).round().astype(int)
    height, width, _ = frames[0].shape
    down, right = height + GAP, width + GAP
    sheet = np.full((rows * down - GAP, columns * right - GAP, 3), 255, np.uint8)
    for k, i in enumerate(chosen.tolist()):
        top, left = k // columns * down, k % columns * right
        sheet[top : top + height, left : left + width] = frames[i]
    return sheet


def png(picture: Frame) -> bytes:
    """A picture (height, width, 3) as a PNG file.

    Raises:
        MissingExtraError: Pillow (extra `figures`) is not installed.
    """
    buffer = BytesIO()
    pillow().fromarray(picture).save(buffer, "PNG", optimize=True)
    return buffer.getvalue()


def _gif(film: Film, frames: Iterator[Frame]) -> bytes:
    image, buffer = pillow(), BytesIO()
    some = np.linspace(0, len(film) - 1, PALETTE).astype(int).tolist()
    # Pixels enough for the colours, and few enough to be fast.
    sample = np.vstack([film.frame(k)[::2, ::2] for k in some])
    # One colour less than a GIF can have: Pillow needs it for what does not change.
    palette = image.fromarray(sample).quantize(255)
    colours = np.array(palette.getpalette()).reshape(-1, 3)
    # The background is white; Pillow looks up colours in steps of 8.
    colours[colours.min(axis=1) >= 248] = 255
    palette.putpalette(colours.ravel().tolist())
    reduced = (image.fromarray(frame).quantize(palette=palette, dither=0) for frame in frames)
    # A GIF counts in hundredths of a second.
    ends = [round(100 * k / film.fps) for k in range(len(film) + 1)]
    durations = [10 * step for step in np.diff(ends).tolist()]
    first = next(reduced)
    first.save(buffer, "GIF", save_all=True, append_images=reduced, duration=durations, loop=0)
    return buffer.getvalue()


def _mp4(film: Film, frames: Iterator[Frame]) -> bytes:
    height, width, _ = film.frame(0).shape
    with TemporaryDirectory() as folder:
        path = Path(folder) / "film.mp4"
        with _video_writer()(str(path), (width, height), film.fps) as writer:
            for frame in frames:
                writer.write_frame(frame)
        return path.read_bytes()


def _video_writer() -> Any:
    """The writer of moviepy, which starts ffmpeg.

    Raises:
        MissingExtraError: moviepy is not installed.
    """
    try:
        from moviepy.video.io.ffmpeg_writer import FFMPEG_VideoWriter
    except ImportError as error:
        raise MissingExtraError("moviepy", "video") from error
    return FFMPEG_VideoWriter
