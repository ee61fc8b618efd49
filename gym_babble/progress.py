"""Progress bars with the time left."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

__all__ = ["track"]


def track(parts: Iterable[int], text: str, *, total: int, show: bool) -> Iterator[int]:
    """Yields the parts of a whole, showing how much of `total` is done and the time left.

    The bar goes to stderr: stdout belongs to results.
    """
    if not show:
        yield from parts
        return
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=Console(stderr=True)) as progress:
        task = progress.add_task(text, total=total)
        for part in parts:
            yield part
            progress.advance(task, part)
