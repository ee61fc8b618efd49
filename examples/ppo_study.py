"""The study behind docs/baselines.md: a task's PPO presets, several seeds, tested on its cases.

Writes ppo_reach.json or ppo_grasp.json (one run a line) and a picture of the learning curves, and
prints a table. Seconds are clock time of learning; processor seconds include validation.

python examples/ppo_study.py --out docs/studies              # the presets' own steps
python examples/ppo_study.py --out docs/studies --long 3     # and 4 or 3 times as many

`gym-babble compare --task grasp` shows the results of this command without training:

python examples/ppo_study.py --task grasp --seeds 3 --out gym_babble/study/results \
    --pictures docs/studies
"""

import argparse
import json
import shlex
import sys
from collections import defaultdict
from io import BytesIO
from pathlib import Path
from statistics import mean
from time import process_time
from typing import Any

import matplotlib as mpl

from gym_babble import evaluate, scenarios
from gym_babble.files import check_folder, write_file
from gym_babble.study.evaluation import wilson
from gym_babble.study.ppo import train_ppo
from gym_babble.study.presets import PRESETS
from gym_babble.study.tasks import TASKS, Task, task_of

mpl.use("agg")
import matplotlib.pyplot as plt

LONG = {"pattern": 65_536, "pattern_obstacle": 65_536, "pattern_eye_obstacle": 65_536}
LONG["delta_posture"] = 3_000_000
LEARNT_FROM = ("movements", "control_steps", "seconds", "processor_seconds")

Run = dict[str, Any]


def one_run(preset: str, steps: int, seed: int, cases: int) -> Run:
    """Trains with a seed and tests, on the same cases for each seed."""
    began = process_time()
    trained = train_ppo(preset, seed=seed, steps=steps, validations=20)
    processor = process_time() - began
    task = task_of(trained.env_id)
    test = scenarios(task.protocol, cases)
    result = evaluate(trained.agent, trained.env_id, test, **trained.env_kwargs)
    return {
        "preset": preset,
        "steps": steps,
        "seed": seed,
        "cases": len(test),
        **{outcome: result.count(outcome) for outcome in task.outcomes},
        **{fact: sum(result.facts[fact]) for fact in task.facts},
        "movements": trained.movements,
        "control_steps": trained.control_steps,
        "seconds": round(trained.seconds, 1),
        "processor_seconds": round(processor, 1),
        "curve": [(p.steps, round(p.seconds, 1), round(p.success, 3)) for p in trained.curve],
    }


def document(task: Task, runs: list[Run]) -> str:
    """The study as JSON: how it was made, and a line for each run."""
    head = {
        "command": f"python examples/{Path(__file__).name} {shlex.join(sys.argv[1:])}",
        "config": "paper",
        "protocol": task.protocol,
    }
    used = [name for name in PRESETS if any(run["preset"] == name for run in runs)]
    lines = [f"{json.dumps(name)}: {json.dumps(value)}" for name, value in head.items()]
    presets = [f"{json.dumps(name)}: {json.dumps(PRESETS[name].to_json())}" for name in used]
    lines.append('"presets": {\n' + ",\n".join(presets) + "\n}")
    lines.append('"runs": [\n' + ",\n".join(json.dumps(run) for run in runs) + "\n]")
    return "{\n" + ",\n".join(lines) + "\n}\n"


def groups(runs: list[Run]) -> dict[tuple[str, int], list[Run]]:
    """The runs of each preset and length."""
    found = defaultdict(list)
    for run in runs:
        found[run["preset"], run["steps"]].append(run)
    return found


def table(task: Task, runs: list[Run]) -> str:
    """A row for each preset and length, all seeds together."""
    rest = [*task.outcomes[1:], *task.facts]
    columns = ["preset", "steps", "seeds", "success", "95 %", "range of seeds", *rest, *LEARNT_FROM]
    heads = " | ".join(name.replace("_", " ") for name in columns)
    lines = [f"| {heads} |", "| --- " * len(columns) + "|"]
    for (preset, steps), group in groups(runs).items():
        cases = sum(run["cases"] for run in group)
        low, high = wilson(sum(run["success"] for run in group), cases)
        each = [run["success"] / run["cases"] for run in group]
        cells = [preset, f"{steps:,}", str(len(group)), f"{mean(each):.3f}"]
        cells += [f"{low:.3f}–{high:.3f}", f"{min(each):.3f}–{max(each):.3f}"]
        cells += [f"{sum(run[name] for run in group) / cases:.3f}" for name in rest]
        cells += [f"{mean(run[name] for run in group):,.0f}" for name in LEARNT_FROM]
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def unit(preset: str) -> str:
    """What a step of a preset is."""
    return "movements" if PRESETS[preset].env_id == "BabbleReachPattern-v0" else "control steps"


def picture(runs: list[Run], path: Path) -> None:
    """Success on validation cases while learning: mean of the seeds, and their range shaded."""
    units = sorted({unit(run["preset"]) for run in runs}, reverse=True)
    size = (4.5 * len(units), 3.6)
    figure, axes = plt.subplots(
        1, len(units), figsize=size, sharey=True, squeeze=False, layout="constrained"
    )
    for (preset, steps), group in groups(runs).items():
        if steps != max(run["steps"] for run in runs if run["preset"] == preset):
            continue
        axis = axes[0, units.index(unit(preset))]
        points = list(zip(*(run["curve"] for run in group), strict=True))
        x = [at[0][0] for at in points]
        rates = [[point[2] for point in at] for at in points]
        axis.plot(x, [mean(rate) for rate in rates], label=preset)
        axis.fill_between(x, list(map(min, rates)), list(map(max, rates)), alpha=0.2)
    axes[0, 0].set(ylabel="success on validation cases", ylim=(0, 1))
    for axis, label in zip(axes[0], units, strict=True):
        axis.set(xlabel=label)
        axis.grid(alpha=0.3)
        axis.legend(loc="lower right")
    buffer = BytesIO()
    figure.savefig(buffer, format="png", dpi=100)
    write_file(path, buffer.getvalue())


def main() -> None:
    """Runs what the arguments ask for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--task", choices=TASKS, default="reach")
    parser.add_argument("--out", type=Path, default=Path("report"), help="folder for the results")
    parser.add_argument("--pictures", type=Path, help="folder for the picture, if another one")
    parser.add_argument("--presets", nargs="+", help="some of the task's; all if not given")
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--steps", type=int, help="steps for all presets")
    parser.add_argument("--long", type=int, default=0, help="seeds of longer runs beside them")
    parser.add_argument("--cases", type=int, default=1_000)
    arguments = parser.parse_args()
    task = TASKS[arguments.task]
    known = [name for name, preset in PRESETS.items() if task_of(preset.env_id) == task]
    presets = arguments.presets or known
    if not set(presets) <= set(known):
        parser.error(f"--presets: there are {', '.join(known)}")

    pictures = arguments.pictures or arguments.out
    for name, folder in (("--out", arguments.out), ("--pictures", pictures)):
        check_folder(folder, name)
        folder.mkdir(exist_ok=True)
    plan = [
        (preset, arguments.steps or PRESETS[preset].steps, seed)
        for preset in presets
        for seed in range(arguments.seeds)
    ]
    plan += [(p, LONG[p], seed) for p in presets if p in LONG for seed in range(arguments.long)]
    runs: list[Run] = []
    for preset, steps, seed in plan:
        runs.append(one_run(preset, steps, seed, arguments.cases))
        write_file(arguments.out / f"ppo_{task.name}.json", document(task, runs))
    print(table(task, runs))
    picture(runs, pictures / f"ppo_{task.name}.png")


if __name__ == "__main__":
    main()
