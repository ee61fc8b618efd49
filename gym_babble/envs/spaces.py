"""Gymnasium spaces from the core's spec, and the senses in an observation."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from gymnasium import spaces
from gymnasium.error import ResetNeeded

from gym_babble.errors import ActionError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gym_babble import _core


__all__ = ["Entry", "Measure", "Spec", "as_actions", "observation_space"]


@dataclass(frozen=True)
class Entry:
    """A named group of numbers."""

    name: str
    labels: tuple[str, ...]
    low: tuple[float, ...]
    high: tuple[float, ...]
    unit: str
    description: str

    @property
    def box(self) -> spaces.Box:
        """The space of these numbers."""
        return spaces.Box(
            np.array(self.low, np.float32), np.array(self.high, np.float32), dtype=np.float32
        )


@dataclass(frozen=True)
class Measure:
    """A named group of numbers that `info` shows."""

    name: str
    labels: tuple[str, ...]
    unit: str
    description: str


@dataclass(frozen=True)
class Spec:
    """The core's description of observations and actions."""

    senses: tuple[Entry, ...]
    goals: tuple[Entry, ...]
    action: Entry
    reward_terms: tuple[str, ...]
    facts: tuple[str, ...]
    measures: tuple[Measure, ...]
    outcomes: tuple[str, ...]
    max_episode_steps: int
    control_hz: float
    slices: tuple[tuple[str, slice], ...]
    """Where each sense stands in the flat observation."""

    @classmethod
    def of(cls, task: _core.Task) -> Spec:
        """The spec of a task."""
        raw = json.loads(task.spec())
        senses = tuple(_entry(entry) for entry in raw["senses"])
        ends = np.cumsum([len(entry.labels) for entry in senses]).tolist()
        starts = [0, *ends[:-1]]
        return cls(
            senses=senses,
            goals=tuple(_entry(entry) for entry in raw["goals"]),
            action=_entry(raw["action"]),
            reward_terms=tuple(raw["reward_terms"]),
            facts=tuple(raw["facts"]),
            measures=tuple(
                Measure(**{**one, "labels": tuple(one["labels"])}) for one in raw["measures"]
            ),
            outcomes=tuple(raw["outcomes"]),
            max_episode_steps=raw["max_episode_steps"],
            control_hz=raw["control_hz"],
            slices=tuple(
                (entry.name, slice(start, end))
                for entry, start, end in zip(senses, starts, ends, strict=True)
            ),
        )

    def measured(self, numbers: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
        """The measures by name from all of their numbers (..., n)."""
        ends = np.cumsum([len(one.labels) for one in self.measures])[:-1]
        parts = np.split(numbers, ends, axis=-1)
        return {one.name: part for one, part in zip(self.measures, parts, strict=True)}

    @property
    def flat(self) -> spaces.Box:
        """The space of the flat observation."""
        low = np.concatenate([entry.box.low for entry in self.senses])
        high = np.concatenate([entry.box.high for entry in self.senses])
        return spaces.Box(low, high, dtype=np.float32)


def _entry(raw: dict[str, Any]) -> Entry:
    return Entry(
        name=raw["name"],
        labels=tuple(raw["labels"]),
        low=tuple(raw["low"]),
        high=tuple(raw["high"]),
        unit=raw["unit"],
        description=raw["description"],
    )


def observation_space(spec: Spec, obs: str, retina_size: int) -> spaces.Space[Any]:
    """The observation space for a value of the option `obs`."""
    if obs == "flat":
        return spec.flat
    named: dict[str, spaces.Space[Any]] = {entry.name: entry.box for entry in spec.senses}
    if obs == "goal":
        goals = {entry.name: entry.box for entry in spec.goals}
        return spaces.Dict({"observation": spec.flat, **goals})
    if obs == "retina":
        image = spaces.Box(0, 255, (retina_size, retina_size, 3), np.uint8)
        return spaces.Dict({**named, "retina": image})
    return spaces.Dict(named)


def as_actions(action: Any, shape: tuple[int, ...]) -> NDArray[np.float32]:
    """An action as a float32 array of `shape`; lists and tensors in the CPU's memory are read too.

    Raises:
        ActionError: The action has another shape, or is not made of real numbers.
    """
    if type(action) is np.ndarray and action.dtype == np.float32 and action.shape == shape:
        return action
    try:
        array = np.asarray(_detached(action))
    except (ValueError, TypeError, RuntimeError) as error:
        raise ActionError(f"action is not an array: {error}") from error
    if array.dtype.kind not in "fiu":
        raise ActionError(f"action has dtype {array.dtype}, expected real numbers (float32)")
    if array.shape != shape:
        raise ActionError(f"action has shape {array.shape}, expected {shape}")
    with np.errstate(over="ignore"):
        single = array.astype(np.float32)
    # A finite number beyond float32 is out of range, not infinite.
    huge = np.isinf(single) & np.isfinite(array)
    single[huge] = np.sign(array[huge])
    return single


def _detached(action: Any) -> Any:
    """Without the gradients of PyTorch's tensors, which NumPy refuses to read; in lists too."""
    if isinstance(action, list | tuple):
        return [_detached(one) for one in action]
    detach = getattr(action, "detach", None)
    return action if detach is None else detach()


def need_reset() -> ResetNeeded:
    """The exception for looking at an environment before its first reset."""
    return ResetNeeded("call reset() before step() or render()")
