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
parser.add_argument("--movements", type=int, default=20_000, help="legal movements before")
parser.add_argument("--repair", type=int, nargs="+", default=[250, 1_000, 4_000], help="and after")
parser.add_argument("--ppo", type=int, default=16_384, help="PPO's movements before; 0 for no PPO")
parser.add_argument("--ppo-repair", type=int, nargs="+", default=[1_024, 4_096], help="and after")
parser.add_argument("--seeds", type=int, default=3, help="seeds of learning, from 20 on")
parser.add_argument("--tests", type=int, default=1_000, help="cases, of seed 1,000")
parser.add_argument("--changes", nargs="+", help="some of the changes by name; all if not given")
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
BRAINS: dict[str, tuple[str, dict[str, Any]]] = {
    "Hebb `paper`": ("paper", {}),
    "Hebb `conjunctive`": ("conjunctive", {}),
}
TESTS = {name: scenarios("table1", arguments.tests, 1_000, config=c) for name, c in CHOSEN.items()}


def hebb(name: str, seed: int) -> Iterator[tuple[str, int, Any]]:
    """A Hebb agent in each changed body: the change, movements learnt there, and the agent."""
    variant, brain = BRAINS[name]
    agent = HebbBabbling(PATTERN, variant, seed=seed, brain=brain).learn(arguments.movements)
    for change, config in CHOSEN.items():
        moved = agent.continue_in(gym.make(PATTERN, config=config))
        yield change, 0, moved
        for movements in sorted(arguments.repair):
            moved.learn(movements - (moved.learnt - agent.learnt))
            yield change, movements, moved


def ppo(seed: int) -> Iterator[tuple[str, int, Any]]:
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


def tested(change: str, agent: Any) -> float:
    """Success in a changed body."""
    return evaluate(agent, PATTERN, TESTS[change], config=CHOSEN[change]).rate("success")


found: dict[tuple[str, str, int], list[float]] = {}
for seed in range(20, 20 + arguments.seeds):
    agents = [(name, hebb(name, seed)) for name in BRAINS]
    if arguments.ppo:
        agents.append(("PPO", ppo(seed)))
    for name, states in agents:
        for change, movements, agent in states:
            found.setdefault((name, change, movements), []).append(tested(change, agent))
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
        named = f"| {row['agent']} | {row['change']} | {row['movements']:,} |"
        print(f"{named} {row['success']:.3f} | {each} |")
