"""The application: its commands, and how it runs and fails."""

import io
import sys
from collections.abc import Sequence
from typing import Annotated, Any

import typer

from gym_babble._core import __version__
from gym_babble.cli.babble import babble
from gym_babble.cli.compare import compare
from gym_babble.cli.course import course
from gym_babble.cli.doctor import doctor
from gym_babble.cli.evaluate import evaluate
from gym_babble.cli.export import export
from gym_babble.cli.export_policy import export_policy
from gym_babble.cli.info import info
from gym_babble.cli.lab import lab
from gym_babble.cli.list import list_environments
from gym_babble.cli.record import record
from gym_babble.cli.reproduce import reproduce
from gym_babble.cli.serve import serve
from gym_babble.cli.study import study
from gym_babble.errors import BabbleError, MissingExtraError

__all__ = ["app", "main"]

app = typer.Typer(
    help="Reaching and grasping learned by motor babbling: environments, agents and the paper's "
    "experiments.",
    add_completion=False,
    rich_markup_mode=None,
)
app.command("list")(list_environments)
for command in (info, babble, evaluate, compare, record, export, doctor):
    app.command()(command)
app.command("export-policy")(export_policy)
# Its options are the server's own, which also shows the help.
app.command(
    context_settings={
        "allow_extra_args": True,
        "ignore_unknown_options": True,
        "help_option_names": [],
    }
)(serve)
app.add_typer(reproduce, name="reproduce")
app.add_typer(study, name="study")
app.add_typer(lab, name="lab")
app.add_typer(course, name="course")

# The base class of typer's complaints about arguments; its name differs between versions.
UsageError: Any = typer.BadParameter.__bases__[0]


@app.callback(invoke_without_command=True)
def _top(
    context: typer.Context,
    version: Annotated[bool, typer.Option("--version", help="Show the version.")] = False,
) -> None:
    if version:
        typer.echo(__version__)
    elif context.invoked_subcommand is None:
        typer.echo(context.get_help())


def main(arguments: Sequence[str] | None = None) -> None:
    """Runs the command line and exits.

    Args:
        arguments: Words after `gym-babble`; those of the process by default.
    """
    for stream in (sys.stdout, sys.stderr):
        # A pipe may not know all letters, as on Windows: better a "?" than no result.
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")
    sys.exit(_run(arguments))


def _run(arguments: Sequence[str] | None) -> int:
    try:
        return app(arguments, standalone_mode=False) or 0
    except UsageError as error:
        return _fail(f"{error.format_message()} (see gym-babble --help)", 2)
    except MissingExtraError as error:
        return _fail(str(error), 1)
    except (BabbleError, FileNotFoundError) as error:
        return _fail(str(error), 2)
    except OSError as error:
        return _fail(str(error), 1)
    except (KeyboardInterrupt, typer.Abort):
        return _fail("interrupted", 130)


def _fail(text: str, code: int) -> int:
    # A library's message may have several lines; we print one.
    typer.echo(f"error: {' '.join(line.strip() for line in text.splitlines())}", err=True)
    return code
