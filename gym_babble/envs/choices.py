"""What single and vector environments share: choices, spaces, observations, cases asked for."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from gym_babble import _core
from gym_babble.envs.spaces import Spec, observation_space
from gym_babble.errors import ConfigError, ScenarioError

if TYPE_CHECKING:
    from gymnasium import spaces
    from numpy.typing import NDArray

    from gym_babble.envs.spaces import Task

CAMERAS = ("third_person", "eye", "fovea", "edges")
RENDER_MODES = ("human", "rgb_array", "rgb_array_list")
SCENARIO_LABELS = ("protocol", "index")
"""Parts of a scenario that say where it is from."""


class Choices(ABC):
    """The keyword arguments of an environment, checked, and what follows from them.

    Each task has a class of its own, which takes the task's arguments too.
    """

    task_name: ClassVar[str]
    """What messages call the task."""
    case_options: ClassVar[tuple[str, ...]]
    """What `reset(options=...)` may give of a case."""
    envs_per_thread: ClassVar[int]
    """A step of fewer is shorter than waking another thread."""

    def __init__(
        self,
        task: Task,
        *,
        obs: str,
        render_mode: str | None,
        camera: str,
        width: int,
        height: int,
        retina_size: int,
    ) -> None:
        if render_mode is not None and render_mode not in RENDER_MODES:
            raise ConfigError(f"render_mode = {render_mode!r} is not one of {RENDER_MODES}")
        if camera not in CAMERAS:
            raise ConfigError(f"camera = {camera!r} is not one of {CAMERAS}")
        check_whole("width", width, 16, 4096, "pixels")
        check_whole("height", height, 16, 4096, "pixels")
        check_whole("retina_size", retina_size, 36, 2048, "pixels")
        self.task = task
        self.obs, self.render_mode = obs, render_mode
        self.camera, self.size = camera, (width, height)
        self.retina_size = retina_size
        self.spec = Spec.of(task)
        self.observation_space: spaces.Space[Any] = observation_space(self.spec, obs, retina_size)
        self.action_space = self.spec.action.box
        self.outcomes = np.array(_core.outcomes(), dtype=object)
        """Names by the core's codes."""

    @property
    def render_fps(self) -> int:
        """Frames a second of a video in real time."""
        return round(self.spec.control_hz)

    def request(self, options: Any) -> dict[str, Any]:
        """What `reset(options=...)` asks of the cases to come, as the core takes it.

        Raises:
            ConfigError: An option is unknown.
            ScenarioError: A part of the case is not what it should be.
        """
        if not isinstance(options, Mapping):
            raise ConfigError(f"options is a {type(options).__name__}, expected a dict")
        scenario = options.get("scenario")
        given = {name: value for name, value in options.items() if name != "scenario"}
        if scenario is not None:
            if not isinstance(scenario, Mapping):
                raise ScenarioError(f"scenario is a {type(scenario).__name__}, expected a Scenario")
            given = {**scenario, **given}
        unknown = set(given) - {*self.case_options, *SCENARIO_LABELS}
        if unknown:
            known = ", ".join(("scenario", *self.case_options))
            raise ConfigError(f"options: {sorted(map(str, unknown))} unknown; there are {known}")
        parts = [name for name in self.case_options if name in given]
        return {name: self.part_of_case(name, given[name]) for name in parts}

    @abstractmethod
    def part_of_case(self, name: str, value: Any) -> Any:
        """The value of one of the `case_options`, as the core takes it.

        Raises:
            ScenarioError: The value is not what it should be.
        """

    def observation(
        self,
        senses: NDArray[np.float32],
        goals: list[NDArray[np.float32]],
        retina: NDArray[np.uint8] | None,
    ) -> Any:
        """An observation, of one environment or of a batch, from flat senses (…, n)."""
        if self.obs == "flat":
            return senses
        if self.obs == "goal":
            return {"observation": senses, "achieved_goal": goals[0], "desired_goal": goals[1]}
        named = {name: senses[..., part] for name, part in self.spec.slices}
        if retina is not None:
            named["retina"] = retina  # type: ignore[assignment]
        return named

    def goal_reward(self, achieved_goal: Any, desired_goal: Any, info: Any) -> Any:
        """Reward of the goal form for goals (2,) or (..., 2) [m], broadcast; `info` is not used.

        Raises:
            ConfigError: The goals are not pairs of numbers, or their shapes do not fit.
        """
        del info
        try:
            achieved, desired = np.broadcast_arrays(
                np.asarray(achieved_goal, np.float32), np.asarray(desired_goal, np.float32)
            )
        except (TypeError, ValueError) as error:
            raise ConfigError(f"achieved_goal and desired_goal: {error}") from error
        if achieved.shape[-1:] != (2,):
            raise ConfigError(f"goals have shape {achieved.shape}, expected (..., 2) [m]")
        rewards = self.task.goal_reward(achieved.reshape(-1, 2), desired.reshape(-1, 2))
        return float(rewards[0]) if achieved.ndim == 1 else rewards.reshape(achieved.shape[:-1])


def check_whole(name: str, value: Any, low: int, high: int, unit: str) -> None:
    """Raises `ConfigError` unless a value is a whole number within its bounds."""
    whole = isinstance(value, int | np.integer) and not isinstance(value, bool)
    if not whole or not low <= value <= high:
        raise ConfigError(f"{name} = {value!r} is not a whole number in [{low}, {high}] {unit}")


def check_flags(**flags: Any) -> None:
    """Raises `ConfigError` unless each value is True or False: other values have a truth too."""
    for name, value in flags.items():
        if not isinstance(value, bool | np.bool_):
            raise ConfigError(f"{name} = {value!r} is not True or False")


def check_names(**names: Any) -> None:
    """Raises `ConfigError` unless each value is a text; the core knows which ones there are."""
    for name, value in names.items():
        if not isinstance(value, str):
            raise ConfigError(f"{name} = {value!r} is not a name")


def numbers(name: str, value: Any, n: int, unit: str = "m") -> list[float] | None:
    """The n numbers of a part of a case; None is none.

    Raises:
        ScenarioError: The value is not n numbers.
    """
    if value is None:
        return None
    try:
        found = [float(x) for x in value]
    except (TypeError, ValueError) as error:
        raise ScenarioError(f"{name} = {value!r} is not made of {n} numbers [{unit}]") from error
    if len(found) != n:
        raise ScenarioError(f"{name} = {value!r} has {len(found)} numbers, expected {n} [{unit}]")
    return found


def check_seed(seed: int) -> None:
    """Raises `ConfigError` for a seed outside the core's range."""
    if not 0 <= seed < 2**64:
        raise ConfigError(f"seed = {seed} is not in [0, 2^64)")
