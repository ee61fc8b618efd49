"""The tables of the docs say what the core says."""

from __future__ import annotations

import ast
import inspect
import math
import re
import subprocess
import sys

import numpy as np
import pytest
from comparing import ALL_IDS, BATCHES, CONTROLS_OF, ENVIRONMENTS, REGIONS, TASKS

from gym_babble import _core
from gym_babble.config import Config
from gym_babble.envs import BabbleGraspEnv, registry

DOCSTRINGS = {task: inspect.cleandoc(kind.__doc__) for task, kind in TASKS.items()}
each_task = pytest.mark.parametrize("task", TASKS)


def table(text: str, first: str) -> list[list[str]]:
    """Cells of the rows of the markdown table whose head begins with `first`."""
    lines = text.splitlines()
    start = next(i for i, line in enumerate(lines) if line.startswith(f"| {first} |"))
    rows = []
    for line in lines[start + 2 :]:
        if not line.startswith("|"):
            break
        rows.append([cell.strip().strip("`") for cell in line.strip("|").split("|")])
    return rows


def angle(text: str) -> float:
    return {"π": math.pi, "π/2": math.pi / 2}[text.lstrip("−")] * (-1 if text[0] == "−" else 1)


def bounds(text: str, widths: list[float]) -> list[float]:
    """The numbers that a cell of the table of senses stands for."""
    if "range" in text:
        return [-w if text.startswith("−") else w for w in widths]
    if "π" in text:
        return [angle(part) for part in text.split(", ")]
    return [float(text)]


@each_task
def test_the_table_of_senses_is_the_cores(task):
    interface = TASKS[task]().interface
    quantities = interface.quantities
    rows = table(DOCSTRINGS[task], "sense")
    assert [row[0] for row in rows] == [entry.name for entry in interface.spec.senses]
    ranges = quantities["joint_range"] if task == "reach" else np.ptp(quantities["ranges"], axis=1)
    for (name, size, low, high, unit), entry in zip(rows, interface.spec.senses, strict=True):
        n = int(size)
        assert n == len(entry.labels), name
        for text, numbers in ((low, entry.low), (high, entry.high)):
            documented = bounds(text, ranges.tolist())
            assert (documented * n)[:n] == pytest.approx(list(numbers)), name
        for label in entry.labels:
            # The labels of all four joints stand in the table of controls.
            assert label in unit or name == "time" or (name, task) == ("stretch", "grasp"), label
        if name in ("obstacle", "stretch", "arm"):
            assert ("[rad]" in unit) == (entry.unit == "rad"), name


@each_task
def test_the_sum_of_sizes_is_the_flat_observations(task):
    size = sum(int(row[1]) for row in table(DOCSTRINGS[task], "sense"))
    assert f"Box({size},)" in DOCSTRINGS[task]
    assert TASKS[task](obs="flat").observation_space.shape == (size,)


@each_task
def test_the_table_of_controls_is_the_cores(task):
    rows = {row[0]: row[1:] for row in table(DOCSTRINGS[task], "control")}
    assert tuple(rows) == CONTROLS_OF[task]
    for control, (*joints, meaning) in rows.items():
        env = TASKS[task](control=control)
        assert env.interface.spec.action.labels == tuple(joints)
        assert env.action_space.shape == (len(joints),)
        assert f"`Box(-1, 1, ({len(joints)},), float32)`" in DOCSTRINGS[task]
        assert env.action_space.dtype == np.float32
        assert (env.action_space.low == -1).all()
        assert (env.action_space.high == 1).all()
        if control == "delta_posture":
            delta = np.degrees(env.interface.quantities["delta_posture"])
            assert f"±{delta:g}°" in meaning
        if control == "torque":
            assert torques(task) in meaning
        if control == "pattern":
            low, high = env.interface.quantities["b_range"]
            assert f"[{low:.2f}, {high:.2f}]".replace("0.", ".") in meaning
            reach, muscles = Config().reach, Config().body.muscles
            seconds = reach.movement_s + reach.settle_time_constants * muscles.kd / muscles.kp
            assert f"{seconds:g} s" in meaning


def torques(task):
    """Highest torques, as the docs write them."""
    if task == "reach":
        return f"{Config().body.muscles.torque_max:g} N·m"
    grip = Config().body.grip
    hand = f"{grip.hand_muscles.torque_max:g}".replace("0.", ".")
    return f"{grip.arm_muscles.torque_max:g} (hand {hand}) N·m"


def numbers_of_reaching(config):
    """The numbers in the docstring's text, as it writes them."""
    reach, muscles = config.reach, config.body.muscles
    low, high = reach.distance_m
    icub = Config.profile_named("icub").reach.distance_m
    yield f"time constant of {muscles.kd / muscles.kp:g} s"
    yield f"{100 * low:g}–{100 * high:g} cm"
    yield f"`icub`: {100 * icub[0]:g}–{100 * icub[1]:g} cm"
    yield f"within {100 * reach.success_radius_m:g} cm of the target"
    yield f"joint speeds below {reach.settled_speed_rad_s:g} rad/s".replace("0.", ".")
    yield f"240 steps ({240 * reach.control_period_s:g} s)"


def interval(ends, scale=1.0):
    return "…".join(f"{scale * end:g}".replace("-", "−") for end in ends)


def numbers_of_grasping(config):
    """The numbers in the docstring's text, as it writes them."""
    numbers, grip = config.grasp, config.body.grip
    for muscles in (grip.arm_muscles, grip.hand_muscles):
        yield f"time constant of {muscles.kd / muscles.kp:g} s"
    yield "0 (open) to 90°" if grip.flexion_deg == (0, 90) else "another range of flexion"
    yield f"over {numbers.touch_max_n:g} N"
    yield f"at least {1000 * numbers.clearance_m:g} mm from the object"
    yield f"within {100 * numbers.success_radius_m:g} cm of the goal"
    second = numbers.hold_steps * numbers.control_period_s
    yield "held the object without support for a second" if second == 1 else "another time"
    steps = {region: BabbleGraspEnv(region=region) for region in REGIONS}
    steps = {name: env.interface.spec.max_episode_steps for name, env in steps.items()}
    seconds = steps["palm_side"] * numbers.control_period_s
    yield f"{steps['palm_side']} steps ({seconds:g} s), {steps['full']} in region `full`"
    yield f"the config's {interval_of_diameters(numbers)} cm if not given"
    icub = Config.profile_named("icub").grasp.palm_side
    for region in (numbers.palm_side, icub):
        yield interval(region.polar_deg).replace("…", "–") + "°"
        elbow = interval(region.elbow_deg).replace("…", "–")
        yield f"shoulder {'in ' * (region is not icub)}{interval(region.shoulder_deg)}°"
        yield f"elbow {'in ' * (region is not icub)}{elbow}°"
    yield f"uniform in {interval(numbers.palm_side.radius_m, 100).replace('…', '–')} cm"
    full = interval(numbers.full.radius_m, 100).replace("…", "–")
    yield f'`"full"`: {full} cm, {interval(numbers.full.polar_deg)}°, all postures'
    for region in (numbers.full, Config.profile_named("icub").grasp.full):
        ranges = np.degrees(BabbleGraspEnv().interface.quantities["ranges"][:2])
        assert region.shoulder_deg[0] <= ranges[0, 0] < ranges[0, 1] <= region.shoulder_deg[1]
        assert region.elbow_deg[0] <= ranges[1, 0] < ranges[1, 1] <= region.elbow_deg[1]


def interval_of_diameters(numbers):
    return " and ".join(f"{100 * d:g}" for d in numbers.diameters_m)


@each_task
def test_the_numbers_in_the_text_are_the_configs(task):
    text = " ".join(DOCSTRINGS[task].split())
    config = Config()
    arm, hand = config.body.arm, config.body.hand
    stretched = hand.palm_m + sum(hand.finger_m)
    numbers = numbers_of_reaching if task == "reach" else numbers_of_grasping
    for number in (
        f"upper arm {100 * arm.upper_arm_m:g} cm",
        f"forearm {100 * arm.forearm_m:g} cm",
        f"hand of {100 * stretched:g} cm",
        *numbers(config),
    ):
        assert number in text, number


def test_the_pages_table_of_regions_is_the_configs(repository):
    text = (repository / "docs" / "environments.md").read_text(encoding="utf-8")
    paper, icub = (Config.profile_named(name).grasp for name in ("paper", "icub"))

    def cell(ends, unit, scale=1.0):
        return interval(ends, scale).replace("…", "–") + unit

    distance, direction, shoulder, elbow, limit = (row[1:] for row in table(text, "grasping"))
    regions = (paper.palm_side, paper.full)
    assert distance == [cell(region.radius_m, " cm", 100) for region in regions]
    palm, full = direction
    assert palm == f"{cell(paper.palm_side.polar_deg, '°')} ({cell(icub.palm_side.polar_deg, '°')})"
    assert full == cell(paper.full.polar_deg, "°")
    for row, name in ((shoulder, "shoulder_deg"), (elbow, "elbow_deg")):
        own, other = (getattr(numbers.palm_side, name) for numbers in (paper, icub))
        assert row == [f"{cell(own, '°')} ({cell(other, '°')})", "all its range"]
    assert limit == [
        str(BabbleGraspEnv(region=region).interface.spec.max_episode_steps) for region in REGIONS
    ]
    small, large = (f"{100 * diameter:g}" for diameter in paper.diameters_m)
    assert f"Diameters are {small} or {large} cm" in text


@each_task
def test_reward_terms_facts_and_outcomes_are_the_cores(task):
    text = " ".join(DOCSTRINGS[task].split())
    spec = TASKS[task]().interface.spec
    assert f"terms {' + '.join(spec.reward_terms)}" in text
    assert f"`outcome` ({', '.join(spec.outcomes)})" in text
    assert set(spec.outcomes) < set(_core.outcomes())
    info = text.partition("## Info")[2].partition("##")[0]
    assert re.findall(r"`(\w+)`", info) == [
        *spec.facts,
        "outcome",
        "reward_terms",
        *(measure.name for measure in spec.measures),
    ]


@each_task
def test_the_pages_options_and_facts_are_the_tasks(repository, task):
    page = (repository / "docs" / "environments.md").read_text(encoding="utf-8")
    rows = dict(table(page, "task"))
    options = re.findall(r"`(\w+)`", f"`{rows[task + 'ing']}`".replace("``", "`"))
    assert tuple(options) == tuple(part.name for part in registry.TASKS[task].case_parts)
    rewards = page.partition("## Rewards")[2].partition("\n## ")[0]
    assert all(f"`{fact}`" in rewards for fact in TASKS[task]().interface.spec.facts)
    threads = " ".join(page.split())
    reach, grasp = (registry.TASKS[name].envs_per_thread for name in TASKS)
    assert f"each {reach} environments of reaching, or {grasp} of grasping" in threads


def test_the_docs_table_of_ids_is_the_registrys(repository):
    text = (repository / "docs" / "environments.md").read_text(encoding="utf-8")
    rows = table(text, "id")
    assert [row[0] for row in rows] == list(ALL_IDS)
    for row, registered in zip(rows, ENVIRONMENTS, strict=True):
        env_id, obs, control, reward, limit, threshold = row
        assert (env_id, obs, control) == (
            registered.id,
            registered.options["obs"],
            registered.options["control"],
        )
        assert reward.startswith(registered.options["reward"])
        assert limit == str(registered.max_episode_steps)
        if registered.reward_threshold is None:
            assert threshold == "none"
        else:
            assert float(threshold.replace("−", "-")) == registered.reward_threshold


@each_task
def test_the_keywords_and_their_defaults_are_those_of_the_batch(task):
    single = inspect.signature(TASKS[task]).parameters
    batch = inspect.signature(BATCHES[task]).parameters
    assert {name: p.default for name, p in batch.items() if name in single} == {
        name: p.default for name, p in single.items()
    }
    options = registry.TASKS[task].defaults
    assert {name: single[name].default for name in options} == options
    assert set(single) - set(options) == {"render_mode", "config"}
    for text in (TASKS[task].__doc__, BATCHES[task].__doc__):
        assert re.findall(r"^ *- `(\w+)` \(`.*`\): ", text, re.MULTILINE) == list(options)


def test_the_stub_has_the_extensions_names(repository):
    tree = ast.parse((repository / "gym_babble" / "_core.pyi").read_text(encoding="utf-8"))
    classes = {c.name: c for c in tree.body if isinstance(c, ast.ClassDef) and c.name[0] != "_"}
    functions = {f.name for f in tree.body if isinstance(f, ast.FunctionDef)}
    assert {*classes, *functions, "__version__", "debug_build"} == set(_core.__all__)
    for name, stub in classes.items():
        parts = [part for part in stub.body if isinstance(part, ast.FunctionDef)]
        ours = {part.name: part for part in parts if not part.name.startswith("__")}
        constants = {p.target.id for p in stub.body if isinstance(p, ast.AnnAssign)}
        theirs = vars(getattr(_core, name))
        assert {*ours, *constants} == {n for n in theirs if not n.startswith("__")}, name
        for method, runtime in theirs.items():
            if method in ours and getattr(runtime, "__text_signature__", None):
                arguments = [a.arg for a in ours[method].args.args]
                signature = re.findall(r"[$(, ](\w+)(?:=|,|\)|$)", runtime.__text_signature__)
                assert set(arguments) <= {*signature, "self"}, (name, method)


def test_the_stub_is_the_extension(tmp_path):
    # What the stub imports is left unread: it is the names, parameters and kinds that are compared.
    config = tmp_path / "mypy.ini"
    config.write_text("[mypy]\nfollow_imports = skip\n")
    command = [sys.executable, "-m", "mypy.stubtest", "--mypy-config-file", config]
    run = subprocess.run(
        [*command, "gym_babble._core"], check=False, capture_output=True, text=True
    )
    assert run.returncode == 0, run.stdout
