"""Progress bars with the time left."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

__all__ = ["track"]


def track(parts: Iterable[int], text: str, *, total: int, show: bool) -> Iterator[int]:
    """Yields the parts and shows progress towards `total`, with the time left.

    Args:
        parts: Sizes of the parts; their sum is `total`.
        text: Label of the bar.
        total: Sum of all parts.
        show: Show the bar, on stderr; stdout is for results.
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
