"""Many environments of a task stepped together in the core."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from gym_babble import _core
from gym_babble.checks import check_seed, check_threads, check_whole, processors, shown
from gym_babble.envs.interface import RENDER_MODES, Interface, document
from gym_babble.envs.making import Made
from gym_babble.envs.member import BatchMember
from gym_babble.envs.registry import task_entry
from gym_babble.envs.spaces import as_actions
from gym_babble.errors import ConfigError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gym_babble.config import ConfigLike

__all__ = ["BabbleVectorEnv"]

MOST_ENVS = 1_000_000
MOST_IMAGE_BYTES = 2**32
"""Size of the images of all environments together [byte]."""


class BabbleVectorEnv(Made, VectorEnv[Any, Any, Any]):
    """A batch of environments of any task. Each task has a class with its arguments.

    Environment i of a batch that is reset with seed s is bit for bit the single environment reset
    with seed s + i, whatever the number of threads. Observations and infos are new arrays at each
    step.

    Autoreset: `NEXT_STEP` by default (the step after an end resets and ignores its action);
    `SAME_STEP` puts the ended episode's last observation and info in `infos["final_obs"]` and
    `infos["final_info"]`; with `DISABLED` ended environments are reset by
    `reset(options={"reset_mask": mask})`. `reset(options={"scenario": [...]})` takes one case for
    all environments or a list with one for each; options hold for autoresets. A `reset_mask` alone
    leaves them as they are, and so does None in the list for one environment.
    """

    metadata: dict[str, Any] = {  # noqa: RUF012 - declared by VectorEnv
        "render_modes": list(RENDER_MODES[1:]),
        "autoreset_mode": AutoresetMode.NEXT_STEP,
    }
    task_name: ClassVar[str] = ""
    """The task of a class that has one of its own."""
    _interface_class: ClassVar[type[Interface]] = Interface

    def __init_subclass__(cls, **kwargs: Any) -> None:
        """Adds the task's options to the signature and the docstring."""
        super().__init_subclass__(**kwargs)
        if cls.task_name:
            document(cls, task_entry(cls.task_name), BabbleVectorEnv)

    def __init__(
        self,
        num_envs: int = 1,
        render_mode: str | None = None,
        *,
        task: str | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        threads: int | None = None,
        config: ConfigLike = "paper",
        **options: Any,
    ) -> None:
        """Makes the batch.

        Args:
            num_envs: How many environments.
            render_mode: "rgb_array", "rgb_array_list" or None.
            task: Name of the task, for the general class.
            autoreset_mode: When an ended episode begins anew.
            threads: Threads that step the batch; as many as pay off, up to the number of
                processors, if not given. Results do not depend on it.
            config: As for the single environment.
            options: The task's options; unspecified ones have their defaults.

        Raises:
            ConfigError: An option or a config field is unknown, of a wrong kind or out of bounds.
        """
        if render_mode == "human":
            raise ConfigError("render_mode = 'human' shows one environment; use gymnasium.make")
        self._interface = self._interface_class(
            task or self.task_name, config=config, render_mode=render_mode, options=options
        )
        self.render_mode = render_mode
        self.num_envs = num_envs = check_whole("num_envs", num_envs, 1, MOST_ENVS, "environments")
        self.autoreset_mode = _autoreset_mode(autoreset_mode)
        if threads is None:
            threads = default_threads(num_envs, self._interface.entry.envs_per_thread)
        self._threads = check_threads(threads)
        self._make_core()
        interface = self._interface
        self.single_observation_space = interface.observation_space
        self.single_action_space = interface.action_space
        self.observation_space = batch_space(interface.observation_space, num_envs)
        self.action_space = batch_space(interface.action_space, num_envs)
        self._shape = (num_envs, *interface.action_space.shape)
        self.metadata = {
            **type(self).metadata,
            "render_fps": interface.render_fps,
            "autoreset_mode": self.autoreset_mode,
        }
        self._seeded = False
        self._own = frozenset(self.__dict__)

    def _make_core(self) -> None:
        if self._interface.obs == "retina":
            check_images(self.num_envs, self._interface.retina_size)
        self._batch = _core.Batch(
            self._interface.task,
            self.num_envs,
            autoreset=self.autoreset_mode.value,
            threads=self._threads,
        )
        self._members = [BatchMember(self._interface, self._batch, i) for i in range(self.num_envs)]

    @property
    def interface(self) -> Interface:
        """Options, spec and spaces of each environment."""
        return self._interface

    @property
    def np_random_seed(self) -> tuple[int, ...]:  # type: ignore[override] # As SyncVectorEnv's.
        """Seed of each environment's cases, which the single environment would take.

        −1 where it is unknown: before the first reset, and after `set_state`.
        """
        return tuple(member.np_random_seed for member in self._members)

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
            options: As for the single environment, and `reset_mask`.

        Raises:
            ConfigError: An option is unknown or of a wrong length, or a seed is not a whole number
                in [0, 2^64).
            ScenarioError: A case asked for cannot be played. The options are forgotten, and all
                episodes go on.
            BusyError: Another thread uses the batch.
        """
        mask, requests = self._read_options(options)
        chosen = np.flatnonzero(mask).tolist()
        with self._batch:
            self._seed(seed, mask)
            if requests is not None:
                for i in chosen:
                    if (request := requests[i]) is not None:
                        self._batch.request(i, request)
            self._batch.reset(mask.tolist())
            for i in chosen:
                self._members[i].begin()
            shown = self._batch.all(mask.tolist())
            return self._observation(shown), shown["infos"]

    def step(
        self, actions: Any
    ) -> tuple[Any, NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        """One step of every environment.

        Raises:
            ActionError: An action is NaN, infinite or of a wrong shape or type.
            gymnasium.error.ResetNeeded: An environment has to be reset first. Nothing was stepped.
            ScenarioError: No case could be drawn for an ended episode. All environments have to be
                reset, as after an interruption by Ctrl-C.
            BusyError: Another thread uses the batch.
        """
        with self._batch:
            self._batch.step(as_actions(actions, self._shape))
            if self.render_mode == "rgb_array_list":
                for member in self._members:
                    member.follow()
            shown = self._batch.all()
            infos = shown["infos"]
            if self.autoreset_mode is AutoresetMode.SAME_STEP:
                self._add_final(infos)
            observation = self._observation(shown)
        return observation, shown["reward"], shown["terminated"], shown["truncated"], infos

    def _read_options(
        self, options: Any
    ) -> tuple[NDArray[np.bool_], list[dict[str, Any] | None] | None]:
        """Which environments to reset, and what to ask of the cases of each."""
        everywhere = np.ones(self.num_envs, np.bool_)
        if options is None:
            return everywhere, None
        if not isinstance(options, Mapping) or "reset_mask" not in options:
            return everywhere, self._requests(options)
        mask = self._reset_mask(options["reset_mask"])
        others = {name: value for name, value in options.items() if name != "reset_mask"}
        return mask, self._requests(others) if others else None

    def _reset_mask(self, given: Any) -> NDArray[np.bool_]:
        try:
            mask = np.asarray(given)
        except ValueError as error:
            raise ConfigError(f"options['reset_mask'] = {shown(given)}: {error}") from error
        if mask.shape != (self.num_envs,) or mask.dtype != np.bool_ or not mask.any():
            raise ConfigError(
                f"options['reset_mask'] has shape {mask.shape}, dtype {mask.dtype} and "
                f"{int(np.count_nonzero(mask))} true values; expected ({self.num_envs},), bool, "
                "at least one"
            )
        return mask

    def _seed(self, seed: int | Sequence[int | None] | None, mask: NDArray[np.bool_]) -> None:
        n = self.num_envs
        if isinstance(seed, int | np.integer):
            super().reset(seed=check_seed(seed))
            seeds: list[int | None] = [int(seed) + i for i in range(n)]
        else:
            seeds = [None] * n if seed is None else _listed(seed)
        if len(seeds) != n:
            raise ConfigError(f"seed has {len(seeds)} values, expected {n}")
        if not self._seeded:
            drawn = self.np_random.integers(2**63, size=n).tolist()
            seeds = [
                new if given is None else given for given, new in zip(seeds, drawn, strict=True)
            ]
            mask = np.ones(n, np.bool_)
        chosen = [
            (member, check_seed(value))
            for member, value, masked in zip(self._members, seeds, mask, strict=True)
            if masked and value is not None
        ]
        for member, value in chosen:
            member.seed(value)
        self._seeded = True

    def _requests(self, options: Any) -> list[dict[str, Any] | None]:
        cases = options.get("scenario") if isinstance(options, Mapping) else None
        if not isinstance(cases, Sequence) or isinstance(cases, str):
            return [self._interface.request(options)] * self.num_envs
        if len(cases) != self.num_envs:
            raise ConfigError(
                f"options['scenario'] has {len(cases)} cases, expected one or {self.num_envs}"
            )
        return [
            None
            if case is None and len(options) == 1
            else self._interface.request({**options, "scenario": case})
            for case in cases
        ]

    def _observation(self, shown: Mapping[str, Any]) -> Any:
        goals = self._goals(shown)
        retina = None
        if self._interface.obs == "retina":
            retina = np.stack([member.retina() for member in self._members])
        return self._interface.observation(shown["senses"], goals, retina)

    def _goals(self, shown: Mapping[str, Any]) -> list[NDArray[np.float32]]:
        """Achieved and desired goals, where they are part of the observation."""
        if self._interface.obs != "goal":
            return []
        return [shown["achieved_goal"], shown["desired_goal"]]

    def _add_final(self, infos: dict[str, Any]) -> None:
        """Adds `final_obs` and `final_info` of the episodes that ended within the step."""
        ended = self._batch.ended()
        if ended is None:
            return
        indices, last = ended
        goals = self._goals(last)
        spec, codes = self._interface.spec, self._interface.outcome_codes
        for name in spec.reward_terms:
            # The new episodes have had no reward yet; what the step gave stands in `final_info`.
            infos["reward_terms"][name][indices] = 0.0
        for k, i in enumerate(indices.tolist()):
            retina = None
            if self._interface.obs == "retina":
                size = self._interface.retina_size
                retina = self._batch.retina_ended(i, size)
            info = dict(zip(spec.facts, last["facts"][k].tolist(), strict=True))
            info["outcome"] = {name: bool(last["outcome"][k] == code) for name, code in codes}
            terms = last["terms"][k].tolist()
            info["reward_terms"] = dict(zip(spec.reward_terms, terms, strict=True))
            if spec.measures:
                info |= spec.measured(last["measures"][k])
            final = {
                "final_obs": self._interface.observation(
                    last["senses"][k], [goal[k] for goal in goals], retina
                ),
                "final_info": info,
            }
            self._add_info(infos, final, i)

    def render(self) -> tuple[Any, ...]:
        """A frame of each environment, or a list of those since the last call.

        A list spans autoresets: it has the frames of ended episodes too, of the last 1,000.
        `reset` drops them.

        Raises:
            gymnasium.error.ResetNeeded: There was no reset yet.
        """
        with self._batch:
            return tuple(member.render() for member in self._members)

    @property
    def compute_reward(self) -> Callable[[Any, Any, Any], Any]:
        """Reward for achieved and desired goals, with obs="goal".

        Raises:
            AttributeError: The observations have no goals; stable-baselines3 goes by this.
        """
        if self._interface.obs != "goal":
            raise AttributeError("compute_reward exists only with obs='goal'")
        return self._interface.goal_reward

    def call(self, name: str, *args: Any, **kwargs: Any) -> tuple[Any, ...]:
        """Calls a method, or gets an attribute, of each environment.

        Raises:
            ConfigError: The method steps, resets or closes; the batch does that.
        """
        if name in ("reset", "step", "close"):
            raise ConfigError(f"call({name!r}): use {name}() of the vector environment")
        results = []
        for i in range(self.num_envs):
            value = self.of_one(i, name)
            results.append(value(*args, **kwargs) if callable(value) else value)
        return tuple(results)

    def get_attr(self, name: str) -> tuple[Any, ...]:
        """An attribute of each environment."""
        return self.call(name)

    def set_attr(self, name: str, values: Any) -> None:
        """Sets an attribute of your own in each environment.

        Args:
            name: Name of the attribute.
            values: One value for all, or a list or tuple with one for each environment.

        Raises:
            AttributeError: The environments themselves have an attribute of this name.
            ConfigError: The values are not as many as the environments.
        """
        if not isinstance(values, list | tuple):
            values = [values] * self.num_envs
        if len(values) != self.num_envs:
            raise ConfigError(f"{name}: {len(values)} values, expected one or {self.num_envs}")
        for i, value in enumerate(values):
            self.set_of_one(i, name, value)

    def set_of_one(self, i: int, name: str, value: Any) -> None:
        """Sets an attribute of your own in environment i.

        Raises:
            AttributeError: The environment itself has an attribute of this name.
        """
        member = self._members[i]
        if name in self._own or hasattr(type(self), name) or hasattr(member, name):
            raise AttributeError(f"{name} cannot be set: the environment has it by itself")
        member.attributes[name] = value

    def of_one(self, i: int, name: str) -> Any:
        """An attribute or method of environment i; what is not its own is the batch's."""
        member = self._members[i]
        if name in member.attributes:
            return member.attributes[name]
        if hasattr(member, name) and not name.startswith("_"):
            return getattr(member, name)
        if name == "observation_space":
            return self.single_observation_space
        if name == "action_space":
            return self.single_action_space
        return getattr(self, name)

    def get_state(self) -> list[bytes]:
        """The state of each environment, from which `set_state` continues bit for bit."""
        with self._batch:
            return [member.get_state() for member in self._members]

    def set_state(self, states: Sequence[bytes]) -> None:
        """Continues each environment from a state.

        Raises:
            ConfigError: The states are not as many as the environments.
            SnapshotError: Bytes are not such a state; all environments are as they were.
        """
        if not isinstance(states, list | tuple) or len(states) != self.num_envs:
            raise ConfigError(f"states = {shown(states)} is not a list of {self.num_envs} states")
        with self._batch:
            before = [member.freeze() for member in self._members]
            try:
                for member, state in zip(self._members, states, strict=True):
                    member.set_state(state)
            except BaseException:  # Ctrl-C too.
                for member, frozen in zip(self._members, before, strict=True):
                    member.thaw(frozen)
                raise
            self._seeded = True

    def __getstate__(self) -> dict[str, Any]:
        hidden = ("_batch", "_members")
        state = {k: v for k, v in self.__dict__.items() if k not in hidden}
        with self._batch:
            return {"attributes": state, "core": [member.freeze() for member in self._members]}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state["attributes"])
        self._make_core()
        for member, core in zip(self._members, state["core"], strict=True):
            member.thaw(core)


def default_threads(num_envs: int, envs_per_thread: int) -> int:
    """As many as have enough environments each, up to the processors this process may use."""
    return max(1, min(processors(), num_envs // envs_per_thread))


def _listed(seed: Any) -> list[int | None]:
    if isinstance(seed, Sequence | np.ndarray) and not isinstance(seed, str | bytes):
        return list(seed)
    raise ConfigError(f"seed = {shown(seed)} is not a whole number or a list of them")


def check_images(num_envs: int, size: int) -> None:
    """Raises `ConfigError` for images that would fill the memory."""
    if num_envs * size * size * 3 > MOST_IMAGE_BYTES:
        most = MOST_IMAGE_BYTES // (size * size * 3)
        raise ConfigError(
            f"num_envs = {num_envs} with obs='retina' and retina_size = {size}: at most {most} "
            f"environments, whose images have {MOST_IMAGE_BYTES / 2**30:g} GB"
        )


def _autoreset_mode(mode: AutoresetMode | str) -> AutoresetMode:
    try:
        return mode if isinstance(mode, AutoresetMode) else AutoresetMode(mode)
    except ValueError as error:
        known = ", ".join(m.value for m in AutoresetMode)
        raise ConfigError(f"autoreset_mode = {shown(mode)} is not one of {known}") from error
