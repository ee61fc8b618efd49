"""How often does the chain of babbles hold objects, of which sizes, and for how long?

Each seed's agent is tested on held-out cases after some of its babbles, and after it practised:
held without support as in every episode, and then still in the hand after 3 s in which the arm
moves to random postures. docs/grasping.md has the results.
"""

import argparse
import json
import time
from typing import Any

import gymnasium
import numpy as np

from gym_babble import HebbBabbling, _core, scenarios

ENVS = {"palm_side": "BabbleGrasp-v0", "full": "BabbleGraspFull-v0"}
CARRIED_S = 3.0

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--seeds", type=int, nargs="+", default=list(range(10)))
parser.add_argument("--babbles", type=int, nargs="+", default=[100, 1_000], help="kept babbles")
parser.add_argument("--trials", type=int, default=4_000, help="trials to practise then")
parser.add_argument("--cases", type=int, default=500, help="cases of each size")
parser.add_argument("--diameters", type=float, nargs="+", default=[2.4, 4, 6], help="in cm")
parser.add_argument("--more", type=float, nargs="+", default=[2, 3, 5, 7], help="after all babbles")
parser.add_argument("--config", default="paper")
parser.add_argument("--brain", type=json.loads, default={}, help="numbers that differ, as JSON")
parser.add_argument("--json", action="store_true", help="print one JSON document")
arguments = parser.parse_args()


def cases_of(region: str, centimetres: float, seed: int) -> list[dict[str, Any]]:
    """Cases with objects of one size, the same for every agent of a seed."""
    config = {"profile": arguments.config, "grasp": {"diameters_m": [centimetres / 100]}}
    drawn = scenarios(region, arguments.cases, 1_000 + seed, config=config)
    return [{name: case[name] for name in ("start", "object", "diameter")} for case in drawn]


def played(agent: HebbBabbling, region: str, cases: list[dict[str, Any]]) -> dict[str, Any]:
    """Shares of cases that the agent holds, and that it keeps for 3 s more; mean steps to hold."""
    envs = gymnasium.make_vec(
        ENVS[region], num_envs=len(cases), config=arguments.config, autoreset_mode="Disabled"
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
        saved = envs.get_state() if (ended & held).any() else []
        states |= {i: saved[i] for i in np.flatnonzero(ended & held)}
        running &= ~ended
        # Those that ended play another case meanwhile, which does not count.
        again = terminated | truncated
        if again.any() and running.any():
            observation, _ = envs.reset(options={"reset_mask": again})
    task = envs.unwrapped.interface.task
    kept = [_core.keeps(task, state, CARRIED_S, int(i)) for i, state in states.items()]
    return {
        "cases": len(cases),
        "held": float(held.mean()),
        "kept": sum(kept) / len(cases),
        "steps": float(took[held].mean()) if held.any() else None,
    }


rows = []


def test(agent: HebbBabbling, seconds: float, region: str, diameters: list[float]) -> None:
    """Adds a row for each size, with what the agent has learnt from."""
    learnt = {
        "seed": agent.seed,
        "config": arguments.config,
        "learnt": agent.learnt,
        "babbled": agent.babbled,
        "practised": agent.practised,
        "control_steps": agent.control_steps,
        "processor_seconds": round(seconds, 2),
        "region": region,
    }
    for centimetres in diameters:
        tested = played(agent, region, cases_of(region, centimetres, agent.seed))
        rows.append({**learnt, "diameter_cm": centimetres, **tested})
        if not arguments.json:
            print(rows[-1], flush=True)


for seed in arguments.seeds:
    env = gymnasium.make("BabbleGrasp-v0", config=arguments.config)
    agent = HebbBabbling(env, variant="chain", seed=seed, brain=arguments.brain)
    seconds = 0.0
    for babbles in arguments.babbles:
        began = time.process_time()
        agent.learn(babbles - agent.learnt)
        seconds += time.process_time() - began
        test(agent, seconds, "palm_side", arguments.diameters)
    test(agent, seconds, "palm_side", arguments.more)
    if arguments.trials:
        began = time.process_time()
        agent.practise(arguments.trials)
        seconds += time.process_time() - began
        for region in ENVS:
            test(agent, seconds, region, arguments.diameters)
if arguments.json:
    print(json.dumps(rows))
