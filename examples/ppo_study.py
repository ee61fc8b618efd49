"""The study behind docs/baselines.md: a task's PPO presets, several seeds, tested on its cases.

Writes ppo_reach.json or ppo_grasp.json after each run, then a picture of the learning curves, and
prints a table. Seconds are clock time of learning; processor seconds include validation.

python examples/ppo_study.py --out docs/studies                # the presets' own steps
python examples/ppo_study.py --out docs/studies --long 3       # and 4 or 3 times as many
python examples/ppo_study.py --out docs/studies --resume       # only the runs that are missing

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
import torch

from gym_babble import evaluate, scenarios
from gym_babble.files import check_folder, write_file
from gym_babble.study.ppo import train_ppo
from gym_babble.study.presets import PRESETS
from gym_babble.study.rates import counts
from gym_babble.study.stored import Run, Study
from gym_babble.study.tasks import TASKS, Task, task_of
from gym_babble.study.versions import machine, versions

mpl.use("agg")
import matplotlib.pyplot as plt

LONG = {"pattern": 65_536, "pattern_obstacle": 65_536, "pattern_eye_obstacle": 65_536}
LONG["delta_posture"] = 3_000_000
LEARNT_FROM = ("movements", "control_steps", "seconds", "processor_seconds")
VALIDATION_CASES = 200


def one_run(preset: str, steps: int, seed: int, cases: int) -> Run:
    """Trains with a seed and tests, on the same cases for each seed."""
    began = process_time()
    trained = train_ppo(
        preset, seed=seed, steps=steps, validation_cases=VALIDATION_CASES, validations=20
    )
    processor = process_time() - began
    task = task_of(trained.env_id)
    test = scenarios(task.protocol, cases)
    result = evaluate(trained.agent, cases=test)
    torch_on = {
        "torch_threads": torch.get_num_threads(),
        "torch_instructions": torch.backends.cpu.get_cpu_capability(),
    }
    return Run(
        preset=preset,
        steps=steps,
        seed=seed,
        counts=counts(result, task.rates),
        by_size={size: counts(part, task.rates) for size, part in result.by_size().items()},
        movements=trained.movements,
        control_steps=trained.control_steps,
        seconds=round(trained.seconds, 1),
        processor_seconds=round(processor, 1),
        curve=[[p.steps, round(p.seconds, 1), round(p.success, 3)] for p in trained.curve],
        validation={**about_cases(task, "validation"), "cases": VALIDATION_CASES},
        versions=versions(),
        machine={**machine(), **torch_on},
    )


def about_cases(task: Task, split: str) -> dict[str, Any]:
    """Which cases a run is validated or tested on."""
    return {"protocol": task.protocol, "split": split, "seed": 0}


def study_of(task: Task, runs: list[Run]) -> Study:
    """The study: how it was made, and its runs."""
    used = [name for name in PRESETS if any(run.preset == name for run in runs)]
    words = [word for word in sys.argv[1:] if word != "--resume"]
    return Study(
        command=f"python examples/{Path(__file__).name} {shlex.join(words)}",
        config="paper",
        test=about_cases(task, "test"),
        presets={name: PRESETS[name].to_json() for name in used},
        runs=runs,
    )


def groups(runs: list[Run]) -> dict[tuple[str, int], list[Run]]:
    """The runs of each preset and length."""
    found = defaultdict(list)
    for run in runs:
        found[run.preset, run.steps].append(run)
    return found


def rate(run: Run, name: str) -> float:
    """Share of a run's test cases with an outcome or fact."""
    return run.counts[name] / run.counts["cases"]


def table(task: Task, runs: list[Run]) -> str:
    """A row for each preset and length: means over the seeds, and the range of their success."""
    rest = task.rates[1:]
    columns = ["preset", "steps", "seeds", "success", "range of seeds", *rest, *LEARNT_FROM]
    heads = " | ".join(name.replace("_", " ") for name in columns)
    lines = [f"| {heads} |", "| --- " * len(columns) + "|"]
    for (preset, steps), group in groups(runs).items():
        each = [rate(run, "success") for run in group]
        cells = [preset, f"{steps:,}", str(len(group)), f"{mean(each):.3f}"]
        cells += [f"{min(each):.3f}–{max(each):.3f}"]
        cells += [f"{mean(rate(run, name) for run in group):.3f}" for name in rest]
        cells += [f"{mean(getattr(run, name) for run in group):,.0f}" for name in LEARNT_FROM]
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def unit(preset: str) -> str:
    """What a step of a preset is."""
    return "movements" if PRESETS[preset].env_id == "BabbleReachPattern-v0" else "control steps"


def picture(runs: list[Run], path: Path) -> None:
    """Success on validation cases while learning: mean of the seeds, and their range shaded."""
    units = sorted({unit(run.preset) for run in runs}, reverse=True)
    size = (4.5 * len(units), 3.6)
    figure, axes = plt.subplots(
        1, len(units), figsize=size, sharey=True, squeeze=False, layout="constrained"
    )
    for (preset, steps), group in groups(runs).items():
        if steps != max(run.steps for run in runs if run.preset == preset):
            continue
        axis = axes[0, units.index(unit(preset))]
        points = list(zip(*(run.curve for run in group), strict=True))
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


def seeds(text: str) -> range:
    """The seeds 0 to n - 1 from "n", or a to b from "a-b"."""
    first, dash, last = text.partition("-")
    return range(int(first), int(last) + 1) if dash else range(int(text))


def arguments_of() -> argparse.Namespace:
    """The arguments, checked."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--task", choices=TASKS, default="reach")
    parser.add_argument("--out", type=Path, default=Path("report"), help="folder for the results")
    parser.add_argument("--pictures", type=Path, help="folder for the picture, if another one")
    parser.add_argument("--presets", nargs="+", help="some of the task's; all if not given")
    parser.add_argument("--seeds", type=seeds, default=range(5), help="how many, or first-last")
    parser.add_argument("--steps", type=int, help="steps for all presets")
    parser.add_argument("--long", type=int, default=0, help="seeds of longer runs beside them")
    parser.add_argument("--cases", type=int, default=1_000)
    parser.add_argument("--resume", action="store_true", help="keep the runs that the file has")
    arguments = parser.parse_args()
    task = TASKS[arguments.task]
    known = [name for name, preset in PRESETS.items() if task_of(preset.env_id) == task]
    arguments.presets = arguments.presets or known
    if not set(arguments.presets) <= set(known):
        parser.error(f"--presets: there are {', '.join(known)}")
    return arguments


def kept_runs(file: Path, task: Task, cases: int) -> list[Run]:
    """The runs of a file to go on from; its presets and test cases must be today's."""
    if not file.exists():
        return []
    found = Study.read(file)
    today = study_of(task, found.runs)
    if json.dumps(found.presets) != json.dumps(today.presets) or found.test != today.test:
        sys.exit(f"{file} is a study of other presets or cases: run without --resume")
    if {run.counts["cases"] for run in found.runs} - {cases}:
        sys.exit(f"{file} is a study of another number of cases than {cases}")
    return found.runs


def main() -> None:
    """Runs what the arguments ask for."""
    arguments = arguments_of()
    torch.set_num_threads(1)
    task = TASKS[arguments.task]
    pictures = arguments.pictures or arguments.out
    for name, folder, kind in (("--out", arguments.out, "json"), ("--pictures", pictures, "png")):
        check_folder(folder, name, [f"ppo_{task.name}.{kind}"])
        folder.mkdir(exist_ok=True)
    plan = [
        (preset, arguments.steps or PRESETS[preset].steps, seed)
        for preset in arguments.presets
        for seed in arguments.seeds
    ]
    longer = [preset for preset in arguments.presets if preset in LONG]
    plan += [(preset, LONG[preset], seed) for preset in longer for seed in range(arguments.long)]
    file = arguments.out / f"ppo_{task.name}.json"
    runs = kept_runs(file, task, arguments.cases) if arguments.resume else []
    for preset, steps, seed in plan:
        if (preset, steps, seed) in {run.key for run in runs}:
            continue
        run = one_run(preset, steps, seed, arguments.cases)
        print(f"{preset}, seed {seed}: success {rate(run, 'success'):.3f}", file=sys.stderr)
        runs.append(run)
        runs.sort(key=lambda run: plan.index(run.key) if run.key in plan else len(plan))
        study_of(task, runs).write(file)
    print(table(task, runs))
    picture(runs, pictures / f"ppo_{task.name}.png")


if __name__ == "__main__":
    main()
