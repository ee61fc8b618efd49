"""The study behind docs/baselines.md: each PPO preset, several seeds, tested on Table I.

Writes the runs as JSON, one a line, and their learning curves as a picture, and prints a table.
Seconds are clock time of learning; processor seconds include validation.

python examples/ppo_study.py --out docs/studies              # the presets' own steps
python examples/ppo_study.py --out docs/studies --long 3     # and 4 or 3 times as many
"""

import argparse
import json
from collections import defaultdict
from pathlib import Path
from statistics import mean
from time import process_time
from typing import Any

import matplotlib as mpl

from gym_babble import evaluate, scenarios
from gym_babble.evaluation import wilson
from gym_babble.ppo import PRESETS, train_ppo

mpl.use("agg")
import matplotlib.pyplot as plt

LONG = {"pattern": 65_536, "pattern_obstacle": 65_536, "pattern_eye_obstacle": 65_536}
LONG["delta_posture"] = 3_000_000
OUTCOMES = ("success", "collision", "joint_limit", "timeout")
COLUMNS = ("preset", "steps", "seeds", "success", "95 %", "range of seeds", "collision")
COLUMNS += ("joint limit", "timeout", "movements", "control steps", "seconds")
COLUMNS += ("processor seconds",)

Run = dict[str, Any]


def one_run(preset: str, steps: int, seed: int, cases: int) -> Run:
    """Trains with a seed and tests, on the same cases for each seed."""
    began = process_time()
    trained = train_ppo(preset, seed=seed, steps=steps, validations=20)
    processor = process_time() - began
    test = scenarios("table1", cases)
    result = evaluate(trained.agent, trained.env_id, test, **trained.env_kwargs)
    return {
        "preset": preset,
        "steps": steps,
        "seed": seed,
        "cases": len(test),
        **{outcome: result.count(outcome) for outcome in OUTCOMES},
        "movements": trained.movements,
        "control_steps": trained.control_steps,
        "seconds": round(trained.seconds, 1),
        "processor_seconds": round(processor, 1),
        "curve": [(p.steps, round(p.seconds, 1), round(p.success, 3)) for p in trained.curve],
    }


def groups(runs: list[Run]) -> dict[tuple[str, int], list[Run]]:
    """The runs of each preset and length."""
    found = defaultdict(list)
    for run in runs:
        found[run["preset"], run["steps"]].append(run)
    return found


def table(runs: list[Run]) -> str:
    """A row for each preset and length, all seeds together."""
    lines = [
        f"| {' | '.join(COLUMNS)} |",
        "| --- " * len(COLUMNS) + "|",
    ]
    for (preset, steps), group in groups(runs).items():
        cases = sum(run["cases"] for run in group)
        rates = {name: sum(run[name] for run in group) / cases for name in OUTCOMES}
        low, high = wilson(sum(run["success"] for run in group), cases)
        each = [run["success"] / run["cases"] for run in group]
        lines.append(
            f"| {preset} | {steps:,} | {len(group)} | {rates['success']:.3f} "
            f"| {low:.3f}–{high:.3f} | {min(each):.3f}–{max(each):.3f} "
            f"| {rates['collision']:.3f} | {rates['joint_limit']:.3f} | {rates['timeout']:.3f} "
            f"| {mean(run['movements'] for run in group):,.0f} "
            f"| {mean(run['control_steps'] for run in group):,.0f} "
            f"| {mean(run['seconds'] for run in group):.0f} "
            f"| {mean(run['processor_seconds'] for run in group):.0f} |"
        )
    return "\n".join(lines)


def picture(runs: list[Run], path: Path) -> None:
    """Success on validation cases while learning: mean of the seeds, and their range shaded."""
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.6), sharey=True, layout="constrained")
    for (preset, steps), group in groups(runs).items():
        if steps != max(run["steps"] for run in runs if run["preset"] == preset):
            continue
        axis = axes[int(preset == "delta_posture")]
        points = list(zip(*(run["curve"] for run in group), strict=True))
        x = [at[0][0] for at in points]
        rates = [[point[2] for point in at] for at in points]
        axis.plot(x, [mean(rate) for rate in rates], label=preset)
        axis.fill_between(x, list(map(min, rates)), list(map(max, rates)), alpha=0.2)
    axes[0].set(xlabel="movements", ylabel="success on validation cases", ylim=(0, 1))
    axes[1].set(xlabel="control steps")
    for axis in axes:
        axis.grid(alpha=0.3)
        if axis.has_data():
            axis.legend(loc="lower right")
    figure.savefig(path, dpi=100)


def main() -> None:
    """Runs what the arguments ask for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("report"), help="folder for the results")
    parser.add_argument("--presets", nargs="+", choices=PRESETS, default=list(PRESETS))
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--steps", type=int, help="steps for all presets")
    parser.add_argument("--long", type=int, default=0, help="seeds of longer runs beside them")
    parser.add_argument("--cases", type=int, default=1_000)
    arguments = parser.parse_args()

    arguments.out.mkdir(parents=True, exist_ok=True)
    plan = [
        (preset, arguments.steps or PRESETS[preset].steps, seed)
        for preset in arguments.presets
        for seed in range(arguments.seeds)
    ]
    plan += [(p, LONG[p], seed) for p in arguments.presets for seed in range(arguments.long)]
    runs: list[Run] = []
    for preset, steps, seed in plan:
        runs.append(one_run(preset, steps, seed, arguments.cases))
        lines = ",\n".join(json.dumps(run) for run in runs)
        (arguments.out / "ppo_reach.json").write_text(f"[\n{lines}\n]\n")
    picture(runs, arguments.out / "ppo_reach.png")
    print(table(runs))


if __name__ == "__main__":
    main()
