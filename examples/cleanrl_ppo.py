"""PPO in one file, in CleanRL's style, on the native batch: no framework but PyTorch.

You learn each line of the algorithm, and what becomes of episodes that end in a batch. An ended one
restarts at the next step (Gymnasium's default), whose action is ignored: that step is not learnt
from. The value of a truncated episode's last observation stands in for its future.
"""

import argparse

import gymnasium as gym
import numpy as np
import torch
from torch import nn
from torch.distributions import Normal

import gym_babble  # noqa: F401 - registers the environments

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--env-id", default="BabbleReach-v0")
parser.add_argument("--steps", type=int, default=300_000)
parser.add_argument("--num-envs", type=int, default=128)
parser.add_argument("--seed", type=int, default=0)
args = parser.parse_args()
rollout, epochs, minibatches, gamma, lam, clip = 64, 5, 8, 0.99, 0.95, 0.2

torch.manual_seed(args.seed)
torch.set_num_threads(1)
envs = gym.make_vec(args.env_id, num_envs=args.num_envs, obs="flat")
senses, width = envs.single_observation_space.shape[0], envs.single_action_space.shape[0]
hidden = lambda: (nn.Linear(senses, 128), nn.ReLU(), nn.Linear(128, 128), nn.ReLU())  # noqa: E731
actor = nn.Sequential(*hidden(), nn.Linear(128, width))
critic = nn.Sequential(*hidden(), nn.Linear(128, 1))
log_std = nn.Parameter(torch.full((width,), -0.5))
parameters = [*actor.parameters(), *critic.parameters(), log_std]
optimizer = torch.optim.Adam(parameters, lr=2.5e-3)
shape = (rollout, args.num_envs)
obs, actions = torch.zeros(*shape, senses), torch.zeros(*shape, width)
logprobs, rewards, live, ends, values, nexts = (torch.zeros(shape) for _ in range(6))

observation = torch.as_tensor(envs.reset(seed=args.seed)[0])
begun = torch.ones(args.num_envs)  # 0 where this step only resets.
successes = []
updates = max(1, args.steps // (rollout * args.num_envs))
for update in range(updates):
    optimizer.param_groups[0]["lr"] = 2.5e-3 * (1 - update / updates)
    for t in range(rollout):
        with torch.no_grad():
            policy = Normal(actor(observation), log_std.exp())
            obs[t], live[t], actions[t] = observation, begun, policy.sample()
            logprobs[t] = policy.log_prob(actions[t]).sum(1)
            values[t] = critic(observation).squeeze(1)
            following, reward, terminated, truncated, infos = envs.step(actions[t])
            observation = torch.as_tensor(following)
            nexts[t] = critic(observation).squeeze(1) * torch.as_tensor(~terminated)
            rewards[t] = torch.as_tensor(reward)
            done = terminated | truncated
            ends[t], begun = torch.as_tensor(done).float(), torch.as_tensor(~done).float()
            successes += infos["is_success"][done].tolist()
    advantages, following = torch.zeros(shape), torch.zeros(args.num_envs)
    for t in reversed(range(rollout)):
        delta = rewards[t] + gamma * nexts[t] - values[t]
        following = advantages[t] = delta + gamma * lam * (1 - ends[t]) * following
    learnt = live.flatten().bool()
    columns = (obs, actions, logprobs, advantages, advantages + values)
    batch = [x.flatten(0, 1)[learnt] for x in columns]
    for _ in range(epochs):
        for rows in torch.randperm(len(batch[0])).chunk(minibatches):
            o, a, old, advantage, target = (x[rows] for x in batch)
            policy = Normal(actor(o), log_std.exp())
            ratio = (policy.log_prob(a).sum(1) - old).exp()
            advantage = (advantage - advantage.mean()) / (advantage.std() + 1e-8)
            gain = torch.min(ratio * advantage, ratio.clamp(1 - clip, 1 + clip) * advantage).mean()
            loss = 0.5 * (critic(o).squeeze(1) - target).pow(2).mean() - gain
            optimizer.zero_grad()
            loss.backward()
            nn.utils.clip_grad_norm_(parameters, 0.5)
            optimizer.step()
recent = successes[-500:]
print(f"success {np.mean(recent) if recent else 0.0:.2f} in the last {len(recent)} episodes")
