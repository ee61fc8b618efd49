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
from comparing import CONTROLS, IDS

from gym_babble import _core
from gym_babble.config import Config
from gym_babble.envs import BabbleReachEnv, BabbleReachVectorEnv
from gym_babble.registration import ENVIRONMENTS

DOCSTRING = inspect.cleandoc(BabbleReachEnv.__doc__)


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


def test_the_table_of_senses_is_the_cores():
    choices = BabbleReachEnv().choices
    rows = table(DOCSTRING, "sense")
    assert [row[0] for row in rows] == [entry.name for entry in choices.spec.senses]
    for (name, size, low, high, unit), entry in zip(rows, choices.spec.senses, strict=True):
        n = int(size)
        assert n == len(entry.labels), name
        widths = choices.joint_range.tolist()
        for text, numbers in ((low, entry.low), (high, entry.high)):
            documented = bounds(text, widths)
            assert (documented * n)[:n] == pytest.approx(list(numbers)), name
        for label in entry.labels:
            assert label in unit or entry.name == "time", (name, label)
        if name in ("obstacle", "stretch", "arm"):
            assert ("[rad]" in unit) == (entry.unit == "rad"), name


def test_the_sum_of_sizes_is_the_flat_observations():
    size = sum(int(row[1]) for row in table(DOCSTRING, "sense"))
    assert f"Box({size},)" in DOCSTRING
    assert BabbleReachEnv(obs="flat").observation_space.shape == (size,)


def test_the_table_of_controls_is_the_cores():
    rows = {row[0]: row[1:] for row in table(DOCSTRING, "control")}
    assert tuple(rows) == CONTROLS
    for control, (first, second, meaning) in rows.items():
        env = BabbleReachEnv(control=control)
        assert env.choices.spec.action.labels == (first, second)
        assert env.action_space.shape == (2,)
        assert env.action_space.dtype == np.float32
        assert (env.action_space.low == -1).all()
        assert (env.action_space.high == 1).all()
        if control == "delta_posture":
            assert f"±{np.degrees(env.choices.delta_posture):g}°" in meaning
        if control == "torque":
            assert f"{Config().body.muscles.torque_max:g} N·m" in meaning
        if control == "pattern":
            low, high = env.choices.b_range
            assert f"[{low:.2f}, {high:.2f}]".replace("0.", ".") in meaning
            reach, muscles = Config().reach, Config().body.muscles
            seconds = reach.movement_s + reach.settle_time_constants * muscles.kd / muscles.kp
            assert f"{seconds:g} s" in meaning


def test_the_numbers_in_the_text_are_the_configs():
    text = " ".join(DOCSTRING.split())
    config = Config()
    arm, hand, reach = config.body.arm, config.body.hand, config.reach
    stretched = hand.palm_m + sum(hand.finger_m)
    low, high = reach.distance_m
    for number in (
        f"upper arm {100 * arm.upper_arm_m:g} cm",
        f"forearm {100 * arm.forearm_m:g} cm",
        f"hand of {100 * stretched:g} cm",
        f"time constant of {config.body.muscles.kd / config.body.muscles.kp:g} s",
        f"{100 * low:g}–{100 * high:g} cm",
        f"within {100 * reach.success_radius_m:g} cm of the target",
        f"joint speeds below {reach.settled_speed_rad_s:g} rad/s".replace("0.", "."),
        f"240 steps ({240 * reach.control_period_s:g} s)",
    ):
        assert number in text, number
    icub = Config.profile_named("icub").reach.distance_m
    assert f"`icub`: {100 * icub[0]:g}–{100 * icub[1]:g} cm" in text


def test_reward_terms_facts_and_outcomes_are_the_cores():
    text = " ".join(DOCSTRING.split())
    spec = BabbleReachEnv().choices.spec
    assert f"terms {' + '.join(spec.reward_terms)}" in text
    assert f"`outcome` ({', '.join(spec.outcomes)})" in text
    assert set(spec.outcomes) < set(_core.outcomes())
    info = text.partition("## Info")[2].partition("##")[0]
    assert re.findall(r"`(\w+)`", info) == [*spec.facts, "outcome", "reward_terms"]


def test_the_docs_table_of_ids_is_the_registrys(repository):
    text = (repository / "docs" / "environments.md").read_text(encoding="utf-8")
    rows = table(text, "id")
    assert [row[0] for row in rows] == list(IDS)
    for row, registered in zip(rows, ENVIRONMENTS, strict=True):
        env_id, obs, control, reward, limit, threshold = row
        assert (env_id, obs, control) == (registered.id, registered.obs, registered.control)
        assert reward.startswith(registered.reward)
        assert limit == str(registered.max_episode_steps or "1 (always)")
        assert float(threshold.replace("−", "-")) == registered.reward_threshold


def test_the_keywords_and_their_defaults_are_those_of_the_batch():
    single = inspect.signature(BabbleReachEnv.__init__).parameters
    batch = inspect.signature(BabbleReachVectorEnv.__init__).parameters
    assert {name: p.default for name, p in batch.items() if name in single} == {
        name: p.default for name, p in single.items()
    }
    documented = re.findall(
        r"^    (\w+): ", inspect.cleandoc(BabbleReachEnv.__init__.__doc__), re.MULTILINE
    )
    assert set(documented) - {"ConfigError"} == set(single) - {"self"}


def test_the_stub_has_the_extensions_names(repository):
    tree = ast.parse((repository / "gym_babble" / "_core.pyi").read_text(encoding="utf-8"))
    classes = {c.name: c for c in tree.body if isinstance(c, ast.ClassDef) and c.name[0] != "_"}
    functions = {f.name for f in tree.body if isinstance(f, ast.FunctionDef)}
    assert {*classes, *functions, "__version__", "debug_build"} == set(_core.__all__)
    for name, stub in classes.items():
        ours = {part.name: part for part in stub.body if isinstance(part, ast.FunctionDef)}
        theirs = vars(getattr(_core, name))
        assert set(ours) - {"__new__"} == {n for n in theirs if not n.startswith("__")}, name
        for method, runtime in theirs.items():
            if method in set(ours) - {"__new__"} and getattr(runtime, "__text_signature__", None):
                arguments = [a.arg for a in ours[method].args.args]
                signature = re.findall(r"[$(, ](\w+)(?:=|,|\)|$)", runtime.__text_signature__)
                assert set(arguments) <= {*signature, "self"}, (name, method)


@pytest.mark.slow
def test_the_stub_is_the_extension():
    command = [sys.executable, "-m", "mypy.stubtest", "gym_babble._core"]
    run = subprocess.run(command, check=False, capture_output=True, text=True)
    assert run.returncode == 0, run.stdout
