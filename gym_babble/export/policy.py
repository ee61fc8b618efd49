"""The network of a model of stable-baselines3, as a file that needs no PyTorch."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np
from gymnasium import spaces

from gym_babble import _core
from gym_babble.agents.models import NormalizedModel, is_model
from gym_babble.agents.network import PolicyNetwork
from gym_babble.checks import check_whole
from gym_babble.errors import ConfigError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gym_babble.agents.acting import EnvArguments
    from gym_babble.agents.loading import LoadedAgent
    from gym_babble.envs.interface import Interface

__all__ = ["export_policy"]

VERSION = 1


def export_policy(loaded: LoadedAgent, *, bits: int | None = None) -> PolicyNetwork:
    """The network by which a model of stable-baselines3 acts: PPO's, A2C's, SAC's or TD3's.

    The network takes the flat observation and gives the action that `predict(deterministic=True)`
    gives. Its hidden layers all have ReLU or all have tanh.

    Args:
        loaded: The model and where it acts, as `named_agent` returns them.
        bits: Significant bits that each weight keeps, 2 to 24; 24 are all. With fewer the file
            packs to fewer bytes.

    Raises:
        ConfigError: It is no such model, it sees more than the senses, it learnt behind
            `VecNormalize`, or its network has other parts.
    """
    keep = 24 if bits is None else check_whole("bits", bits, 2, 24, "bits")
    model, arguments = loaded.agent, loaded.arguments
    if isinstance(model, NormalizedModel):
        raise ConfigError("it acts on observations that VecNormalize has normalized: not exported")
    if not is_model(model):
        raise ConfigError("only models of stable-baselines3 have such a network")
    interface = arguments.interface()
    linear, activation, output = _layers(model)
    columns = _columns(model, interface)
    width = interface.spec.slices[-1][1].stop
    arrays: list[tuple[str, NDArray[np.float32]]] = []
    for i, layer in enumerate(linear):
        weight, bias = (part.detach().cpu().numpy() for part in (layer.weight, layer.bias))
        if i == 0:
            whole = np.zeros((len(weight), width), np.float32)
            whole[:, columns] = weight
            weight = whole
        arrays += [(f"{i}.weight", _rounded(weight, keep)), (f"{i}.bias", _rounded(bias, keep))]
    about = _about(model, arguments, interface) | {"activation": activation, "output": output}
    return PolicyNetwork(_core.write_tensors(PolicyNetwork.KEY, json.dumps(about), arrays))


def _about(model: Any, arguments: EnvArguments, interface: Interface) -> dict[str, Any]:
    return {
        "version": VERSION,
        "algorithm": type(model).__name__,
        "task": arguments.task,
        "options": arguments.options,
        "config": arguments.config,
        "senses": [[name, part.stop - part.start] for name, part in interface.spec.slices],
    }


def _layers(model: Any) -> tuple[list[Any], str, str]:
    """The linear layers, what hidden neurons do, and what becomes of the outputs."""
    from torch import nn

    policy = model.policy
    if hasattr(policy, "action_net"):
        parts, output = [*policy.mlp_extractor.policy_net, policy.action_net], "clip"
        if policy.squash_output:
            raise ConfigError("its policy has squash_output, with gSDE: not exported")
    elif hasattr(policy.actor, "latent_pi"):
        parts, output = [*policy.actor.latent_pi, policy.actor.mu], "tanh"
    else:
        *parts, last = policy.actor.mu
        if not isinstance(last, nn.Tanh):
            raise ConfigError(f"its actor ends with {type(last).__name__}, expected Tanh")
        output = "tanh"
    linear, between = parts[::2], {type(part) for part in parts[1::2]}
    names = {nn.ReLU: "relu", nn.Tanh: "tanh"}
    if not all(isinstance(part, nn.Linear) for part in linear) or not between <= {*names}:
        shown = ", ".join(type(part).__name__ for part in parts)
        raise ConfigError(
            f"its network is {shown}; expected Linear layers with ReLU or Tanh between"
        )
    if len(between) > 1:
        raise ConfigError("its network has ReLU and Tanh; expected one of them")
    return linear, names[between.pop()] if between else "relu", output


def _columns(model: Any, interface: Interface) -> NDArray[np.intp]:
    """Where the numbers that the network gets stand in the flat observation."""
    from stable_baselines3.common.torch_layers import CombinedExtractor, FlattenExtractor

    slices = dict(interface.spec.slices)
    space = model.observation_space
    actor = getattr(model.policy, "actor", None)
    extractor = model.policy.features_extractor if actor is None else actor.features_extractor
    if isinstance(space, spaces.Dict) and not space.keys() <= slices.keys():
        other = ", ".join(sorted(space.keys() - slices.keys()))
        raise ConfigError(f"it sees {other} beside the senses: not exported")
    chosen = getattr(extractor, "senses", None)  # Of `gym_babble.sb3.ChosenSenses`.
    if isinstance(chosen, tuple):
        names = [*chosen]
    elif type(extractor) is CombinedExtractor:
        names = [*space]
    elif type(extractor) is FlattenExtractor and isinstance(space, spaces.Box):
        names = [*slices]
    else:
        raise ConfigError(f"its features come from {type(extractor).__name__}: not exported")
    return np.concatenate([np.arange(slices[name].start, slices[name].stop) for name in names])


def _rounded(values: NDArray[np.float32], bits: int) -> NDArray[np.float32]:
    """Values with so many significant bits."""
    mantissa, exponent = np.frexp(values)
    rounded: NDArray[np.float32] = np.ldexp(np.round(np.ldexp(mantissa, bits)), exponent - bits)
    return rounded
