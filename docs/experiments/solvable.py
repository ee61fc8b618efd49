"""What agents that know the simulation solve of the default cases of each id and control.

Each environment samples its own cases, as in training. The agents plan postures: in `torque`
control muscles turn their postures into torques (Eq. 2), once a control step.
"""

from __future__ import annotations

import argparse
import json
from typing import Any

import gymnasium
import numpy as np

from gym_babble import Config, Oracle, Scripted, evaluate
from gym_babble.checks import processors
from gym_babble.envs.registry import ENVIRONMENTS

CONTROLS = {
    "reach": ("delta_posture", "posture", "torque", "pattern"),
    "grasp": ("delta_posture", "posture", "torque"),
}
IDS = ("BabbleReachGoal-v0", "BabbleGrasp-v0")
"""The others have the same cases, but for `BabbleGraspFull-v0` and `BabbleGraspGoal-v0`."""


class Muscles:
    """An agent that plans postures, acting in `torque` control: T = K_P (q_des − q)."""

    def __init__(self, agent: Any, task: str) -> None:
        body = Config().body
        grip = [body.grip.arm_muscles] * 2 + [body.grip.hand_muscles] * 2
        muscles = {"reach": [body.muscles] * 2, "grasp": grip}[task]
        self.agent = agent
        self.joints = ("arm", "hand")[: len(muscles) // 2]
        self.gain = np.array([muscle.kp / muscle.torque_max for muscle in muscles])
        quantities = agent.interface.quantities
        self.widths = np.array(
            quantities["joint_range"] if task == "reach" else np.diff(quantities["ranges"])[:, 0]
        )

    def predict(self, observation: Any, *call: Any) -> tuple[Any, Any]:
        """Torques over their maxima, for a batch."""
        postures, state = self.agent.predict(observation, *call)
        angles = np.concatenate([self.sense(observation, name) for name in self.joints], axis=-1)
        lag = (0.5 + 0.5 * postures - angles) * self.widths
        return np.clip(self.gain * lag, -1, 1).astype(np.float32), state

    def sense(self, observation: Any, name: str) -> Any:
        """A sense of a batch; in the goal forms it is part of `observation`."""
        if name in observation:
            return observation[name]
        return observation["observation"][:, dict(self.agent.interface.spec.slices)[name]]


def solved(kind: Any, row: Any, control: str, n: int) -> int:
    """How many of an environment's first n cases, from seed 0, an agent solves."""
    envs = gymnasium.make_vec(row.id, num_envs=n, control=control)
    envs.reset(seed=0)
    cases = list(envs.get_attr("scenario"))
    planned = "posture" if control == "torque" else control
    agent = kind(gymnasium.make(row.id, control=planned))
    if control == "torque":
        agent = Muscles(agent, row.task)
    threads = processors()
    return evaluate(agent, row.id, cases, control=control, threads=threads).count("ever_success")


parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--cases", type=int, default=1_000)
parser.add_argument("--ids", nargs="+", default=IDS)
parser.add_argument("--json", action="store_true", help="print one JSON document")
args = parser.parse_args()

rows = []
if not args.json:
    print("| id | control | `Scripted` | `Oracle` |\n| --- | --- | --- | --- |")
for row in (row for row in ENVIRONMENTS if row.id in args.ids):
    for control in CONTROLS[row.task]:
        counts = [solved(kind, row, control, args.cases) for kind in (Scripted, Oracle)]
        named = dict(zip(("scripted", "oracle"), counts, strict=True))
        rows.append({"id": row.id, "control": control, "cases": args.cases, **named})
        if not args.json:
            rates = " | ".join(f"{count / args.cases:.3f}" for count in counts)
            print(f"| `{row.id}` | {control} | {rates} |", flush=True)
if args.json:
    print(json.dumps(rows))
