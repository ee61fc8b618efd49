"""How often does the chain of babbles hold objects, of which sizes, and for how long?

For each seed an agent babbles and practises, and is tested on held-out cases of each size: held
without support as in every episode, and then still in the hand after 3 s in which the arm moves to
random postures. docs/grasping.md has the results.
"""

import argparse
import json
import time
from typing import Any

import gymnasium
import numpy as np

from gym_babble import HebbBabbling, _core, scenarios

STEPS = {"palm_side": 240, "full": 500}
CARRIED_S = 3.0

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--seeds", type=int, default=10)
parser.add_argument("--babbles", type=int, default=1_000, help="kept babbles to learn from")
parser.add_argument("--trials", type=int, default=0, help="trials to practise")
parser.add_argument("--cases", type=int, default=500, help="cases of each size")
parser.add_argument("--region", default="palm_side", choices=["palm_side", "full"])
parser.add_argument("--diameters", type=float, nargs="+", default=[2, 2.4, 3, 4, 5, 6, 7])
parser.add_argument("--config", default="paper")
parser.add_argument("--brain", type=json.loads, default={}, help="numbers that differ, as JSON")
parser.add_argument("--json", action="store_true", help="print one JSON document")
arguments = parser.parse_args()


def cases_of(centimetres: float, seed: int) -> list[dict[str, Any]]:
    """Cases with objects of one size, the same for every agent of a seed."""
    config = {"profile": arguments.config, "grasp": {"diameters_m": [centimetres / 100]}}
    drawn = scenarios(arguments.region, arguments.cases, 1_000 + seed, config=config)
    return [{name: case[name] for name in ("start", "object", "diameter")} for case in drawn]


def played(agent: HebbBabbling, cases: list[dict[str, Any]]) -> dict[str, Any]:
    """Shares of cases that the agent holds, and that it keeps for 3 s more; mean steps to hold."""
    envs = gymnasium.make_vec(
        "BabbleGrasp-v0",
        num_envs=len(cases),
        config=arguments.config,
        region=arguments.region,
        max_episode_steps=STEPS[arguments.region],
        autoreset_mode="Disabled",
    )
    observation, _ = envs.reset(seed=0, options={"scenario": cases})
    running, held, took = (np.full(len(cases), x) for x in (True, False, 0))
    plans, states = None, dict[int, bytes]()
    while running.any():
        actions, plans = agent.predict(observation, plans)
        observation, _, terminated, truncated, info = envs.step(actions)
        took += running
        ended = running & (terminated | truncated)
        held |= ended & info["held"]
        saved = envs.get_state() if ended.any() else []
        states |= {i: saved[i] for i in np.flatnonzero(ended & held)}
        running &= ~ended
        # Those that ended play another case meanwhile, which does not count.
        if ended.any() and running.any():
            observation, _ = envs.reset(options={"reset_mask": ended})
    task = envs.unwrapped.interface.task
    kept = [_core.keeps(task, state, CARRIED_S, int(i)) for i, state in states.items()]
    return {
        "cases": len(cases),
        "held": float(held.mean()),
        "kept": sum(kept) / len(cases),
        "steps": float(took[held].mean()) if held.any() else None,
    }


rows = []
for seed in range(arguments.seeds):
    env = gymnasium.make("BabbleGrasp-v0", config=arguments.config)
    agent = HebbBabbling(env, variant="chain", seed=seed, brain=arguments.brain)
    began = time.process_time()
    agent.learn(arguments.babbles).practise(arguments.trials)
    learnt = {
        "seed": seed,
        "babbled": agent.babbled,
        "control_steps": agent.control_steps,
        "processor_seconds": time.process_time() - began,
    }
    for centimetres in arguments.diameters:
        tested = played(agent, cases_of(centimetres, seed))
        rows.append({**learnt, "diameter_cm": centimetres, **tested})
        if not arguments.json:
            print(rows[-1], flush=True)
if arguments.json:
    print(json.dumps(rows))
