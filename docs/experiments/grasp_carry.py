"""How often does an agent carry an object to a goal and still hold it there (BabbleGraspGoal-v0)?

Counted at the end of an episode: the hand held the object without support and did not drop it, the
fingers and the thumb or the palm feel it, and its centre is within 2 cm of the goal. Pushing an
object there does not count. By default for the chain of babbles, for each seed on held-out cases of
each size; or for another agent by its name or file. docs/beyond-the-paper.md has the results.
"""

import argparse
import json
import time
from typing import Any

import gymnasium
import numpy as np

from gym_babble import HebbBabbling, scenarios
from gym_babble.agents.loading import named_agent

ENV = "BabbleGraspGoal-v0"
NEAR_M = 0.02
DROPPED_M = 0.02

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--seeds", type=int, default=5)
parser.add_argument("--babbles", type=int, default=1_000, help="kept babbles to learn from")
parser.add_argument("--cases", type=int, default=300, help="cases of each size")
parser.add_argument("--diameters", type=float, nargs="+", default=[2.4, 4, 6], help="[cm]")
parser.add_argument("--agent", help="a name or file as for `evaluate`, in place of the chain")
parser.add_argument("--json", action="store_true", help="print one JSON document")
arguments = parser.parse_args()


def cases_of(centimetres: float, seed: int) -> list[dict[str, Any]]:
    """Cases with objects of one size, the same for every agent of a seed."""
    config = {"grasp": {"diameters_m": [centimetres / 100]}}
    drawn = scenarios("palm_side", arguments.cases, 1_000 + seed, config=config, goal=True)
    parts = ("start", "object", "diameter", "goal")
    return [{name: case[name] for name in parts} for case in drawn]


def played(agent: Any, cases: list[dict[str, Any]]) -> dict[str, Any]:
    """Shares of cases at the end of an episode, and the mean distance of held objects."""
    envs = gymnasium.make_vec(ENV, num_envs=len(cases), autoreset_mode="Disabled")
    observation, _ = envs.reset(seed=0, options={"scenario": cases})
    touch = dict(envs.unwrapped.interface.spec.slices)["touch"]
    truncated, state = np.zeros(1, bool), None
    while not truncated.all():
        actions, state = agent.predict(observation, state, deterministic=True)
        observation, _, _, truncated, info = envs.step(actions)
    palm, thumb, fingers = (observation["observation"][:, touch] > 0).T
    height = info["object"][:, 2]
    held = info["held"] & fingers & (palm | thumb) & (abs(height) < DROPPED_M)
    distance = np.hypot(*(info["object"][:, :2] - [case["goal"] for case in cases]).T)
    return {
        "cases": len(cases),
        "carried": float((held & (distance <= NEAR_M)).mean()),
        "held": float(held.mean()),
        "success": float(info["is_success"].mean()),
        "distance_cm": float(100 * distance[held].mean()) if held.any() else None,
    }


def agents() -> Any:
    """Agents, each with its seed and what learning took."""
    if arguments.agent is not None:
        yield (
            named_agent(arguments.agent, env_id=ENV, options={"control": "delta_posture"}).agent,
            {"seed": 0},
        )
        return
    for seed in range(arguments.seeds):
        began = time.process_time()
        agent = HebbBabbling(ENV, variant="chain", seed=seed).learn(arguments.babbles)
        seconds = time.process_time() - began
        learnt = {"seed": seed, "control_steps": agent.control_steps, "processor_seconds": seconds}
        yield agent, learnt


rows = []
for agent, learnt in agents():
    for centimetres in arguments.diameters:
        tested = played(agent, cases_of(centimetres, learnt["seed"]))
        rows.append({**learnt, "diameter_cm": centimetres, **tested})
        if not arguments.json:
            print(rows[-1], flush=True)
if arguments.json:
    print(json.dumps(rows))
