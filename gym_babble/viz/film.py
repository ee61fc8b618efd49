"""Pictures of an episode: frames, contact sheets, GIF and MP4."""

from __future__ import annotations

from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble.agents.base import predictor
from gym_babble.envs.interface import outcome_of
from gym_babble.errors import MissingExtraError
from gym_babble.files import write_files

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gym_babble.agents.loading import LoadedAgent

__all__ = ["Film", "contact_sheet", "film_files", "png", "record", "save_film"]

GAP = 6
"""Width of the white gaps in a contact sheet [pixel]."""


@dataclass(frozen=True)
class Film:
    """The frames of one episode."""

    frames: list[NDArray[np.uint8]]
    """Pictures (height, width, 3), one for each control step."""
    fps: int
    """Frames per second, in real time."""
    outcome: str
    """How the episode ended."""


def record(
    loaded: LoadedAgent,
    *,
    seed: int = 0,
    options: dict[str, Any] | None = None,
    camera: str = "third_person",
    size: int = 480,
) -> Film:
    """Plays one episode and takes a picture at each control step.

    Args:
        loaded: The agent and its environment.
        seed: Seed of the episode.
        options: Options of `reset`, for a case of your own.
        camera: Camera of the environment.
        size: Width and height of the pictures [pixel].
    """
    env = loaded.arguments.single("rgb_array_list", camera=camera, width=size, height=size)
    predict = predictor(loaded.agent)
    observation, info = env.reset(seed=seed, options=options)
    frames, state, start, running = list(env.render()), None, True, True
    while running:
        action, state = predict(observation, state, np.array([start]), True)  # noqa: FBT003
        observation, _, terminated, truncated, info = env.step(action)
        frames += env.render()
        start, running = False, not (terminated or truncated)
    env.close()
    return Film(frames, env.metadata["render_fps"], outcome_of(info))


def contact_sheet(
    frames: list[NDArray[np.uint8]], *, columns: int = 3, rows: int = 2
) -> NDArray[np.uint8]:
    """One picture of frames at equal intervals, from the first to the last."""
    chosen = np.linspace(0, len(frames) - 1, columns * rows).round().astype(int)
    height, width, _ = frames[0].shape
    down, right = height + GAP, width + GAP
    sheet = np.full((rows * down - GAP, columns * right - GAP, 3), 255, np.uint8)
    for k, i in enumerate(chosen.tolist()):
        top, left = k // columns * down, k % columns * right
        sheet[top : top + height, left : left + width] = frames[i]
    return sheet


def film_files(kind: str) -> tuple[str, str]:
    """Names of the contact sheet and the film, or its first frame."""
    return "sheet.png", "frame0000.png" if kind == "png" else f"episode.{kind}"


def save_film(film: Film, folder: Path, kind: str) -> list[Path]:
    """Writes a contact sheet and the film, and returns the files.

    Args:
        film: The film.
        folder: Folder for the files; created if missing. Frames of an earlier, longer film are
            removed.
        kind: "png" (one file for each frame), "gif" or "mp4".

    Raises:
        MissingExtraError: Pillow (extra `figures`) or moviepy (extra `video`) is not installed.
        OSError: The files cannot be written; earlier ones are whole.
    """
    files = {"sheet.png": png(contact_sheet(film.frames))}
    if kind == "mp4":
        files["episode.mp4"] = _mp4(film)
    elif kind == "gif":
        files["episode.gif"] = _gif(film)
    else:
        files |= {f"frame{i:04d}.png": png(frame) for i, frame in enumerate(film.frames)}
    earlier = {path.name for path in folder.glob("frame[0-9][0-9][0-9][0-9].png")}
    return write_files(folder, files, stale=sorted(earlier - files.keys()))


def png(picture: NDArray[np.uint8]) -> bytes:
    """A picture (height, width, 3) as a PNG file.

    Raises:
        MissingExtraError: Pillow (extra `figures`) is not installed.
    """
    buffer = BytesIO()
    _pillow().fromarray(picture).save(buffer, "PNG", optimize=True)
    return buffer.getvalue()


def _gif(film: Film) -> bytes:
    image, buffer = _pillow(), BytesIO()
    pictures = [image.fromarray(frame) for frame in film.frames]
    duration = round(1000 / film.fps)
    pictures[0].save(
        buffer, "GIF", save_all=True, append_images=pictures[1:], duration=duration, loop=0
    )
    return buffer.getvalue()


def _mp4(film: Film) -> bytes:
    try:
        from moviepy import ImageSequenceClip
    except ImportError as error:
        raise MissingExtraError("moviepy", "video") from error
    with TemporaryDirectory() as folder:
        path = Path(folder) / "episode.mp4"
        ImageSequenceClip(film.frames, fps=film.fps).write_videofile(str(path), logger=None)
        return path.read_bytes()


def _pillow() -> Any:
    try:
        from PIL import Image  # noqa: PLC0415 - an extra brings it
    except ImportError as error:
        raise MissingExtraError("pillow", "figures") from error
    return Image
