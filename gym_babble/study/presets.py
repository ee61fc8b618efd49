"""Presets of PPO: environment, senses, networks and settings.

docs/baselines.md says how the settings were chosen and what they reach.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from gymnasium import spaces

from gym_babble.errors import MissingExtraError

try:
    import torch
    from stable_baselines3.common.torch_layers import BaseFeaturesExtractor
    from stable_baselines3.common.utils import LinearSchedule
except ImportError as error:
    raise MissingExtraError("stable-baselines3", "sb3") from error

__all__ = ["PRESETS", "ChosenSenses", "Preset"]


class ChosenSenses(BaseFeaturesExtractor):
    """Passes only the chosen senses to the networks."""

    def __init__(self, observation_space: spaces.Dict, senses: tuple[str, ...]) -> None:
        width = sum(spaces.flatdim(observation_space[name]) for name in senses)
        super().__init__(observation_space, width)
        self._senses = senses

    def forward(self, observations: dict[str, torch.Tensor]) -> torch.Tensor:
        """The chosen senses of a batch of observations, concatenated (n, width)."""
        return torch.cat([observations[name] for name in self._senses], dim=1)


@dataclass(frozen=True, kw_only=True)
class Preset:
    """Environment, senses, length and settings of a training."""

    env_id: str
    """Id of the environment."""
    env_kwargs: dict[str, Any] = field(default_factory=dict)
    """Further arguments of the environment; the config is not among them."""
    senses: tuple[str, ...]
    """Senses that the networks get."""
    num_envs: int
    """Environments stepped together."""
    steps: int
    """Steps of all environments together; in `pattern` control these are movements."""
    settings: dict[str, Any] = field(default_factory=dict)
    """Arguments of stable-baselines3's PPO."""
    policy: dict[str, Any] = field(default_factory=dict)
    """The `policy_kwargs` of stable-baselines3's PPO."""

    def to_json(self) -> dict[str, Any]:
        """The preset as JSON types; a linear schedule becomes [first, last]."""
        return {name: _plain(value) for name, value in vars(self).items()}


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: _plain(part) for name, part in value.items()}
    if isinstance(value, LinearSchedule):
        return [value.start, value.end]
    return value.__name__ if isinstance(value, type) else value


ALL_SENSES = ("eye", "obstacle", "hand", "arm", "stretch", "time")
"""The senses of reaching."""


def _pattern(*senses: str) -> Preset:
    return Preset(
        env_id="BabbleReachPattern-v0",
        senses=senses,
        num_envs=64,
        steps=16_384,
        settings={
            "n_steps": 8,
            "batch_size": 128,
            "n_epochs": 20,
            "learning_rate": 1e-3,
            "gamma": 0.0,
            "gae_lambda": 1.0,
        },
        # With a log-std of 0 most actions are clipped, and the policy does not recover.
        policy={"activation_fn": torch.nn.ReLU, "net_arch": [128, 128], "log_std_init": -1.5},
    )


PRESETS: dict[str, Preset] = {
    "pattern": _pattern(*ALL_SENSES),
    "pattern_obstacle": _pattern("obstacle"),
    "pattern_eye_obstacle": _pattern("eye", "obstacle"),
    "delta_posture": Preset(
        env_id="BabbleReach-v0",
        senses=ALL_SENSES,
        num_envs=128,
        steps=1_000_000,
        settings={
            "n_steps": 64,
            "batch_size": 1024,
            "n_epochs": 5,
            "learning_rate": LinearSchedule(2.5e-3, 0.0, 1.0),
            "gamma": 0.99,
            "gae_lambda": 0.95,
        },
        policy={"activation_fn": torch.nn.ReLU, "net_arch": [128, 128], "log_std_init": -0.5},
    ),
    "grasp": Preset(
        env_id="BabbleGrasp-v0",
        senses=("eye", "fovea", "arm", "hand", "stretch", "touch", "time"),
        num_envs=128,
        steps=2_500_000,
        settings={
            "n_steps": 64,
            "batch_size": 1024,
            "n_epochs": 5,
            "learning_rate": LinearSchedule(1e-3, 0.0, 1.0),
            "gamma": 0.99,
            "gae_lambda": 0.95,
        },
        policy={"activation_fn": torch.nn.ReLU, "net_arch": [128, 128], "log_std_init": -0.5},
    ),
}
"""The presets by name. `pattern_obstacle` sees what the paper's agent sees, `pattern_eye_obstacle`
what the conjunctive variant sees, and the others see all senses. `grasp` is grasping in
`delta_posture` control."""
