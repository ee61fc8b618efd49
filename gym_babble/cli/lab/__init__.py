"""`gym-babble lab`: the lab's page, and the records of its sessions."""

from typing import Annotated

import typer

from gym_babble.cli.lab.check import check
from gym_babble.cli.output import print_results, say
from gym_babble.lab.serving import page_server

__all__ = ["lab"]

lab = typer.Typer(help="The lab in the browser: serve its page, or check what students hand in.")
lab.command("check")(check)


@lab.callback(invoke_without_command=True)
def serve(
    context: typer.Context,
    port: Annotated[
        int, typer.Option(min=0, max=65_535, help="Port on 127.0.0.1; 0 for any free one.")
    ] = 8742,
) -> None:
    """Serve the lab's page to the browser on this machine until Ctrl-C."""
    if context.invoked_subcommand is not None:
        return
    try:
        server = page_server(port)
    except OSError as error:
        say(f"error: port {port}: {error.strerror}; --port 0 takes any free one")
        raise typer.Exit(1) from error
    with server:
        print_results(f"The lab is at http://127.0.0.1:{server.server_port}/ (Ctrl-C ends it)")
        try:
            server.serve_forever()
        except KeyboardInterrupt:
            say("ended")
