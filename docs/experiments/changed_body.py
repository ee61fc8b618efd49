"""How far agents fall when the body or its noise changes, and how much learning repairs it.

Every agent learns in body `paper`. Then the body changes: each agent is tested in the changed body
as it is, and after learning on there. docs/model.md has the results.
"""

import argparse
import json
from collections.abc import Iterator
from io import BytesIO
from typing import Any

import gymnasium as gym
from stable_baselines3 import PPO

from gym_babble import HebbBabbling, evaluate, scenarios
from gym_babble.sb3 import BabbleVecEnv
from gym_babble.study.trainers.sb3 import train_tuned

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--agents", nargs="+", help="some of the agents by name; all if not given")
parser.add_argument("--changes", nargs="+", help="some of the changes by name; all if not given")
parser.add_argument("--movements", type=int, default=20_000, help="legal movements before")
parser.add_argument("--repair", type=int, nargs="+", default=[250, 1_000, 4_000], help="and after")
parser.add_argument("--ppo", type=int, default=16_384, help="PPO's movements before")
parser.add_argument("--ppo-repair", type=int, nargs="+", default=[1_024, 4_096, 16_384])
parser.add_argument("--seeds", type=int, default=3, help="seeds of learning, from 20 on")
parser.add_argument("--tests", type=int, default=1_000, help="cases of each seed, from 1,000 on")
parser.add_argument("--json", action="store_true", help="print one JSON document")
arguments = parser.parse_args()

PATTERN = "BabbleReachPattern-v0"
CHANGES: dict[str, dict[str, Any]] = {
    "none": {},
    "elbow to 100°": {"body": {"joints": {"elbow": {"upper_deg": 100.0}}}},
    "elbow to 85°": {"body": {"joints": {"elbow": {"upper_deg": 85.0}}}},
    "forearm + 3 cm": {"body": {"arm": {"forearm_m": 0.16}}},
    "half the stiffness": {"body": {"muscles": {"kp": 25.0}}},
    "a fifth of the stiffness": {"body": {"muscles": {"kp": 10.0}}},
    "eye 4 cm to the right": {"body": {"eye": {"position_m": [0.04, 0.1, 0.25]}}},
    "noise of senses": {"noise": {"eye_deg": 2.0, "sight_deg": 2.0}},
    "noise of muscles": {"noise": {"motor_deg": 10.0}},
}
CHOSEN = {name: CHANGES[name] for name in arguments.changes or CHANGES}
VARIANTS = {"Hebb `paper`": "paper", "Hebb `conjunctive`": "conjunctive"}
States = Iterator[tuple[str, int | None, Any]]
"""The change, movements learnt in the changed body, and the agent; None for one that learnt there
alone, as many movements as the others before the change."""


def hebb(variant: str, seed: int) -> States:
    """A Hebb agent in each changed body; its legal movements count."""
    agent = HebbBabbling(PATTERN, variant, seed=seed).learn(arguments.movements)
    for change, config in CHOSEN.items():
        env = gym.make(PATTERN, config=config)
        moved = agent.continue_in(env)
        yield change, 0, moved
        for movements in sorted(arguments.repair):
            yield change, movements, moved.learn(movements - (moved.learnt - agent.learnt))
        yield change, None, HebbBabbling(env, variant, seed=seed).learn(arguments.movements)


def ppo(seed: int) -> States:
    """PPO in the same way; all its movements count, legal or not."""
    model, stored = train_tuned("ppo", PATTERN, seed=seed, steps=arguments.ppo), BytesIO()
    model.save(stored)
    for change, config in CHOSEN.items():
        stored.seek(0)
        env = BabbleVecEnv(PATTERN, model.n_envs, config=config, threads=1)
        # Bounds of senses follow from the joint ranges.
        bounds = {"observation_space": env.observation_space}
        moved = PPO.load(stored, env=env, device="cpu", custom_objects=bounds)
        yield change, 0, moved
        done = 0
        for movements in sorted(arguments.ppo_repair):
            moved.learn(movements - done, reset_num_timesteps=False)
            done = movements
            yield change, movements, moved
        env.close()
        there = train_tuned("ppo", PATTERN, seed=seed, steps=arguments.ppo, config=config)
        yield change, None, there


def success(change: str, agent: Any, seed: int) -> float:
    """Success in a changed body, on cases of a seed."""
    cases = scenarios("table1", arguments.tests, seed, config=CHOSEN[change])
    return evaluate(agent, PATTERN, cases, config=CHOSEN[change]).rate("success")


found: dict[tuple[str, str, int | None], list[float]] = {}
for name in arguments.agents or (*VARIANTS, "PPO"):
    for k in range(arguments.seeds):
        states = ppo(20 + k) if name == "PPO" else hebb(VARIANTS[name], 20 + k)
        for change, movements, agent in states:
            rate = success(change, agent, 1_000 + k)
            found.setdefault((name, change, movements), []).append(rate)
rows = [
    {
        "agent": name,
        "change": change,
        "movements": movements,
        "success": sum(rates) / len(rates),
        "by_seed": rates,
    }
    for (name, change, movements), rates in found.items()
]
if arguments.json:
    print(json.dumps(rows))
else:
    for row in rows:
        each = ", ".join(f"{rate:.3f}" for rate in row["by_seed"])
        after = "there alone" if row["movements"] is None else f"{row['movements']:,}"
        print(f"| {row['agent']} | {row['change']} | {after} | {row['success']:.3f} | {each} |")
