"""`gym-babble course`: what students hand in of the lessons."""

import typer

from gym_babble.cli.course.check import check

__all__ = ["course"]

course = typer.Typer(help="The course: check what students hand in.", no_args_is_help=True)
course.command("check")(check)


@course.callback()
def _commands() -> None:
    """Makes `check` a command with a name, though it is the only one."""
