"""`gym-babble serve`: the environments over a network."""

import sys

import typer

from gym_babble._core import serve as run_server

__all__ = ["serve"]


def serve(context: typer.Context) -> None:
    """Serve the environments over a network, for any language: see docs/server.md.

    The options are those of the program `gym-babble-server`: `gym-babble serve --help` lists them.
    """
    sys.stdout.flush()
    code = run_server(context.args)
    if code:
        raise typer.Exit(code)
