"""What single and vector environments share: choices, spaces, observations, infos."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble import _core
from gym_babble.config import BodyLike, config_json
from gym_babble.errors import ConfigError
from gym_babble.spaces import Spec, observation_space

if TYPE_CHECKING:
    from gymnasium import spaces
    from numpy.typing import NDArray

CAMERAS = ("third_person", "eye")
RENDER_MODES = ("human", "rgb_array", "rgb_array_list")


class ReachChoices:
    """The keyword arguments of an environment, checked, and what follows from them."""

    def __init__(
        self,
        *,
        obs: str,
        control: str,
        reward: str,
        body: BodyLike,
        settled: bool,
        max_episode_steps: int,
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
        check_whole("max_episode_steps", max_episode_steps, 1, 1_000_000, "control steps")
        self.task = _core.Task(
            config_json(body),
            control=control,
            reward=reward,
            goal=obs == "goal",
            settled=settled,
            # A movement is an episode, whatever limit was registered for other controls.
            max_episode_steps=1 if control == "pattern" else max_episode_steps,
            record=render_mode is not None,
        )
        self.obs, self.control, self.render_mode = obs, control, render_mode
        self.camera, self.size = camera, (width, height)
        self.retina_size = retina_size
        self.spec = Spec.of(self.task)
        self.observation_space: spaces.Space[Any] = observation_space(self.spec, obs, retina_size)
        self.action_space = self.spec.action.box
        self.outcomes = np.array(self.spec.outcomes, dtype=object)

    @property
    def render_fps(self) -> int:
        """Frames a second of a video in real time."""
        return round(self.spec.control_hz)

    def observation(
        self,
        senses: NDArray[np.float32],
        goals: list[NDArray[np.float32]],
        retina: NDArray[np.uint8] | None,
    ) -> Any:
        """An observation, of one environment or of a batch, from flat senses (…, 11)."""
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

    @property
    def joint_range(self) -> NDArray[np.float64]:
        """Widths of the joint ranges (2,) [rad]."""
        return np.array(self.task.joint_range)

    @property
    def delta_posture(self) -> float:
        """Change of an equilibrium point by an action of 1 [rad]."""
        return self.task.delta_posture

    @property
    def b_range(self) -> tuple[float, float]:
        """Lowest and highest b1 and b2."""
        low, high = self.task.b_range
        return low, high


def check_whole(name: str, value: Any, low: int, high: int, unit: str) -> None:
    """Raises `ConfigError` unless a value is a whole number within its bounds."""
    whole = isinstance(value, int | np.integer) and not isinstance(value, bool)
    if not whole or not low <= value <= high:
        raise ConfigError(f"{name} = {value!r} is not a whole number in [{low}, {high}] {unit}")
