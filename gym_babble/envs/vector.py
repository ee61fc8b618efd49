"""Many BabbleReach environments stepped together in the core."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar

import gymnasium
import numpy as np
from gymnasium.utils.seeding import np_random
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from gym_babble import _core
from gym_babble.envs.task import RENDER_MODES, ReachChoices
from gym_babble.errors import ConfigError
from gym_babble.scenarios import apply_options
from gym_babble.spaces import as_actions, need_reset

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gym_babble.config import BodyLike

__all__ = ["BabbleReachVectorEnv"]

ENVS_PER_THREAD = 64
"""A step of fewer is shorter than waking another thread."""


class BabbleReachVectorEnv(VectorEnv[Any, Any, Any]):
    """A batch of `BabbleReachEnv`, what `gymnasium.make_vec` makes by default.

    Environment i of a batch that is reset with seed s is bit for bit the single environment reset
    with seed s + i, whatever the number of threads. Observations and infos are new arrays at each
    step.

    Autoreset: `NEXT_STEP` by default (the step after an end resets and ignores its action);
    `SAME_STEP` puts the ended episode's last observation and info in `infos["final_obs"]` and
    `infos["final_info"]`; with `DISABLED` ended environments are reset by
    `reset(options={"reset_mask": mask})`. `reset(options={"scenario": [...]})` takes one case for
    all environments or a list with one for each; options hold for autoresets.
    """

    metadata: ClassVar[dict[str, Any]] = {
        "render_modes": list(RENDER_MODES[1:]),
        "render_fps": 20,
        "autoreset_mode": AutoresetMode.NEXT_STEP,
    }

    def __init__(
        self,
        num_envs: int = 1,
        render_mode: str | None = None,
        *,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        threads: int | None = None,
        obs: str = "senses",
        control: str = "delta_posture",
        reward: str = "progress",
        body: BodyLike = "paper",
        settled: bool = False,
        max_episode_steps: int | None = None,
        camera: str = "third_person",
        width: int = 480,
        height: int = 480,
        retina_size: int = 84,
    ) -> None:
        """Makes the batch; arguments as `BabbleReachEnv`, and:

        Args:
            num_envs: How many environments.
            render_mode: "rgb_array", "rgb_array_list" or None.
            autoreset_mode: When an ended episode begins anew.
            threads: Threads that step the batch; one for each 64 environments, up to the number of
                processors, if not given. Results do not depend on it.
        """
        if render_mode == "human":
            raise ConfigError("render_mode = 'human' shows one environment; use gymnasium.make")
        self._arguments: dict[str, Any] = dict(
            obs=obs,
            control=control,
            reward=reward,
            body=body,
            settled=settled,
            max_episode_steps=max_episode_steps,
            render_mode=render_mode,
            camera=camera,
            width=width,
            height=height,
            retina_size=retina_size,
        )
        self.num_envs = num_envs
        self.render_mode = render_mode
        self._autoreset = _autoreset_mode(autoreset_mode)
        self._threads = threads if threads is not None else default_threads(num_envs)
        self._make_core()
        choices = self._choices
        self.single_observation_space = choices.observation_space
        self.single_action_space = choices.action_space
        self.observation_space = batch_space(choices.observation_space, num_envs)
        self.action_space = batch_space(choices.action_space, num_envs)
        self.metadata = {
            **type(self).metadata,
            "render_fps": choices.render_fps,
            "autoreset_mode": self._autoreset,
        }
        self._ready = False
        self._seeded = False
        self._shown = [0] * num_envs

    def _make_core(self) -> None:
        self._choices = ReachChoices(**self._arguments)
        self._batch = _core.Batch(
            self._choices.task,
            self.num_envs,
            autoreset=self._autoreset.value,
            threads=self._threads,
        )

    @property
    def choices(self) -> ReachChoices:
        """What this environment was made with."""
        return self._choices

    @property
    def threads(self) -> int:
        """Threads that step the batch."""
        return self._threads

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[Any, dict[str, Any]]:
        """Begins new episodes in all environments, or where `options["reset_mask"]` is true.

        Args:
            seed: s seeds environment i with s + i; a list has one seed for each.
            options: As for `BabbleReachEnv`, and `reset_mask`.

        Raises:
            ConfigError: An option is unknown or of a wrong length.
            ScenarioError: A case asked for cannot be played.
        """
        options = None if options is None else dict(options)
        mask = self._reset_mask(options)
        self._seed(seed, mask)
        if options is not None:
            for i, chosen in enumerate(self._each_options(options)):
                if mask[i]:
                    apply_options(self._batch, i, self._choices.task, chosen)
        self._batch.reset(mask.tolist())
        self._ready = True
        self._shown = [0 if chosen else k for k, chosen in zip(self._shown, mask, strict=True)]
        shown = self._batch.all()
        return self._observation(shown), self._infos(shown, mask)

    def step(
        self, actions: Any
    ) -> tuple[Any, NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        """One control step, or one whole movement, of every environment.

        Raises:
            ActionError: An action is NaN, infinite or of a wrong shape or type.
            gymnasium.error.ResetNeeded: An environment has to be reset first. Nothing was stepped.
        """
        self._batch.step(as_actions(actions, (self.num_envs, 2)))
        shown = self._batch.all()
        infos = self._infos(shown, np.ones(self.num_envs, np.bool_))
        if self._autoreset is AutoresetMode.SAME_STEP:
            self._add_final(infos)
        observation = self._observation(shown)
        return observation, shown["reward"], shown["terminated"], shown["truncated"], infos

    def _reset_mask(self, options: dict[str, Any] | None) -> NDArray[np.bool_]:
        if options is None or "reset_mask" not in options:
            return np.ones(self.num_envs, np.bool_)
        mask = np.asarray(options.pop("reset_mask"))
        if mask.shape != (self.num_envs,) or mask.dtype != np.bool_ or not mask.any():
            raise ConfigError(
                f"options['reset_mask'] has shape {mask.shape}, dtype {mask.dtype} and "
                f"{int(np.count_nonzero(mask))} true values; expected ({self.num_envs},), bool, "
                "at least one"
            )
        return mask

    def _seed(self, seed: int | Sequence[int | None] | None, mask: NDArray[np.bool_]) -> None:
        n = self.num_envs
        if seed is None:
            if not self._seeded:
                for i, value in enumerate(self.np_random.integers(2**63, size=n).tolist()):
                    self._batch.seed(i, value)
                self._seeded = True
            return
        if isinstance(seed, int | np.integer):
            super().reset(seed=int(seed))
            seeds: Sequence[int | None] = [int(seed) + i for i in range(n)]
        else:
            seeds = list(seed)
        if len(seeds) != n:
            raise ConfigError(f"seed has {len(seeds)} values, expected {n}")
        for i, value in enumerate(seeds):
            if mask[i] and (value is not None or not self._seeded):
                self._batch.seed(i, int(np_random(value)[0].integers(2**63)))
        self._seeded = True

    def _each_options(self, options: dict[str, Any]) -> list[Mapping[str, Any]]:
        cases = options.get("scenario")
        if cases is None or isinstance(cases, Mapping):
            return [options] * self.num_envs
        if len(cases) != self.num_envs:
            raise ConfigError(
                f"options['scenario'] has {len(cases)} cases, expected one or {self.num_envs}"
            )
        return [{**options, "scenario": case} for case in cases]

    def _observation(self, shown: Mapping[str, Any]) -> Any:
        goals = [shown["achieved_goal"], shown["desired_goal"]]
        retina = None
        if self._choices.obs == "retina":
            size = self._choices.retina_size
            images = [self._batch.render(i, "eye", size, size) for i in range(self.num_envs)]
            retina = np.stack(images)
        return self._choices.observation(shown["senses"], goals, retina)

    def _infos(self, shown: Mapping[str, Any], mask: NDArray[np.bool_]) -> dict[str, Any]:
        """Infos in the layout of `VectorEnv._add_info`: each key beside its mask."""
        spec = self._choices.spec
        terms: dict[str, Any] = {}
        for k, name in enumerate(spec.reward_terms):
            terms[name] = np.where(mask, shown["terms"][:, k], 0.0)
            terms[f"_{name}"] = mask.copy()
        return {
            "is_success": shown["is_success"] & mask,
            "_is_success": mask.copy(),
            "ever_success": shown["ever_success"] & mask,
            "_ever_success": mask.copy(),
            "outcome": np.where(mask, self._choices.outcomes[shown["outcome"]], None),
            "_outcome": mask.copy(),
            "reward_terms": terms,
            "_reward_terms": mask.copy(),
        }

    def _add_final(self, infos: dict[str, Any]) -> None:
        """Adds `final_obs` and `final_info` of the episodes that ended within the step."""
        ended = self._batch.ended()
        if ended is None:
            return
        indices, last = ended
        goals = (last["achieved_goal"], last["desired_goal"])
        names = self._choices.spec.reward_terms
        for k, i in enumerate(indices.tolist()):
            retina = None
            if self._choices.obs == "retina":
                size = self._choices.retina_size
                retina = self._batch.retina_ended(i, size)
            info = {
                "is_success": bool(last["is_success"][k]),
                "ever_success": bool(last["ever_success"][k]),
                "outcome": self._choices.spec.outcomes[last["outcome"][k]],
                "reward_terms": dict(zip(names, last["terms"][k].tolist(), strict=True)),
            }
            final = {
                "final_obs": self._choices.observation(
                    last["senses"][k], [goal[k] for goal in goals], retina
                ),
                "final_info": info,
            }
            self._add_info(infos, final, i)

    def render(self) -> tuple[Any, ...] | None:
        """A frame, or a list of the new ones, of each environment.

        Raises:
            gymnasium.error.ResetNeeded: There was no reset yet.
        """
        if self.render_mode is None:
            gymnasium.logger.warn("render() was called without a render_mode")
            return None
        if not self._ready:
            raise need_reset()
        if self.render_mode == "rgb_array":
            return tuple(self._frame(i, None) for i in range(self.num_envs))
        return tuple(self._new_frames(i) for i in range(self.num_envs))

    def _new_frames(self, i: int) -> list[NDArray[np.uint8]]:
        end = len(self._batch.trail(i))
        # A trail shorter than what was shown belongs to an episode begun since.
        first = self._shown[i] if self._shown[i] <= end else 0
        self._shown[i] = end
        return [self._frame(i, k) for k in range(first, end)]

    def _frame(self, i: int, moment: int | None) -> NDArray[np.uint8]:
        width, height = self._choices.size
        return self._batch.render(i, self._choices.camera, width, height, moment)

    def compute_reward(self, achieved_goal: Any, desired_goal: Any, info: Any) -> Any:
        """Reward of the goal form for goals (2,) or (n, 2) [m]; `info` is not used."""
        del info
        return self._choices.goal_reward(achieved_goal, desired_goal)

    def call(self, name: str, *args: Any, **kwargs: Any) -> tuple[Any, ...]:
        """Calls a method, or gets an attribute, of each environment."""
        results = []
        for i in range(self.num_envs):
            value = self.of_one(i, name)
            results.append(value(*args, **kwargs) if callable(value) else value)
        return tuple(results)

    def get_attr(self, name: str) -> tuple[Any, ...]:
        """An attribute of each environment."""
        return self.call(name)

    def set_attr(self, name: str, values: Any) -> None:
        """Sets an attribute of the batch, which its environments share.

        Args:
            name: Name of the attribute.
            values: One value for all, or a list or tuple with an equal one for each environment.

        Raises:
            AttributeError: The environments have their own values of it, set at a reset.
            ConfigError: The values are not as many as the environments, or differ.
        """
        if name in _OF_ONE or name in ("choices", "observation_space", "action_space"):
            raise AttributeError(f"{name} cannot be set; make the environment anew")
        if isinstance(values, list | tuple):
            if len(values) != self.num_envs or any(value != values[0] for value in values[1:]):
                raise ConfigError(f"{name}: expected one value, or {self.num_envs} equal ones")
            values = values[0]
        setattr(self, name, values)

    def of_one(self, i: int, name: str) -> Any:
        """An attribute or method of environment i; what is not its own is the batch's."""
        if name in _OF_ONE:
            return _OF_ONE[name](self, i)
        if name == "observation_space":
            return self.single_observation_space
        if name == "action_space":
            return self.single_action_space
        return getattr(self, name)

    def get_state(self) -> list[bytes]:
        """The state of each environment, from which `set_state` continues bit for bit."""
        return [self._batch.save(i) for i in range(self.num_envs)]

    def set_state(self, states: Sequence[bytes]) -> None:
        """Continues each environment from a state.

        Raises:
            ConfigError: The states are not as many as the environments.
            SnapshotError: Bytes are not such a state; all environments are as they were.
        """
        if len(states) != self.num_envs:
            raise ConfigError(f"{len(states)} states, expected {self.num_envs}")
        before = self.get_state()
        try:
            for i, state in enumerate(states):
                self._batch.load(i, state)
        except ValueError:
            for i, state in enumerate(before):
                self._batch.load(i, state)
            raise
        self._ready = self._seeded = True
        self._shown = [len(self._batch.trail(i)) for i in range(self.num_envs)]

    def __getstate__(self) -> dict[str, Any]:
        state = {k: v for k, v in self.__dict__.items() if k not in ("_batch", "_choices")}
        return {"attributes": state, "core": self.get_state()}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state["attributes"])
        self._make_core()
        for i, core in enumerate(state["core"]):
            self._batch.load(i, core)


_OF_ONE: dict[str, Callable[[BabbleReachVectorEnv, int], Any]] = {
    "get_state": lambda env, i: lambda: env._batch.save(i),
    "state_hash": lambda env, i: lambda: env._batch.state_hash(i),
    "scenario": lambda env, i: env._batch.case(i),
    "trajectory": lambda env, i: env._batch.trail(i),
    "render": lambda env, i: lambda: (
        env._frame(i, None) if env.render_mode == "rgb_array" else env._new_frames(i)
    ),
}
"""What `call` and `get_attr` find in each environment, not in the batch."""


def default_threads(num_envs: int) -> int:
    """One thread for each 64 environments, up to the processors this process may use."""
    if hasattr(os, "sched_getaffinity"):
        processors = len(os.sched_getaffinity(0))
    else:
        processors = os.cpu_count() or 1
    return max(1, min(processors, num_envs // ENVS_PER_THREAD))


def _autoreset_mode(mode: AutoresetMode | str) -> AutoresetMode:
    try:
        return mode if isinstance(mode, AutoresetMode) else AutoresetMode(mode)
    except ValueError as error:
        known = ", ".join(m.value for m in AutoresetMode)
        raise ConfigError(f"autoreset_mode = {mode!r} is not one of {known}") from error
