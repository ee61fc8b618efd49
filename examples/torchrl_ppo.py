"""PPO with TorchRL's parts: collector, generalised advantages, clipped loss.

You learn to wrap the native batch for TorchRL, which resets ended environments itself and so needs
the autoreset mode `Disabled`. TorchRL is not in this package's extras: `pip install torchrl`.
"""

import argparse

import gymnasium as gym
import torch
from tensordict.nn import TensorDictModule
from tensordict.nn.distributions import NormalParamExtractor
from torch import nn
from torchrl.collectors import Collector
from torchrl.envs import GymWrapper
from torchrl.modules import ProbabilisticActor, TanhNormal, ValueOperator
from torchrl.objectives import ClipPPOLoss
from torchrl.objectives.value import GAE

import gym_babble  # noqa: F401 - registers the environments

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--env-id", default="BabbleReach-v0")
parser.add_argument("--steps", type=int, default=300_000)
parser.add_argument("--num-envs", type=int, default=128)
parser.add_argument("--seed", type=int, default=0)
arguments = parser.parse_args()

torch.manual_seed(arguments.seed)
torch.set_num_threads(1)
batch = gym.make_vec(
    arguments.env_id, num_envs=arguments.num_envs, obs="flat", autoreset_mode="Disabled"
)
senses, width = batch.single_observation_space.shape[0], batch.single_action_space.shape[0]
envs = GymWrapper(batch)
envs.set_seed(arguments.seed)


def network(outputs: int) -> nn.Sequential:
    """Two hidden layers."""
    layers = (nn.Linear(senses, 128), nn.ReLU(), nn.Linear(128, 128), nn.ReLU())
    return nn.Sequential(*layers, nn.Linear(128, outputs))


mean_and_scale = nn.Sequential(network(2 * width), NormalParamExtractor())
actor = ProbabilisticActor(
    TensorDictModule(mean_and_scale, in_keys=["observation"], out_keys=["loc", "scale"]),
    in_keys=["loc", "scale"],
    distribution_class=TanhNormal,
    return_log_prob=True,
)
critic = ValueOperator(network(1), in_keys=["observation"])
advantages = GAE(gamma=0.99, lmbda=0.95, value_network=critic)
loss = ClipPPOLoss(actor, critic, clip_epsilon=0.2, entropy_coeff=0.0)
optimizer = torch.optim.Adam(loss.parameters(), lr=1e-3)
rollout = 64 * arguments.num_envs
collector = Collector(
    envs,
    actor,
    frames_per_batch=rollout,
    total_frames=max(1, arguments.steps // rollout) * rollout,
    auto_register_policy_transforms=False,  # A policy without memory needs none.
)
for data in collector:
    episodes = int(data["next", "done"].sum())
    reward = data["next", "reward"].sum().item() / max(1, episodes)
    with torch.no_grad():
        advantages(data)
    rows = data.reshape(-1)
    for _ in range(5):
        for part in torch.randperm(len(rows)).chunk(8):
            losses = loss(rows[part])
            optimizer.zero_grad()
            sum(value for name, value in losses.items() if name.startswith("loss_")).backward()
            nn.utils.clip_grad_norm_(loss.parameters(), 0.5)
            optimizer.step()
    print(f"{episodes} episodes ended, return {reward:.2f} an episode", flush=True)
collector.shutdown()
