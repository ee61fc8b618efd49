"""The single environment: a batch of one."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

import gymnasium

from gym_babble import _core
from gym_babble.checks import check_seed, check_whole
from gym_babble.envs.interface import RENDER_MODES, Interface, document
from gym_babble.envs.making import Made, time_limit
from gym_babble.envs.member import BatchMember
from gym_babble.envs.registry import task_entry
from gym_babble.envs.spaces import as_actions
from gym_babble.envs.window import Window

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy as np
    from numpy.typing import NDArray

    from gym_babble.config import ConfigLike

__all__ = ["BabbleEnv"]


class BabbleEnv(Made, gymnasium.Env[Any, Any]):
    """An environment of any task, which `task` names. Tasks with docs have a class of their own."""

    metadata: dict[str, Any] = {"render_modes": list(RENDER_MODES)}  # noqa: RUF012 - Gymnasium's
    task_name: ClassVar[str] = ""
    """The task of a class that has one of its own."""
    _interface_class: ClassVar[type[Interface]] = Interface

    def __init_subclass__(cls, **kwargs: Any) -> None:
        """Adds the task's options to the signature and the docstring."""
        super().__init_subclass__(**kwargs)
        if cls.task_name:
            document(cls, task_entry(cls.task_name), BabbleEnv)

    def __init__(
        self,
        render_mode: str | None = None,
        *,
        task: str | None = None,
        config: ConfigLike = "paper",
        **options: Any,
    ) -> None:
        """Makes the environment.

        Args:
            render_mode: "rgb_array", "rgb_array_list" (one frame a control step), "human" (needs
                the extra `human`), or None.
            task: Name of the task, for the general class.
            config: A profile ("paper", "icub"), the path of a TOML or JSON file, a dict of what
                differs from a profile, or a `gym_babble.Config`.
            options: The task's options; unspecified ones have their defaults.

        Raises:
            ConfigError: An option or a config field is unknown, of a wrong kind or out of bounds.
        """
        limit = time_limit()
        if limit is not None:
            options.setdefault("max_episode_steps", limit)
        self._interface = self._interface_class(
            task or self.task_name, config=config, render_mode=render_mode, options=options
        )
        self.render_mode = render_mode
        self._make_core()
        self.observation_space = self._interface.observation_space
        self.action_space = self._interface.action_space
        self.metadata = {**type(self).metadata, "render_fps": self._interface.render_fps}
        self._shape = self._interface.action_space.shape
        self._seeded = False
        self._window: Window | None = None

    def _make_core(self) -> None:
        self._batch = _core.Batch(self._interface.task, 1)
        self._member = BatchMember(self._interface, self._batch, 0)

    @property
    def interface(self) -> Interface:
        """Options, spec and spaces of this environment."""
        return self._interface

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Begins a new episode.

        Args:
            seed: Starts the stream of cases anew.
            options: What to ask of the case; see the class.

        Raises:
            ConfigError: An option is unknown, or the seed is not a whole number in [0, 2^64).
            ScenarioError: The case asked for cannot be played. The options are forgotten, and the
                episode goes on.
            BusyError: Another thread uses the environment.
        """
        request = None if options is None else self._interface.request(options)
        with self._batch:
            self._seed(seed)
            if request is not None:
                self._batch.request(0, request)
            self._batch.reset()
            self._member.begin()
            observation, _, _, _, info = self._complete(self._batch.one())
            if self.render_mode == "human":
                self._show()
        return observation, info

    def _seed(self, seed: int | None) -> None:
        """Starts the stream of cases anew; by chance if it never began."""
        if seed is not None:
            seed = check_seed(seed)
        elif not self._seeded:
            seed = int(self.np_random.integers(2**63))
        else:
            return
        super().reset(seed=seed)
        self._batch.seed(0, seed)
        self._seeded = True

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """One step.

        Raises:
            ActionError: The action is NaN, infinite or of a wrong shape or type.
            gymnasium.error.ResetNeeded: The episode has ended, or never began.
            BusyError: Another thread uses the environment.
        """
        with self._batch:
            shown = self._batch.step_one(as_actions(action, self._shape))
            result = self._complete(shown)
            if self.render_mode == "human":
                self._show()
        return result

    def _complete(
        self, shown: tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]
    ) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        interface = self._interface
        senses, reward, terminated, truncated, info = shown
        goals = self._batch.one_goals() if interface.obs == "goal" else []
        retina = self._member.retina() if interface.obs == "retina" else None
        return interface.observation(senses, goals, retina), reward, terminated, truncated, info

    @property
    def compute_reward(self) -> Callable[[Any, Any, Any], Any]:
        """Reward for achieved and desired goals, with obs="goal".

        Raises:
            AttributeError: The observations have no goals; stable-baselines3 goes by this.
        """
        if self._interface.obs != "goal":
            raise AttributeError("compute_reward exists only with obs='goal'")
        return self._interface.goal_reward

    def render(self) -> Any:
        """A frame (height, width, 3), or the frames since the last call, one a control step.

        A reset drops the frames of the episode before. In "human" mode the window shows each step
        by itself and nothing is returned; once its user closes it, episodes go on without it.

        Raises:
            gymnasium.error.ResetNeeded: There was no reset yet.
        """
        with self._batch:
            if self.render_mode == "human" and self._member.ready:
                return self._show()
            return self._member.render()

    @property
    def moments(self) -> int:
        """Recorded moments of the episode: its start, and each control step; for `picture`.

        There are none unless the environment has a render_mode or `record=True`.
        """
        return self._batch.moments(0)

    def picture(self, camera: str, size: tuple[int, int], moment: int) -> NDArray[np.uint8]:
        """A picture (height, width, 3) of a recorded moment.

        Args:
            camera: As the option `camera`.
            size: Width and height [pixel].
            moment: 0 for the start, up to `moments` − 1.

        Raises:
            ConfigError: There is no such camera or moment, or the size is out of bounds.
        """
        with self._batch:
            check_whole("moment", moment, 0, self.moments - 1, "recorded moments")
            return self._batch.render(0, camera, *size, moment)

    def _show(self) -> None:
        if self._window is None:
            self._window = Window(self._interface.size, self._interface.render_fps)
        if not self._window.is_closed:
            for frame in self._member.new_frames():
                self._window.show(frame)

    def close(self) -> None:
        """Closes the window, if there is one."""
        if self._window is not None:
            self._window.close()
            self._window = None

    def get_state(self) -> bytes:
        """The whole state, from which `set_state` continues bit for bit."""
        return self._member.get_state()

    def set_state(self, state: bytes) -> None:
        """Continues from a state of an environment with the same arguments.

        Raises:
            SnapshotError: The bytes are not such a state; the environment is as it was.
        """
        with self._batch:
            self._member.set_state(state)
            self._seeded = True

    def state_hash(self) -> int:
        """A number that two states share only if they are the same to the bit."""
        return self._member.state_hash()

    @property
    def scenario(self) -> dict[str, Any]:
        """The case of the running episode, as `reset` options."""
        return self._member.scenario

    @property
    def trajectory(self) -> NDArray[np.float64]:
        """The way of the hand since the reset (k, 2) [m]; recorded with a render_mode."""
        return self._member.trajectory

    def __getstate__(self) -> dict[str, Any]:
        hidden = ("_batch", "_member", "_window")
        state = {k: v for k, v in self.__dict__.items() if k not in hidden}
        return {"attributes": state, "core": self._member.freeze()}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state["attributes"])
        self._make_core()
        self._member.thaw(state["core"])
        self._window = None
