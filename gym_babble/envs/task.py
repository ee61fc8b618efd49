"""What single and vector environments share: choices, spaces, observations, infos."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

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

    PATTERN_STEPS: ClassVar[int] = 1

    def __init__(
        self,
        *,
        obs: str,
        control: str,
        reward: str,
        body: BodyLike,
        settled: bool,
        max_episode_steps: int | None,
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
        for name, edge in (("width", width), ("height", height)):
            if not 16 <= edge <= 4096:
                raise ConfigError(f"{name} = {edge} is not in [16, 4096] pixels")
        if max_episode_steps is None:
            max_episode_steps = self.PATTERN_STEPS if control == "pattern" else 240
        if max_episode_steps < 1:
            raise ConfigError(f"max_episode_steps = {max_episode_steps} is not at least 1")
        self.task = _core.Task(
            config_json(body),
            control=control,
            reward=reward,
            goal=obs == "goal",
            settled=settled,
            max_episode_steps=max_episode_steps,
            record=render_mode is not None,
        )
        self.obs, self.control = obs, control
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

    def goal_reward(self, achieved_goal: Any, desired_goal: Any) -> Any:
        """Reward of the goal form for goals (2,) or (n, 2) [m]."""
        achieved = np.asarray(achieved_goal, np.float32)
        desired = np.asarray(desired_goal, np.float32)
        rewards = self.task.goal_reward(np.atleast_2d(achieved), np.atleast_2d(desired))
        return float(rewards[0]) if achieved.ndim == 1 else rewards

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
