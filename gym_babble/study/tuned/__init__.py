"""Tuned settings of stable-baselines3's algorithms, as rl-zoo3 writes them.

`ppo.yml`, `sac.yml` and `td3.yml` are files of rl-zoo3: its `train` reads them with `--conf-file`.
This module reads them without running their text as Python.
"""

from __future__ import annotations

import ast
from copy import deepcopy
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gym_babble.checks import check_choice
from gym_babble.errors import ConfigError, MissingExtraError

try:
    import yaml
except ImportError as error:
    raise MissingExtraError("PyYAML", "sb3") from error

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = ["ALGORITHMS", "FOLDER", "converted", "tuned_ids", "tuned_settings"]

FOLDER = Path(__file__).parent
"""Folder of the files."""

ALGORITHMS = ("ppo", "sac", "td3")
"""The algorithms with tuned settings; each has a file of that name."""

EXPRESSIONS = ("policy_kwargs", "replay_buffer_class", "replay_buffer_kwargs")
"""Settings that rl-zoo3 writes as Python expressions."""

SCHEDULES = ("learning_rate", "clip_range")
"""Settings that may be `lin_START`: linear from START to 0 over the training."""


def tuned_settings(algorithm: str, env_id: str) -> dict[str, Any]:
    """The settings of an algorithm in an environment, as the file has them.

    Raises:
        ConfigError: There are none.
    """
    blocks = _read(algorithm)
    if env_id not in blocks:
        raise ConfigError(
            f"env_id = {env_id!r}: {algorithm} has no tuned settings for it, but "
            f"for {', '.join(blocks)}"
        )
    return deepcopy(blocks[env_id])


def tuned_ids(algorithm: str) -> tuple[str, ...]:
    """Ids of the environments for which an algorithm has tuned settings."""
    return tuple(_read(algorithm))


@cache
def _read(algorithm: str) -> dict[str, dict[str, Any]]:
    check_choice("algorithm", algorithm, ALGORITHMS)
    text = (FOLDER / f"{algorithm}.yml").read_text(encoding="utf-8")
    return yaml.safe_load(text)  # type: ignore[no-any-return]


def converted(settings: Mapping[str, Any]) -> dict[str, Any]:
    """Settings with Python's objects in place of rl-zoo3's strings.

    Args:
        settings: As in the files. `learning_rate: lin_1e-3` becomes stable-baselines3's
            `LinearSchedule`, `dict(activation_fn=nn.ReLU)` a dict with PyTorch's class.

    Raises:
        ConfigError: A string that is not such an expression.
    """
    return {name: _converted(name, value) for name, value in settings.items()}


def _converted(name: str, value: Any) -> Any:
    if not isinstance(value, str):
        return value
    if name in SCHEDULES:
        return _schedule(name, value)
    if name not in EXPRESSIONS:
        return value
    try:
        return _value(ast.parse(value, mode="eval").body)
    except (SyntaxError, ValueError) as error:
        raise ConfigError(
            f"{name} = {value!r} is not of the form dict(net_arch=[64, 64], activation_fn=nn.ReLU):"
            f" {error}"
        ) from error


def _schedule(name: str, text: str) -> Any:
    from stable_baselines3.common.utils import LinearSchedule

    kind, _, start = text.partition("_")
    try:
        first = float(start)
    except ValueError:
        kind = ""
    if kind != "lin":
        raise ConfigError(f"{name} = {text!r} is neither a number nor of the form lin_1e-3")
    return LinearSchedule(first, 0.0, 1.0)


def _value(node: ast.expr) -> Any:
    """A literal, `dict(name=...)`, `nn.CLASS` or `HerReplayBuffer`; nothing is called."""
    match node:
        case ast.Call(func=ast.Name(id="dict"), args=[], keywords=keywords) if all(
            word.arg for word in keywords
        ):
            return {str(word.arg): _value(word.value) for word in keywords}
        case ast.Dict(keys=keys, values=values) if None not in keys:
            return {
                ast.literal_eval(key): _value(value)
                for key, value in zip(keys, values, strict=True)
                if key is not None
            }
        case ast.Attribute(value=ast.Name(id="nn"), attr=name):
            return _activation(name)
        case ast.Name(id="HerReplayBuffer"):
            from stable_baselines3 import HerReplayBuffer

            return HerReplayBuffer
    return ast.literal_eval(node)


def _activation(name: str) -> type:
    from torch import nn

    found = getattr(nn, name, None)
    if isinstance(found, type) and issubclass(found, nn.Module):
        return found
    raise ValueError(f"torch.nn has no class {name}")
