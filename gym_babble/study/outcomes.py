"""Outcomes of an agent's tests, case by case, as rates with intervals."""

from __future__ import annotations

import difflib
import math
from dataclasses import dataclass, field
from itertools import chain, compress
from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble.errors import ConfigError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

__all__ = ["Evaluation", "joined", "wilson"]

MANY_SIZES = 5
"""More sizes than these are split in two halves."""


@dataclass(frozen=True)
class Evaluation:
    """The results of an evaluation, case by case."""

    cases: tuple[Mapping[str, Any], ...]
    """The cases."""
    outcomes: tuple[str, ...]
    """Outcome of each case."""
    steps: tuple[int, ...]
    """Control steps of each case; 1 in `pattern` control."""
    returns: tuple[float, ...]
    """Sum of rewards of each case."""
    facts: dict[str, tuple[bool, ...]] = field(default_factory=dict)
    """Facts at the end of each case, with the names in `info`."""
    possible: tuple[str, ...] = ()
    """All outcomes that an episode can have."""

    def __len__(self) -> int:
        """Number of cases."""
        return len(self.outcomes)

    def count(self, name: str) -> int:
        """Number of cases with this outcome, or in which this fact is true.

        Raises:
            ConfigError: There is no such outcome or fact.
        """
        if name in self.facts:
            return sum(self.facts[name])
        if name in self.possible:
            return self.outcomes.count(name)
        known = (*self.possible, *self.facts)
        near = difflib.get_close_matches(str(name), known, 1)
        meant = f"; did you mean {near[0]!r}?" if near else ""
        raise ConfigError(f"{name!r} is not one of {', '.join(known)}{meant}")

    def rate(self, name: str) -> float:
        """Share of cases with this outcome, or in which this fact is true.

        Raises:
            ConfigError: There is no such outcome or fact.
        """
        return self.count(name) / len(self)

    def interval(self, name: str) -> tuple[float, float]:
        """95 % Wilson interval of the rate, an interval over episodes of this one agent.

        It is about other cases. It says nothing about other seeds of learning:
        `gym_babble.study.statistics` has intervals over seeds.

        Raises:
            ConfigError: There is no such outcome or fact.
        """
        return wilson(self.count(name), len(self))

    def by_size(self) -> dict[str, Evaluation]:
        """The cases of each size of the object, small ones first; empty if all have one size.

        More than five sizes make two halves. In reaching there are no sizes.
        """
        sizes = np.array([case.get("diameter", 0.0) for case in self.cases])
        each = np.unique(sizes).tolist()
        if len(each) < 2:
            return {}
        if len(each) <= MANY_SIZES:
            return {f"{100 * size:g} cm": self._where(sizes == size) for size in each}
        low, middle, high = each[0], (each[0] + each[-1]) / 2, each[-1]
        return {
            f"{100 * low:.2g}–{100 * middle:.2g} cm": self._where(sizes <= middle),
            f"{100 * middle:.2g}–{100 * high:.2g} cm": self._where(sizes > middle),
        }

    def _where(self, chosen: Sequence[bool]) -> Evaluation:
        """Some of the cases."""
        return Evaluation(
            cases=tuple(compress(self.cases, chosen)),
            outcomes=tuple(compress(self.outcomes, chosen)),
            steps=tuple(compress(self.steps, chosen)),
            returns=tuple(compress(self.returns, chosen)),
            facts={name: tuple(compress(held, chosen)) for name, held in self.facts.items()},
            possible=self.possible,
        )


def joined(parts: Sequence[Evaluation]) -> Evaluation:
    """The cases of one test, played in parts."""
    chained = chain.from_iterable
    return Evaluation(
        cases=tuple(chained(part.cases for part in parts)),
        outcomes=tuple(chained(part.outcomes for part in parts)),
        steps=tuple(chained(part.steps for part in parts)),
        returns=tuple(chained(part.returns for part in parts)),
        facts={name: tuple(chained(part.facts[name] for part in parts)) for name in parts[0].facts},
        possible=parts[0].possible,
    )


def wilson(count: int, n: int, z: float = 1.959964) -> tuple[float, float]:
    """Wilson score interval of a rate over episodes, 95 % by default (Wilson 1927)."""
    if n == 0:
        return 0.0, 1.0
    p = count / n
    middle = (p + z * z / (2 * n)) / (1 + z * z / n)
    half = z / (1 + z * z / n) * math.sqrt(p * (1 - p) / n + z * z / (4 * n * n))
    # Rounding must not put the rate outside its interval, which could happen at 0 or 1.
    return max(0.0, min(p, middle - half)), min(1.0, max(p, middle + half))
