"""Models of stable-baselines3: do they fit an environment, and what did they see in theirs?"""

from __future__ import annotations

import json
import zipfile
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from gymnasium import spaces

from gym_babble.errors import AgentFileError, ConfigError, MissingExtraError

if TYPE_CHECKING:
    from pathlib import Path

    from gym_babble.agents.acting import EnvArguments

__all__ = ["NormalizedModel", "fitted", "is_model", "load_model", "load_normalizer"]


WITHOUT_REPLAY: dict[str, Any] = {
    "replay_buffer_class": None,
    "replay_buffer_kwargs": {},
    "buffer_size": 1,
}
"""What a model that only acts is loaded with. One of hindsight replay needs no environment then."""


class NormalizedModel:
    """A model that sees observations normalized, as `VecNormalize` did while it learnt."""

    def __init__(self, model: Any, normalizer: Any) -> None:
        self.model = model
        self.normalizer = normalizer

    def predict(
        self,
        observation: Any,
        state: Any = None,
        episode_start: Any = None,
        deterministic: bool = False,  # noqa: FBT001, FBT002 - stable-baselines3's signature
    ) -> tuple[Any, Any]:
        """Actions for observations that are not normalized."""
        seen = self.normalizer.normalize_obs(observation)
        actions, state = self.model.predict(seen, state, episode_start, deterministic)
        return actions, state


def is_model(agent: Any) -> bool:
    """Whether an agent has spaces, as models of stable-baselines3 have."""
    return isinstance(getattr(agent, "observation_space", None), spaces.Space)


def fitted(
    model: Any, arguments: EnvArguments, normalizer: Any = None, *, any_obs: bool
) -> tuple[Any, EnvArguments]:
    """The model as it acts in an environment, and the environment in the form that it sees.

    Args:
        model: The model.
        arguments: Where it shall act.
        normalizer: The `VecNormalize` that it learnt behind, if it does not have it itself.
        any_obs: Whether `obs` may become "flat" where the model has seen flat observations.

    Raises:
        ConfigError: The model has seen other observations or done other actions, it made whole
            movements and the control is another, or the statistics of its `VecNormalize` are
            missing.
    """
    _check_length(model, arguments)
    forms = [arguments]
    if any_obs:
        forms.append(replace(arguments, options={**arguments.options, "obs": "flat"}))
    interfaces = [form.interface() for form in forms]
    seen = _channels_last(model.observation_space)
    fitting = [i for i, found in enumerate(interfaces) if found.observation_space == seen]
    if not fitting:
        raise ConfigError(_other_space("observations", seen, interfaces[0].observation_space))
    if model.action_space != interfaces[0].action_space:
        raise ConfigError(_other_space("actions", model.action_space, interfaces[0].action_space))
    own = getattr(model, "get_vec_normalize_env", lambda: None)()
    normalizer = normalizer if normalizer is not None else own
    if normalizer is None:
        _check_unnormalized(model)
    chosen = forms[fitting[0]]
    return (model if normalizer is None else NormalizedModel(model, normalizer)), chosen


def _channels_last(space: spaces.Space[Any]) -> spaces.Space[Any]:
    """A space with images as environments have them: models put the three colours first."""
    if isinstance(space, spaces.Dict):
        return spaces.Dict({name: _channels_last(part) for name, part in space.items()})
    if isinstance(space, spaces.Box) and space.dtype == np.uint8 and space.shape[:1] == (3,):
        low, high = (np.moveaxis(bound, 0, -1) for bound in (space.low, space.high))
        return spaces.Box(low, high, dtype=np.uint8)
    return space


def _other_space(what: str, learnt: spaces.Space[Any], given: spaces.Space[Any]) -> str:
    """Says in which part two spaces differ."""
    if isinstance(learnt, spaces.Dict) and isinstance(given, spaces.Dict):
        if learnt.keys() != given.keys():
            names = (", ".join(map(str, space)) for space in (learnt, given))
            return "it has learnt from {}: {}, and the test gives {}".format(what, *names)
        name = next(name for name in learnt if learnt[name] != given[name])
        what, learnt, given = f"{what} of {name}", learnt[name], given[name]
    if learnt.shape == given.shape:
        return (
            f"it has learnt with {what} in other bounds than the test has: another body (config), "
            "or wrappers"
        )
    return f"it has learnt with {what} {_short(learnt)}, and the test has {_short(given)}"


def _short(space: spaces.Space[Any]) -> str:
    """A space in a few words, without its bounds."""
    if isinstance(space, spaces.Dict):
        return f"Dict({', '.join(space)})"
    return f"{type(space).__name__}{space.shape}"


def _check_length(model: Any, arguments: EnvArguments) -> None:
    """A model's last episodes tell whether an action was a whole movement."""
    episodes = getattr(model, "ep_info_buffer", None) or ()
    lengths = {int(episode["l"]) for episode in episodes}
    if not lengths:
        return
    whole, pattern = lengths == {1}, arguments.option("control") == "pattern"
    if whole != pattern:
        raise ConfigError(
            f"its last episodes took up to {max(lengths)} steps, so it learnt in "
            f"{'`pattern` control' if whole else 'another control than `pattern`'}, and the test "
            f"is in {arguments.option('control')!r}"
        )


def _check_unnormalized(model: Any) -> None:
    """A model keeps the last observations of its learning, as it saw them."""
    last, before = (getattr(model, name, None) for name in ("_last_obs", "_last_original_obs"))
    if last is None or before is None:
        return  # It has not learnt, or not behind VecNormalize.
    space = model.observation_space
    names = list(space) if isinstance(space, spaces.Dict) else [None]
    pairs = [(last, space) if name is None else (last[name], space[name]) for name in names]
    if any(np.any((seen < box.low) | (seen > box.high)) for seen, box in pairs):
        raise ConfigError(
            "it has learnt from observations that VecNormalize had normalized, and their "
            "statistics are missing: give them with --vec-normalize FILE, or load the model with "
            "env=VecNormalize.load(FILE, venv)"
        )


def load_model(path: Path) -> Any:
    """The model in a zip that stable-baselines3 wrote. Loading it unpickles, which can run code.

    Raises:
        AgentFileError: The file is not such a model.
        MissingExtraError: stable-baselines3 is not installed.
    """
    try:
        import stable_baselines3
        import torch
    except ImportError as error:
        raise MissingExtraError("stable-baselines3", "sb3") from error
    torch.set_num_threads(1)  # These networks are too small for a second one to help.
    algorithm = getattr(stable_baselines3, _algorithm(path))
    try:
        return algorithm.load(path, device="cpu", custom_objects=WITHOUT_REPLAY)
    except Exception as error:  # Unpickling can raise anything.
        raise AgentFileError(f"{path}: {error}") from error


def load_normalizer(path: Path, arguments: EnvArguments) -> Any:
    """The `VecNormalize` in a file that its `save` wrote. Loading it unpickles.

    Raises:
        FileNotFoundError: There is no such file.
        AgentFileError: The file is not one.
    """
    from stable_baselines3.common.vec_env import DummyVecEnv, VecNormalize

    venv = DummyVecEnv([arguments.single])
    try:
        return VecNormalize.load(str(path), venv)
    except FileNotFoundError:
        raise
    except Exception as error:  # Unpickling can raise anything.
        raise AgentFileError(f"{path}: not the statistics of a VecNormalize: {error}") from error


def _algorithm(path: Path) -> str:
    """Which of stable-baselines3's algorithms for continuous actions wrote a zip."""
    try:
        with zipfile.ZipFile(path) as archive:
            data = json.loads(archive.read("data"))
        module = data["policy_class"]["__module__"]
    except (KeyError, TypeError, ValueError, zipfile.BadZipFile) as error:
        raise AgentFileError(f"{path}: not a model of stable-baselines3") from error
    if module.startswith("stable_baselines3.sac."):
        return "SAC"
    if module.startswith("stable_baselines3.td3."):
        return "TD3"
    return "PPO" if "n_epochs" in data else "A2C"
