"""Serves the lab's page to a browser on this machine."""

from __future__ import annotations

from functools import partial
from http import HTTPStatus
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from typing import TYPE_CHECKING, Any

from gym_babble.checks import check_whole
from gym_babble.errors import ConfigError
from gym_babble.lab import PAGE

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["page_server"]


class _Files(SimpleHTTPRequestHandler):
    """The files of a folder, with the types that browsers need, and without listings."""

    # Python asks the machine for types, and some machines know others or none.
    extensions_map: dict[str, str] = {  # noqa: RUF012 - declared so by the base class
        "": "application/octet-stream",
        ".css": "text/css",
        ".html": "text/html",
        ".js": "text/javascript",
        ".json": "application/json",
        ".png": "image/png",
        ".svg": "image/svg+xml",
        ".wasm": "application/wasm",
        ".webmanifest": "application/manifest+json",
    }
    index_pages = ("index.html",)

    def list_directory(self, path: Any) -> None:
        """Refuses to list a folder."""
        del path
        self.send_error(HTTPStatus.NOT_FOUND)

    def log_message(self, format: str, *args: Any) -> None:  # noqa: A002 - the base class's name
        """Says nothing of requests."""

    def end_headers(self) -> None:
        """Lets browsers ask each time whether a file has changed."""
        self.send_header("Cache-Control", "no-cache")
        super().end_headers()


def page_server(port: int, folder: Path = PAGE) -> ThreadingHTTPServer:
    """A server of the lab's page on 127.0.0.1, which this machine alone can reach.

    Args:
        port: Port to listen on; 0 for any free one, then in `server_port`.
        folder: Folder of the page.

    Raises:
        ConfigError: The port is out of its bounds, or the package has no page.
        OSError: The port cannot be listened on.
    """
    check_whole("port", port, 0, 65_535, "")
    if not (folder / "index.html").is_file():
        raise ConfigError(
            f"this package was built without the lab's page: {folder} is missing. Building it "
            "needs Node 20.19 or newer: in a checkout, `make lab` builds the page and serves it"
        )
    return ThreadingHTTPServer(("127.0.0.1", port), partial(_Files, directory=str(folder)))
