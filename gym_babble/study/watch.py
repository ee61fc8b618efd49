"""What hears how a study goes on."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from collections.abc import Sequence

    from gym_babble.study.run import RunSpec

__all__ = ["Watch"]


class Watch(Protocol):
    """Hears how a study goes on. Its methods are called from several threads."""

    def begin(self, waiting: Sequence[RunSpec], done: int, unfit: Sequence[str]) -> None:
        """Which runs will be done, how many are done already, and what does not fit."""

    def progress(self, spec: RunSpec, share: float) -> None:
        """What share of a run's learning is done."""

    def end(self, spec: RunSpec, record: dict[str, Any]) -> None:
        """A run is finished, or has failed."""
