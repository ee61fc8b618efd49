"""What single and vector environments share: options, spaces, observations, cases asked for."""

from __future__ import annotations

import inspect
import json
import warnings
from collections.abc import Mapping
from copy import deepcopy
from difflib import get_close_matches
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble import _core
from gym_babble.checks import numbers, plain, shown
from gym_babble.config import ConfigLike, config_json
from gym_babble.envs.labels import SCENARIO_LABELS, check_labels, config_label
from gym_babble.envs.registry import TASKS, CasePart, task_entry
from gym_babble.envs.spaces import Spec, observation_space
from gym_babble.errors import ConfigError, ScenarioError

if TYPE_CHECKING:
    from gymnasium import spaces
    from numpy.typing import NDArray

    from gym_babble.envs.registry import TaskEntry

__all__ = ["RENDER_MODES", "Interface", "document", "outcome_of"]

RENDER_MODES = ("human", "rgb_array", "rgb_array_list")


class Interface:
    """Gymnasium's view of a task: its options, spaces, observations and cases.

    It keeps nothing that it was given: a copy or a pickle has the config that was read, and not the
    path, dict or list that it came from, which may have changed since.
    """

    def __init__(
        self, task: str, *, config: ConfigLike, render_mode: str | None, options: Mapping[str, Any]
    ) -> None:
        self.entry = task_entry(task)
        if render_mode is not None and render_mode not in RENDER_MODES:
            raise ConfigError(f"render_mode = {shown(render_mode)} is not one of {RENDER_MODES}")
        given = plain(options, "")
        if render_mode is not None:
            given["record"] = True
        self.task = _core.Task(task, config_json(config), json.dumps(given))
        self.render_mode = render_mode
        self._ignored: set[str] = set()
        self.given: dict[str, Any] = deepcopy(given)
        """The options that were given, by name."""
        self.options: dict[str, Any] = deepcopy(self.entry.defaults | given)
        """All options by name."""
        self.quantities: dict[str, Any] = {
            name: value if isinstance(value, float) else np.array(value)
            for name, value in json.loads(self.task.quantities()).items()
        }
        """Numbers that agents need, in SI units, by name."""
        self.spec = Spec.of(self.task)
        self.observation_space: spaces.Space[Any] = observation_space(
            self.spec, self.obs, self.retina_size
        )
        self.action_space = self.spec.action.box
        self.outcomes = np.array(_core.outcomes(), dtype=object)
        """Names by the core's codes."""
        codes = {str(name): code for code, name in enumerate(self.outcomes)}
        self.outcome_codes = tuple((name, codes[name]) for name in self.spec.outcomes)
        """The task's outcomes with the core's codes."""

    def __reduce__(self) -> tuple[Any, ...]:
        return _interface, (self.entry.name, self.task.config(), self.render_mode, self.given)

    @cached_property
    def config_label(self) -> str:
        """Name of the config, as cases bear it."""
        return config_label(self.task, self.entry.name)

    @property
    def obs(self) -> str:
        """What an observation consists of."""
        return str(self.options["obs"])

    @property
    def unconverged_steps(self) -> int | None:
        """Physics steps so far in which the solver of contacts did not converge.

        Of all environments that share this interface, together. None where no solver tells: in
        reaching, which needs none, and with the engine rapier.
        """
        return self.task.unconverged_steps()

    @property
    def retina_size(self) -> int:
        """Edge of the eye's image [pixel]."""
        return int(self.options.get("retina_size", 0))

    @property
    def camera(self) -> str:
        """Where pictures are taken from."""
        return str(self.options["camera"])

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of pictures [pixel]."""
        return int(self.options["width"]), int(self.options["height"])

    @property
    def render_fps(self) -> int:
        """Frames a second of a video in real time."""
        return round(self.spec.control_hz)

    def request(self, options: Any) -> dict[str, Any]:
        """What `reset(options=...)` asks of the cases to come, as the core takes it.

        Options of others, which foreign runners pass, are ignored with a warning, once each.

        Raises:
            ConfigError: An option is nearly one of those known and not it, or a scenario has an
                unknown part.
            ScenarioError: A part of the case is not what it should be.
        """
        if not isinstance(options, Mapping):
            raise ConfigError(f"options is a {type(options).__name__}, expected a dict")
        scenario = options.get("scenario")
        parts = {part.name: part for part in self.entry.case_parts}
        known = ("scenario", *parts)
        for name in options:
            if name not in (*known, *SCENARIO_LABELS):
                self._ignore(str(name), known)
        if scenario is not None:
            if not isinstance(scenario, Mapping):
                raise ScenarioError(f"scenario is a {type(scenario).__name__}, expected a Scenario")
            check_labels(scenario, self.entry.name, self.options, self.config_label)
            for name in scenario:
                if name not in (*parts, *SCENARIO_LABELS):
                    raise ConfigError(_unknown("scenario", str(name), tuple(parts)))
            options = {**scenario, **options}
        return {
            name: _value(part, options[name]) for name, part in parts.items() if name in options
        }

    def _ignore(self, name: str, known: tuple[str, ...]) -> None:
        """Warns, the first time, of an option that is not ours.

        Raises:
            ConfigError: It is nearly one of ours, or one that this environment does not have.
        """
        of_others = (part.name for task in TASKS.values() for part in task.case_parts)
        if name in of_others or _near(name, (*known, "reset_mask")):
            raise ConfigError(_unknown("options", name, known))
        if name not in self._ignored:
            self._ignored.add(name)
            there_are = ", ".join(known)
            warnings.warn(f"options: {name!r} is ignored; there are {there_are}", stacklevel=4)

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
        """Reward of the goal form for goals (k,) or (..., k), broadcast; `info` is not used.

        Raises:
            ConfigError: The goals are not k finite numbers each, or their shapes do not fit.
        """
        del info
        achieved = numbers("achieved_goal", achieved_goal, np.float32)
        desired = numbers("desired_goal", desired_goal, np.float32)
        try:
            achieved, desired = np.broadcast_arrays(achieved, desired)
        except ValueError as error:
            raise ConfigError(f"achieved_goal and desired_goal: {error}") from error
        width = len(self.spec.goals[0].labels)
        if achieved.shape[-1:] != (width,):
            raise ConfigError(
                f"goals have shape {achieved.shape}, expected (..., {width}) "
                f"[{self.spec.goals[0].unit}]"
            )
        rewards = self.task.goal_reward(achieved.reshape(-1, width), desired.reshape(-1, width))
        return float(rewards[0]) if achieved.ndim == 1 else rewards.reshape(achieved.shape[:-1])


def _interface(task: str, config: str, render_mode: str | None, given: Any) -> Interface:
    """The interface that was copied or pickled."""
    return Interface(task, config=json.loads(config), render_mode=render_mode, options=given)


def _near(name: str, known: tuple[str, ...]) -> list[str]:
    """The known name that was probably meant, if there is one."""
    return get_close_matches(name.lower(), known, n=1, cutoff=0.8)


def _unknown(where: str, name: str, known: tuple[str, ...]) -> str:
    """An error's text for an unknown name."""
    meant = "".join(f" (did you mean {near!r}?)" for near in _near(name, known))
    return f"{where}: {name!r} unknown{meant}; there are {', '.join(known)}"


def outcome_of(info: Mapping[str, Any]) -> str:
    """Name of the outcome in the info of one environment."""
    outcome: Mapping[str, bool] = info["outcome"]
    return next(name for name, is_so in outcome.items() if is_so)


def _value(part: CasePart, value: Any) -> bool | float | list[float] | None:
    """A part of a case as the core takes it; None is none.

    Raises:
        ScenarioError: The value is not made of so many finite numbers, or not a truth value.
    """
    if value is None:
        return None
    if not part.lengths:
        if isinstance(value, bool | np.bool_):
            return bool(value)
        raise ScenarioError(f"{part.name} = {shown(value)} is not True or False")
    one = part.lengths == (0,)
    expected = "a number" if one else f"{' or '.join(map(str, part.lengths))} numbers"
    try:
        array = numbers(part.name, value)
    except ConfigError as error:
        raise ScenarioError(f"{error}; expected {expected} [{part.unit}]") from error
    if array.shape != () if one else (array.ndim != 1 or len(array) not in part.lengths):
        raise ScenarioError(
            f"{part.name} = {shown(value)} has shape {array.shape}, expected {expected} "
            f"[{part.unit}]"
        )
    found: float | list[float] = array.tolist()
    return found


def document(cls: type, entry: TaskEntry, general: type) -> None:
    """Adds the options of a task to the signature and the docstring of its environment class."""
    keyword = inspect.Parameter.KEYWORD_ONLY
    shared = inspect.signature(general).parameters.values()
    before = [p for p in shared if p.kind is not inspect.Parameter.VAR_KEYWORD and p.name != "task"]
    options = [inspect.Parameter(o.name, keyword, default=o.default) for o in entry.options]
    cls.__signature__ = inspect.Signature([*before, *options])  # type: ignore[attr-defined]
    lines = "".join(f"\n    - `{o.name}` (`{o.default!r}`): {o.summary}" for o in entry.options)
    cls.__doc__ = f"{cls.__doc__}\n    ## Options\n{lines}\n"
