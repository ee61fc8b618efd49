"""What all agents share: how they are called, where they act."""

from __future__ import annotations

import inspect
from typing import TYPE_CHECKING, Any, Protocol, TypeAlias, TypeVar, runtime_checkable

import gymnasium
import numpy as np
from gymnasium.vector import VectorEnv

from gym_babble import _core
from gym_babble.checks import shown
from gym_babble.envs.interface import Interface
from gym_babble.errors import ConfigError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from gym_babble._core import Learner, Plans, Reference

__all__ = [
    "Agent",
    "EnvLike",
    "Observation",
    "Planner",
    "interface_of",
    "predictor",
]

EnvLike: TypeAlias = Any
"""An id, or an environment: Gymnasium's, vector, or stable-baselines3's VecEnv."""

Observation: TypeAlias = Any
"""What an environment gives, of any `obs=`: a dict of arrays, or one flat array."""

P = TypeVar("P", bound="Planner")


@runtime_checkable
class Agent(Protocol):
    """What evaluation, comparison and films need of an agent.

    `predict(observation)` with this one argument is enough: such an agent is given one observation
    at a time and returns an action.
    """

    def predict(
        self,
        observation: Observation,
        state: Any = None,
        episode_start: Any = None,
        deterministic: bool = False,  # noqa: FBT001, FBT002 - stable-baselines3's signature
    ) -> tuple[Any, Any]:
        """Actions for observations, and the state for the next call."""
        ...


def predictor(agent: Any) -> Any:
    """`predict` of an agent with all four arguments, whichever of them it takes.

    An agent of one argument is called for each environment of a batch by itself.

    Raises:
        ConfigError: It has no `predict`.
    """
    predict = getattr(agent, "predict", None)
    if not callable(predict):
        raise ConfigError(f"{agent!r} is not an agent: it has no predict(observation)")
    try:
        parameters = list(inspect.signature(predict).parameters.values())
    except ValueError:
        return predict
    positional = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    if any(p.kind is inspect.Parameter.VAR_POSITIONAL for p in parameters):
        return predict
    taken = [p.name for p in parameters if p.kind in positional]
    if len(taken) >= 4:
        return predict
    if len(taken) > 1 or not taken:
        raise ConfigError(
            f"{agent!r} is not an agent: predict takes (observation), or (observation, state, "
            f"episode_start, deterministic), and this one takes ({', '.join(taken)})"
        )

    def one_by_one(
        observation: Observation, state: Any, episode_start: Any, deterministic: Any
    ) -> tuple[Any, None]:
        del state, deterministic
        n = len(np.atleast_1d(episode_start))
        if n == _batch_size(observation):
            actions = [_action(predict(_row(observation, i))) for i in range(n)]
            return np.stack(actions), None
        return _action(predict(observation)), None

    return one_by_one


def _action(predicted: Any) -> Any:
    """An action, also of an agent that returns a state beside it."""
    return predicted[0] if isinstance(predicted, tuple) else predicted


def _batch_size(observation: Observation) -> int | None:
    """How many environments an observation is of; None for that of one environment."""
    if isinstance(observation, dict):
        first = next(iter(observation.values()))
        # A retina has two more axes.
        return len(first) if np.ndim(first) in {2, 4} else None
    return len(observation) if np.ndim(observation) > 1 else None


def _row(observation: Observation, i: int) -> Observation:
    if isinstance(observation, dict):
        return {name: value[i] for name, value in observation.items()}
    return observation[i]


def interface_of(env: EnvLike) -> Interface:
    """Task, options and spaces of an environment.

    Raises:
        ConfigError: It is not an environment of this package.
    """
    if isinstance(env, str):
        try:
            env = gymnasium.make(env)
        except gymnasium.error.Error as error:
            raise ConfigError(f"env = {shown(env)} is not a registered environment") from error
    if isinstance(env, gymnasium.Env | VectorEnv):
        found = getattr(env.unwrapped, "interface", None)
    elif hasattr(env, "get_attr"):
        found = env.get_attr("interface")[0]
    else:
        found = getattr(env, "interface", None)
    if not isinstance(found, Interface):
        raise ConfigError(f"{shown(env)} is not a Babble environment")
    return found


class Planner:
    """An agent that decides at the beginning of an episode, and acts on it as the core does.

    In reaching it chooses a whole movement. In `pattern` control an action is its choice; in
    `posture` and `delta_posture` control it plays the path of the pattern generators open loop. In
    grasping it chooses a posture: the arm goes there with the hand open, and the hand closes when
    it touches the object.
    """

    _core: Learner | Reference

    def __init__(self, env: EnvLike) -> None:
        self._interface = interface_of(env)

    @property
    def interface(self) -> Interface:
        """Task, options and spaces of the environment that it acts in."""
        return self._interface

    def predict(
        self,
        observation: Observation,
        state: Plans | None = None,
        episode_start: Any = None,
        deterministic: bool = True,  # noqa: FBT001, FBT002 - stable-baselines3's signature
    ) -> tuple[NDArray[np.float32], Plans]:
        """Actions for an observation, or a batch of them, as stable-baselines3's agents give them.

        Args:
            observation: As the environment gives it, of any `obs=`.
            state: What the last call returned; None at first.
            episode_start: Which of the environments have begun a new episode (n,).
            deterministic: Not used.

        Returns:
            Actions (k,) or (n, k), and the state for the next call.
        """
        del deterministic
        senses = self._senses(observation)
        batch = np.atleast_2d(senses)
        if state is not None and not isinstance(state, _core.Plans):
            raise ConfigError(f"state = {shown(state)} is not what predict returned")
        starts = _starts(episode_start, len(batch))
        actions, state = self._act(batch, starts, state)
        return (actions if senses.ndim > 1 else actions[0]), state

    def _act(
        self, senses: NDArray[np.float32], starts: list[bool], plans: Plans | None
    ) -> tuple[NDArray[np.float32], Plans]:
        """Actions (n, k) for flat senses (n, m), and the plans for the next call."""
        return self._core.predict(self._interface.task, senses, starts, plans)

    def _senses(self, observation: Observation) -> NDArray[np.float32]:
        """Flat senses (m,) or (n, m) from any form of observation.

        A dict need not have what its task's networks do not look at.
        """
        if not isinstance(observation, dict):
            return _array(observation)
        if "observation" in observation:
            return _array(observation["observation"])
        slices = self._interface.spec.slices
        known = {name: _array(observation[name]) for name, _ in slices if name in observation}
        if not known:
            raise ConfigError(
                f"observation has {', '.join(map(str, observation))}, expected "
                f"{', '.join(name for name, _ in slices)}"
            )
        shape = next(iter(known.values())).shape[:-1]
        senses = np.zeros((*shape, slices[-1][1].stop), np.float32)
        for name, part in slices:
            if name in known:
                expected = (*shape, part.stop - part.start)
                if known[name].shape != expected:
                    raise ConfigError(
                        f"observation[{name!r}] has shape {known[name].shape}, expected {expected}"
                    )
                senses[..., part] = known[name]
        return senses

    def __getstate__(self) -> dict[str, Any]:
        return {k: v for k, v in self.__dict__.items() if k != "_core"}

    def __setstate__(self, state: Mapping[str, Any]) -> None:
        self.__dict__.update(state)


def _array(observation: Any) -> NDArray[np.float32]:
    """Senses (m,) or (n, m) as an array.

    Raises:
        ConfigError: They are not numbers, or have another shape.
    """
    try:
        array = np.ascontiguousarray(observation, np.float32)
    except (OverflowError, TypeError, ValueError) as error:
        raise ConfigError(f"observation = {shown(observation)}: {error}") from error
    if array.ndim > 2:
        raise ConfigError(f"observation has shape {array.shape}, expected (m,) or (n, m)")
    return array


def _starts(given: Any, n: int) -> list[bool]:
    """Which of n environments have begun a new episode; none unless given.

    Raises:
        ConfigError: It is not one truth value, or one for each environment.
    """
    if given is None:
        return [False] * n
    try:
        starts = np.broadcast_to(np.asarray(given), n)
    except ValueError as error:
        raise ConfigError(f"episode_start = {shown(given)}: expected {n} truth values") from error
    if starts.dtype.kind not in "biuf":
        raise ConfigError(f"episode_start = {shown(given)}: expected {n} truth values")
    found: list[bool] = starts.astype(np.bool_).tolist()
    return found
