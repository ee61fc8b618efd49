"""Reading the files of agents, packed or not."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gym_babble.checks import check_path
from gym_babble.errors import AgentFileError

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["read_agent"]

PACKED = b"\xfd7zXZ\x00"
"""How a file of xz begins."""
MOST_BYTES = 2**30
"""Bytes that a packed file may have once it is unpacked."""


def read_agent(path: str | Path) -> bytes:
    """What a file of an agent holds; one that is packed by xz is unpacked.

    Raises:
        FileNotFoundError: There is no such file.
        AgentFileError: A packed file is cut short, altered, or would be larger than 1 GiB.
    """
    data = check_path("path", path).read_bytes()
    if not data.startswith(PACKED):
        return data
    import lzma  # noqa: PLC0415 - some builds of Python lack it

    unpacking = lzma.LZMADecompressor(lzma.FORMAT_XZ)
    try:
        whole = unpacking.decompress(data, MOST_BYTES)
    except lzma.LZMAError as error:
        raise AgentFileError(f"{path}: {error}") from error
    if not unpacking.eof:
        if unpacking.needs_input:
            raise AgentFileError(f"{path}: the file is cut short")
        raise AgentFileError(f"{path}: it holds more than {MOST_BYTES:,} bytes")
    return whole
