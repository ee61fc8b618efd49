"""The search behind the tuned settings: at most 20 trials and 2 CPU hours an algorithm and task.

A trial draws settings at random, trains with seeds from 100 on, and is scored by its success on
validation cases. Both are apart from the seeds (from 0) and the cases (split "test", from case seed
1,000) of what is reported. The first trial has the settings of before. A file keeps the trials; the
same command goes on from it until a cap is reached.

python docs/experiments/tune.py sac BabbleReachPattern-v0 --steps 3000
"""

import argparse
import json
from pathlib import Path
from statistics import mean
from time import process_time
from typing import Any

import numpy as np

from gym_babble import evaluate, scenarios
from gym_babble.files import check_folder, write_file
from gym_babble.study.tasks import task_of
from gym_babble.study.trainers.sb3 import train_tuned
from gym_babble.study.tuned import ALGORITHMS, tuned_settings
from gym_babble.study.versions import machine, versions

MOST_TRIALS = 20
MOST_SECONDS = 2 * 3_600
"""Processor time of all trials together [s]."""

FIRST_SEED = 100


def networks(*sizes: int, **others: str) -> list[str]:
    """Choices of networks of two layers, as rl-zoo3 writes them."""
    rest = "".join(f", {name}={value}" for name, value in others.items())
    return [f"dict(net_arch=[{size}, {size}]{rest})" for size in sizes]


OFF_POLICY = {
    "n_envs": [4, 8, 16],
    "gradient_steps": [4, 8, 16],
    "learning_rate": [3e-4, 1e-3, 2e-3],
    "batch_size": [128, 256, 512],
    "tau": [0.005, 0.02],
    "policy_kwargs": networks(64, 128, 256),
}
PPO = {
    "n_steps": [8, 16, 32, 64],
    "batch_size": [128, 256, 512, 1_024],
    "n_epochs": [5, 10, 20],
    "learning_rate": [3e-4, 1e-3, "lin_1e-3", "lin_2.5e-3"],
    "policy_kwargs": [
        text
        for std in ("-0.5", "-1.0", "-1.5")
        for text in networks(64, 128, 256, activation_fn="nn.ReLU", log_std_init=std)
    ],
}
SPACES = {"ppo": PPO, "sac": OFF_POLICY, "td3": {**OFF_POLICY, "noise_std": [0.1, 0.2, 0.4]}}
"""Choices for each setting. The others stay as they are."""

OF_THE_FILE = ("n_timesteps", "env_kwargs")
"""What `train_tuned` takes from the file."""

DISCOUNTS = {"gamma": [0.95, 0.98, 0.99]}
"""Where an episode has more than one step."""


def drawn(algorithm: str, env_id: str, trial: int) -> dict[str, Any]:
    """The settings of a trial; those of before in the first one."""
    settings = tuned_settings(algorithm, env_id)
    space = SPACES[algorithm] | ({} if settings["gamma"] == 0.0 else DISCOUNTS)
    if trial > 0:
        random = np.random.default_rng([FIRST_SEED, trial])
        settings |= {
            name: choices[random.integers(len(choices))] for name, choices in space.items()
        }
    return settings


def one_trial(algorithm: str, env_id: str, settings: dict[str, Any], plan: dict[str, Any]) -> Any:
    """Trains with each seed, and tests on validation cases."""
    began = process_time()
    cases = scenarios(task_of(env_id).protocol, plan["cases"], split="validation")
    scores = []
    for seed in plan["seeds"]:
        given = {name: value for name, value in settings.items() if name not in OF_THE_FILE}
        model = train_tuned(algorithm, env_id, seed=seed, steps=plan["steps"], settings=given)
        scores.append(evaluate(model, cases=cases, threads=1).rate("success"))
    return {
        "settings": settings | {"n_timesteps": plan["steps"]},
        "success": scores,
        "cpu_seconds": round(process_time() - began, 1),
    }


def arguments_of() -> argparse.Namespace:
    """The arguments."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("algorithm", choices=ALGORITHMS)
    parser.add_argument("env_id")
    parser.add_argument("--steps", type=int, required=True, help="of all environments together")
    parser.add_argument("--seeds", type=int, default=2, help="trainings of each trial")
    parser.add_argument("--cases", type=int, default=300, help="validation cases")
    parser.add_argument("--trials", type=int, default=MOST_TRIALS, help=f"at most {MOST_TRIALS}")
    parser.add_argument("--out", type=Path, default=Path("docs/studies/tuning"), help="a folder")
    return parser.parse_args()


def main() -> None:
    """Runs the trials that the file does not have."""
    arguments = arguments_of()
    algorithm, env_id = arguments.algorithm, arguments.env_id
    file = arguments.out / f"{algorithm}_{env_id}.json"
    check_folder(arguments.out, "--out", [file.name])
    arguments.out.mkdir(exist_ok=True)
    seeds = list(range(FIRST_SEED, FIRST_SEED + arguments.seeds))
    plan = {"steps": arguments.steps, "seeds": seeds, "cases": arguments.cases}
    record: dict[str, Any] = {"algorithm": algorithm, "env_id": env_id, "plan": plan, "trials": []}
    if file.exists():
        record = json.loads(file.read_text(encoding="utf-8"))
        if record["plan"] != plan:
            raise SystemExit(f"{file} has trials of another plan: {record['plan']}")
    trials = record["trials"]
    while len(trials) < min(arguments.trials, MOST_TRIALS):
        if sum(trial["cpu_seconds"] for trial in trials) > MOST_SECONDS:
            break
        settings = drawn(algorithm, env_id, len(trials))
        trials.append(one_trial(algorithm, env_id, settings, plan))
        record |= {"versions": versions(), "machine": machine()}
        write_file(file, json.dumps(record, indent=1) + "\n")
        print(len(trials), trials[-1], flush=True)
    best = max(trials, key=lambda trial: mean(trial["success"]))
    print(f"best of {len(trials)}: {mean(best['success']):.3f} with {best['settings']}")


if __name__ == "__main__":
    main()
