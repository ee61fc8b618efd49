"""How often the solver of contacts fails to converge, in random grasps with the reflex."""

import argparse
import json

import gymnasium

import gym_babble  # noqa: F401 - registers the environments

CONTROLS = ("delta_posture", "posture")
ENVS = 64


def counts(control: str, steps: int) -> dict[str, int]:
    """Control steps, those in which the hand touches the object, and unconverged physics steps."""
    options = {"control": control, "enclosure_reflex": True, "autoreset_mode": "SameStep"}
    envs = gymnasium.make_vec("BabbleGrasp-v0", num_envs=ENVS, **options)
    envs.action_space.seed(0)
    envs.reset(seed=0)
    touching = 0
    for _ in range(steps // ENVS):
        senses = envs.step(envs.action_space.sample())[0]
        touching += int(senses["touch"].any(axis=1).sum())
    return {
        "control_steps": steps // ENVS * ENVS,
        "touching": touching,
        "unconverged": envs.unwrapped.interface.unconverged_steps,
    }


parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--steps", type=int, default=1_000_000, help="control steps in each control")
parser.add_argument("--json", action="store_true", help="print one JSON document")
args = parser.parse_args()

found = {control: counts(control, args.steps) for control in CONTROLS}
if args.json:
    print(json.dumps(found))
else:
    for control, row in found.items():
        print(f"{control}: {row['unconverged']} in {row['control_steps']:,d} control steps")
