"""`gym-babble render`."""

from pathlib import Path
from typing import Annotated, Literal

import typer

from gym_babble.agents.loading import named_agent
from gym_babble.cli.arguments import (
    AgentName,
    ControlName,
    EnvId,
    OwnConfig,
    Seed,
    VecNormalizeFile,
    given_options,
    one_of,
)
from gym_babble.cli.output import name_files, say
from gym_babble.envs.registry import TASKS
from gym_babble.files import check_folder
from gym_babble.viz.film import film_files, record, save_film

__all__ = ["render"]

(CAMERAS,) = {
    option.values for task in TASKS.values() for option in task.options if option.name == "camera"
}


def render(
    agent: AgentName,
    *,
    folder: Annotated[Path, typer.Option("--out", help="Folder for the pictures.")],
    kind: Annotated[
        Literal["png", "gif", "mp4"], typer.Option("--format", help="Format of the film.")
    ] = "gif",
    seed: Seed = 0,
    camera: Annotated[str, typer.Option(help="Camera.", **one_of(CAMERAS))] = "third_person",
    size: Annotated[
        int, typer.Option(min=16, max=4096, help="Width and height of a picture [pixel].")
    ] = 360,
    env_id: EnvId = None,
    control: ControlName = None,
    config: OwnConfig = None,
    vec_normalize: VecNormalizeFile = None,
) -> None:
    """Film an episode of an agent: a contact sheet, and frames, GIF or MP4."""
    check_folder(folder, "--out", film_files(kind))
    loaded = named_agent(
        agent,
        env_id=env_id,
        config=config,
        seed=seed,
        options=given_options(control=control),
        vec_normalize=vec_normalize,
    )
    film = record(loaded, seed=seed, camera=camera, size=size)
    say(f"{film.outcome} after {len(film.frames) - 1} control steps")
    name_files(save_film(film, folder, kind))
