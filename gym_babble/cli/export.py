"""`gym-babble export`."""

from pathlib import Path
from typing import Annotated, Literal

import typer

from gym_babble.cli.arguments import ConfigName, TaskName
from gym_babble.cli.output import name_files
from gym_babble.export import export_mjcf, export_urdf
from gym_babble.files import check_file, write_file

__all__ = ["export"]


def export(
    *,
    kind: Annotated[
        Literal["mjcf", "urdf"],
        typer.Option("--format", help="mjcf: MuJoCo, robot and case; urdf: robot only."),
    ] = "mjcf",
    task: TaskName = "grasp",
    config: ConfigName = "paper",
    seed: Annotated[int, typer.Option(min=0, help="Seed of the case (mjcf).")] = 0,
    timestep: Annotated[
        float | None,
        typer.Option(help="MuJoCo's step [s] (mjcf). Default: the environment's."),
    ] = None,
    file: Annotated[Path | None, typer.Option("--out", help="File. Default: stdout.")] = None,
) -> None:
    """Write the robot for other simulators."""
    if file is not None:
        check_file(file, "--out")
    if kind == "mjcf":
        text = export_mjcf(task, config=config, seed=seed, timestep=timestep)
    else:
        text = export_urdf(task, config=config)
    if file is None:
        typer.echo(text, nl=False)
        return
    write_file(file, text)
    name_files([file])
