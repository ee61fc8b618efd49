"""Configs: the dataclasses, the profiles in Rust, and documents that change them."""

from __future__ import annotations

import json
import re
import time
from dataclasses import asdict, fields, is_dataclass, replace

import numpy as np
import pytest

from gym_babble import Config, HebbBabbling, _core, scenarios
from gym_babble.config import (
    Arm,
    Cylinder,
    GraspConfig,
    Object,
    RegionConfig,
    config_json,
)
from gym_babble.envs import BabbleGraspEnv, BabbleReachEnv
from gym_babble.errors import BabbleError, ConfigError

PAPER = json.loads(_core.profile_config("paper"))
ICUB = json.loads(_core.profile_config("icub"))


def leaves(value, path=""):
    """Every number of a config with its path."""
    if isinstance(value, dict):
        for name, part in value.items():
            yield from leaves(part, f"{path}.{name}" if path else name)
    elif isinstance(value, list):
        for i, part in enumerate(value):
            yield from leaves(part, f"{path}[{i}]")
    elif value is not None:  # Rust leaves out what is not there.
        yield path, value


def test_the_dataclasses_defaults_are_rusts_paper_profile():
    ours = json.loads(Config().to_json())
    assert dict(leaves(ours)) == dict(leaves(PAPER))
    assert len(ours["body"]["joints"]) == 26


def test_every_field_of_the_document_is_a_field_of_the_dataclasses():
    def compare(kind, document, path):
        assert {f.name for f in fields(kind)} == set(document), path
        for f in fields(kind):
            value = getattr(kind, f.name)
            if is_dataclass(value):
                compare(value, document[f.name], f"{path}.{f.name}")

    # Noise is written if there is some.
    noisy = json.loads(config_json({"noise": {"motor_deg": 1.0}}))
    compare(Config(), noisy, "config")
    # The numbers of grasping are among them.
    walked = dict(leaves(PAPER))
    for path in ("body.grip.arm_muscles.kp", "body.object.friction", "body.contact.stiffness_n_m"):
        assert path in walked
    assert "grasp.palm_side.polar_deg[0]" in walked


@pytest.mark.parametrize("profile", ["paper", "icub"])
def test_configs_round_trip(profile):
    config = Config.profile_named(profile)
    assert config.profile == profile
    assert Config.from_json(config.to_json()) == config
    assert json.loads(config_json(config)) == json.loads(_core.profile_config(profile))
    assert config_json(profile) == config_json(config)


def test_the_icub_differs_where_the_docs_say():
    icub = Config.profile_named("icub")
    assert icub.body.obstacle.radius_m == 0.02
    assert icub.reach.distance_m == (0.1, 0.2)
    shoulder, elbow = (icub.body.joints[name] for name in ("shoulder", "elbow"))
    assert (shoulder.lower_deg, shoulder.upper_deg) == (-10, 95)
    assert (elbow.lower_deg, elbow.upper_deg) == (15, 106)
    assert all(
        joint.locked_deg == 0
        for name, joint in icub.body.joints.items()
        if name not in ("shoulder", "elbow")
    )
    assert icub.grasp.palm_side == RegionConfig(
        radius_m=(0.15, 0.29),
        polar_deg=(90, 160),
        shoulder_deg=(-10, 10),
        elbow_deg=(15, 90),
    )
    # In nothing else.
    differing = {
        path for path, value in dict(leaves(ICUB)).items() if dict(leaves(PAPER))[path] != value
    }
    assert {path for path in differing if path.startswith("grasp")} == {
        "grasp.palm_side.polar_deg[0]",
        *(f"grasp.palm_side.shoulder_deg[{i}]" for i in range(2)),
        "grasp.palm_side.elbow_deg[0]",
    }
    assert icub.body.grip == Config().body.grip


def test_file_dict_and_dataclass_are_one_config(tmp_path):
    changes = {
        "profile": "icub",
        "body": {
            "arm": {"upper_arm_m": 0.2},
            "obstacle": {"radius_m": 0.03},
            "joints": {"elbow": {"upper_deg": 120.0}},
        },
        "reach": {"movement_s": 5.0, "distance_m": [0.1, 0.15]},
    }
    (tmp_path / "body.json").write_text(json.dumps(changes))
    (tmp_path / "body.toml").write_text(
        'profile = "icub"\n[body.arm]\nupper_arm_m = 0.2\n[body.obstacle]\nradius_m = 0.03\n'
        "[body.joints.elbow]\nupper_deg = 120.0\n"
        "[reach]\nmovement_s = 5.0\ndistance_m = [0.1, 0.15]\n"
    )
    icub = Config.profile_named("icub")
    elbow = replace(icub.body.joints["elbow"], upper_deg=120.0)
    made = replace(
        icub,
        body=replace(
            icub.body,
            arm=Arm(upper_arm_m=0.2),
            obstacle=Cylinder(radius_m=0.03),
            joints={**icub.body.joints, "elbow": elbow},
        ),
        reach=replace(icub.reach, movement_s=5.0, distance_m=(0.1, 0.15)),
    )
    bodies = [changes, tmp_path / "body.json", str(tmp_path / "body.toml"), made]
    assert len({config_json(config) for config in bodies}) == 1
    assert Config.load(tmp_path / "body.toml") == made
    firsts = []
    for config in bodies:
        env = BabbleReachEnv(config=config)
        env.reset(seed=0)
        firsts.append(env.scenario)
    assert firsts.count(firsts[0]) == 4
    assert firsts[0]["obstacle"][2] == 0.03


def test_file_dict_and_dataclass_are_one_config_of_grasping(tmp_path):
    path = tmp_path / "grasp.toml"
    path.write_text(
        "[body.grip]\nreflex_deg = [40.0, 60.0]\n[body.grip.hand_muscles]\nkp = 0.6\n"
        "[body.object]\nfriction = 0.4\n"
        "[grasp]\ndiameters_m = [0.03, 0.04, 0.05]\nhold_steps = 8\n"
        "[grasp.palm_side]\nradius_m = [0.2, 0.25]\n"
    )
    changes = {
        "body": {
            "grip": {"reflex_deg": [40.0, 60.0], "hand_muscles": {"kp": 0.6}},
            "object": {"friction": 0.4},
        },
        "grasp": {
            "diameters_m": [0.03, 0.04, 0.05],
            "hold_steps": 8,
            "palm_side": {"radius_m": [0.2, 0.25]},
        },
    }
    paper = Config()
    grip = replace(
        paper.body.grip,
        reflex_deg=(40.0, 60.0),
        hand_muscles=replace(paper.body.grip.hand_muscles, kp=0.6),
    )
    made = replace(
        paper,
        body=replace(paper.body, grip=grip, object=Object(friction=0.4)),
        grasp=GraspConfig(
            diameters_m=(0.03, 0.04, 0.05),
            hold_steps=8,
            palm_side=replace(paper.grasp.palm_side, radius_m=(0.2, 0.25)),
        ),
    )
    assert len({config_json(config) for config in (path, changes, made)}) == 1
    assert Config.load(path) == made
    seen = []
    for config in (path, changes, made):
        env = BabbleGraspEnv(config=config)
        env.reset(seed=0)
        seen.append((env.scenario, env.state_hash()))
    assert seen.count(seen[0]) == 3
    assert seen[0][0]["diameter"] in made.grasp.diameters_m
    # The argument is the same number.
    changes["grasp"].pop("diameters_m")
    env = BabbleGraspEnv(config=changes, diameters=made.grasp.diameters_m)
    env.reset(seed=0)
    assert (env.scenario, env.state_hash()) == seen[0]


def test_numbers_of_one_task_change_no_state_of_the_other():
    # A state of reaching is good whatever grasps are like, and the other way round.
    for kind, own, foreign in (
        (BabbleReachEnv, "reach", "grasp"),
        (BabbleGraspEnv, "grasp", "reach"),
    ):
        plain, other, changed = (
            kind(config={name: {"delta_posture_deg": 4.0}} if name else {})
            for name in (None, foreign, own)
        )
        for env in (plain, other, changed):
            env.reset(seed=0)
        assert plain.state_hash() == other.state_hash() != changed.state_hash()
        other.set_state(plain.get_state())


def test_a_config_reaches_the_simulation():
    env = BabbleReachEnv(config={"reach": {"control_period_s": 0.1}})
    assert env.metadata["render_fps"] == 10
    assert BabbleReachEnv().metadata["render_fps"] == 20
    stiff = BabbleReachEnv(config={"body": {"muscles": {"kp": 200.0}}}, control="posture")
    soft = BabbleReachEnv(control="posture")
    options = {"start": (0.1, 0.2), "target": (0.2, 0.2), "obstacle": None}
    moved = []
    for env in (stiff, soft):
        before, _ = env.reset(options=options)
        after, *_ = env.step([1, 1])
        moved.append((after["arm"] - before["arm"]).sum())
    assert moved[0] > 2 * moved[1] > 0


UNKNOWN = [
    ({"speed": 1}, "speed"),
    ({"body": {"leg": {}}}, "body.leg"),
    ({"body": {"arm": {"length": 1}}}, "length"),
    ({"body": {"joints": {"knee": {"lower_deg": 0, "upper_deg": 1}}}}, "knee"),
    ({"body": {"joints": {"elbow": {"middle_deg": 1}}}}, "middle_deg"),
    ({"body": {"eye": {"lens": 1}}}, "lens"),
    ({"reach": {"speed": 1}}, "reach.speed"),
    ({"grasp": {"force": 1}}, "grasp.force"),
    ({"grasp": {"palm_side": {"depth_m": 1}}}, "grasp.palm_side.depth_m"),
    ({"body": {"grip": {"strength": 1}}}, "body.grip.strength"),
    ({"body": {"grip": {"hand_muscles": {"ki": 1}}}}, "ki"),
    ({"body": {"object": {"colour": "red"}}}, "body.object.colour"),
    ({"body": {"contact": {"hardness": 1}}}, "body.contact.hardness"),
    ({1: 2}, "1"),
]


@pytest.mark.parametrize(("config", "named"), UNKNOWN, ids=lambda x: str(x)[:30])
def test_an_unknown_field_is_named_at_each_level(config, named):
    with pytest.raises(ConfigError, match=named):
        config_json(config)


OUT_OF_BOUNDS = [
    ({"body": {"arm": {"upper_arm_m": -0.1}}}, "upper_arm_m"),
    ({"body": {"arm": {"forearm_m": 0}}}, "forearm_m"),
    ({"body": {"arm": {"half_width_m": 5}}}, "half_width_m"),
    ({"body": {"hand": {"finger_m": [0.01, 0.02]}}}, "finger_m"),
    ({"body": {"muscles": {"kd": -1}}}, "kd"),
    ({"body": {"muscles": {"kp": 0}}}, "kp"),
    ({"body": {"joints": {"elbow": {"lower_deg": 90, "upper_deg": 10}}}}, "elbow"),
    ({"body": {"joints": {"elbow": {"lower_deg": "wide"}}}}, "lower_deg"),
    ({"body": {"joints": {"shoulder": {"locked_deg": 0}}}}, "shoulder"),
    ({"body": {"eye": {"position_m": [0, 0]}}}, "position_m"),
    ({"body": {"eye": {"field_deg": 190}}}, "field_deg"),
    ({"body": {"eye": {"pixels": 0}}}, "pixels"),
    ({"body": {"eye": {"frame": "listing"}}}, "frame"),
    ({"body": {"eye": {"pan_deg": [10, -10]}}}, "pan_deg"),
    ({"body": {"obstacle": {"radius_m": 0}}}, "radius_m"),
    ({"body": {"target": {"radius_m": float("nan")}}}, "body.target.radius_m: nan is not finite"),
    ({"body": {"target": {"radius_m": np.float32("inf")}}}, "body.target.radius_m: inf is not"),
    ({"body": {"arm": {"forearm_m": 10**400}}}, "body.arm.forearm_m: 10+ .*2.63"),
    ({"body": {"arm": {"forearm_m": b"0.1"}}}, "body.arm.forearm_m: b'0.1' is not"),
    ({"body": {"arm": {"forearm_m": object()}}}, "body.arm.forearm_m: <object"),
    ({"body": {"hand": {"finger_m": (0.01, np.nan, 0.01, 0.01)}}}, r"body.hand.finger_m\[1\]: nan"),
    ({"body": {"arm": {3: 0.1}}}, "body.arm: 3 is not the name"),
    ({"grasp": {"diameters_m": [0.03] * 1001}}, "grasp.diameters_m: 1001 items"),
    ({"grasp": {"diameters_m": np.zeros(10**7)}}, "grasp.diameters_m: 10000000 items"),
    ({"body": {"target": {"radius_m": None}}}, "radius_m"),
    ({"reach": {"distance_m": [0.2, 0.1]}}, "distance_m"),
    ({"reach": {"b_range": [0, 1]}}, "b_range"),
    ({"reach": {"physics_steps": 0}}, "physics_steps"),
    ({"reach": {"physics_steps": 2.5}}, "physics_steps"),
    ({"reach": {"control_period_s": float("inf")}}, "reach.control_period_s: inf is not finite"),
    ({"reach": {"success_radius_m": 0.5}}, "success_radius_m"),
    ({"reach": []}, "reach"),
    ({"grasp": []}, "grasp"),
    ({"grasp": {"diameters_m": []}}, "grasp.diameters_m.*at least one"),
    ({"grasp": {"diameters_m": [0.03, 0.3]}}, r"diameters_m\[1\].*0.2"),
    ({"grasp": {"diameters_m": 0.03}}, "diameters_m"),
    ({"grasp": {"any_diameter_between": "yes"}}, "any_diameter_between"),
    ({"grasp": {"full": {"radius_m": [0.3, 0.1]}}}, r"full.radius_m\[1\]"),
    ({"grasp": {"palm_side": {"polar_deg": [40]}}}, "polar_deg"),
    ({"grasp": {"hold_steps": 0}}, "hold_steps"),
    ({"grasp": {"physics_steps": 300}}, "physics_steps"),
    ({"grasp": {"control_period_s": 0.3}}, r"physics_steps: 10 .*\[15, 250\]"),
    ({"reach": {"settle_time_constants": 20.0}, "body": {"muscles": {"kp": 1.0}}}, "settle.*120"),
    ({"body": {"muscles": {"kd": 0.01}}}, "muscles.torque_max = 50"),
    ({"grasp": {"held_share": 1.0}}, "held_share.*0.999"),
    ({"grasp": {"touch_max_n": 0}}, "touch_max_n"),
    ({"body": {"grip": {"fingers": "five"}}}, "fingers"),
    ({"body": {"grip": {"flexion_deg": [90, 0]}}}, "flexion_deg"),
    ({"body": {"grip": {"hand_muscles": {"kp": 0}}}}, "grip.hand_muscles.kp"),
    ({"body": {"object": {"friction": -1}}}, "object.friction"),
    ({"body": {"object": {"density_kg_m3": 0}}}, "object.density_kg_m3"),
    ({"body": {"contact": {"stiffness_n_m": 0}}}, "contact.stiffness_n_m"),
    ({"body": {"contact": {"relaxation_s": -1}}}, "contact.relaxation_s"),
    ({"body": {"contact": {"stiction_m_s": 0}}}, "contact.stiction_m_s"),
    ({"body": {"engine": "bullet"}}, "engine"),
    ({"body": "big"}, "body"),
    ({"profile": "giant"}, "giant"),
    ({"profile": 3}, "profile"),
    ({"body": {1, 2}}, r"body: \{1, 2\} is not a number"),
    ({"reach": {"physics_steps": np.True_}}, "reach.physics_steps"),
    ({"reach": {"movement_s": np.zeros(2, "datetime64[s]")}}, "reach.movement_s: .*datetime64"),
]


@pytest.mark.parametrize(("config", "named"), OUT_OF_BOUNDS, ids=lambda x: str(x)[:50])
def test_what_cannot_be_is_refused_by_name(config, named):
    with pytest.raises(ConfigError, match=named) as caught:
        BabbleReachEnv(config=config)
    with pytest.raises(ConfigError, match=named):
        BabbleGraspEnv(config=config)
    assert isinstance(caught.value, ValueError)
    assert isinstance(caught.value, BabbleError)


@pytest.mark.parametrize("config", [None, 3, ["paper"], b"paper", Arm(), "Paper", "", object])
def test_a_config_of_another_kind_is_refused(config):
    with pytest.raises(ConfigError, match="config"):
        BabbleReachEnv(config=config)


def test_a_dataclass_with_wrong_values_is_refused():
    for broken in (
        replace(Config(), reach=None),
        replace(Config(), body=replace(Config().body, arm=Arm(upper_arm_m="long"))),
        replace(Config(), body=replace(Config().body, arm=Arm(upper_arm_m={1, 2}))),
    ):
        with pytest.raises(ConfigError):
            BabbleReachEnv(config=broken)


def test_numpys_numbers_are_numbers():
    given = {
        "reach": {
            "movement_s": np.float32(5),
            "physics_steps": np.int64(5),
            "distance_m": np.array([0.1, 0.2]),
        },
        "grasp": {"any_diameter_between": np.True_, "hold_steps": np.uint8(9)},
        "body": {"muscles": {"kp": np.array(45)}},
    }
    plain = {
        "reach": {"movement_s": 5.0, "physics_steps": 5, "distance_m": [0.1, 0.2]},
        "grasp": {"any_diameter_between": True, "hold_steps": 9},
        "body": {"muscles": {"kp": 45}},
    }
    assert config_json(given) == config_json(plain)
    changed = replace(Config(), reach=replace(Config().reach, movement_s=np.float32(5)))
    assert json.loads(config_json(changed))["reach"]["movement_s"] == 5


def test_deep_dicts_and_circles_are_refused_by_their_field():
    deep: dict = {}
    inner = deep
    for _ in range(3000):
        inner["reach"] = {}
        inner = inner["reach"]
    circle: dict = {}
    circle["body"] = [circle]
    for config, field in ((deep, "reach.reach"), (circle, r"body\[0\].body")):
        with pytest.raises(ConfigError, match=f"{field}.*nested in more than 16 levels"):
            config_json(config)


def test_a_config_of_numbers_that_are_not_finite_is_not_written():
    config = replace(Config(), reach=replace(Config().reach, movement_s=float("nan")))
    with pytest.raises(ConfigError, match=r"reach.movement_s: nan is not finite"):
        config.to_json()


def test_broken_files_are_refused_by_their_path(tmp_path):
    for name, content in (
        ("cut.json", b'{"profile": "pap'),
        ("list.json", b"[1, 2]"),
        ("cut.toml", b"[body\nupper = "),
        ("bytes.toml", b"\xff\xfe\x00"),
        ("unknown.toml", b"[reach]\nspeed = 1\n"),
        ("body.yaml", b"profile: paper"),
        ("twice.json", b'{"reach": {"movement_s": 5.0, "movement_s": 6.0}}'),
        ("nan.toml", b"[reach]\nmovement_s = nan"),
        ("far.json", b'{"reach": {"movement_s": 1e400}}'),
        ("deep.json", b"[" * 100_000),
        ("huge.json", b" " * 2**21),
        ("picture.toml", b"\x89PNG\r\n\x1a\n"),
    ):
        path = tmp_path / name
        path.write_bytes(content)
        with pytest.raises(ConfigError, match=name.replace(".", r"\.")):
            BabbleReachEnv(config=path)
    with pytest.raises(ConfigError, match="missing"):
        BabbleReachEnv(config="missing.toml")
    with pytest.raises(ConfigError, match=r"'body.yaml' is not one of paper, icub, and not a file"):
        BabbleReachEnv(config="body.yaml")
    marked = tmp_path / "marked.json"
    marked.write_text('{"profile": "icub"}', encoding="utf-8-sig")
    assert Config.load(marked) == Config.profile_named("icub")
    with pytest.raises(ConfigError):
        BabbleReachEnv(config=tmp_path)


def test_an_eye_that_cannot_see_the_arms_plane_says_so():
    env = BabbleReachEnv(config={"body": {"eye": {"position_m": [0, 0, -1]}}})
    with pytest.raises(ConfigError, match="no red pixel"):
        env.reset(seed=0)


def test_a_config_with_no_room_for_a_case_says_so():
    config = {
        "body": {"obstacle": {"radius_m": 0.124}},
        "reach": {"distance_m": [0.08, 0.0801]},
    }
    env = BabbleReachEnv(config=config)
    with pytest.raises(BabbleError, match="no legal movement"):
        env.reset(seed=0)
    with pytest.raises(BabbleError, match="no legal movement"):
        scenarios("table1", 1, config=config)


# Bodies with which nothing can be done: there is no case, or no movement is legal, or the
# hand keeps no object.
HOPELESS = {
    "no joint range": {
        "body": {
            "joints": {
                "shoulder": {"lower_deg": 0, "upper_deg": 2},
                "elbow": {"lower_deg": 10, "upper_deg": 12},
            }
        }
    },
    "a thick arm": {"body": {"arm": {"half_width_m": 0.05}, "obstacle": {"radius_m": 0.05}}},
    "straight movements": {
        "body": {"obstacle": {"radius_m": 0.03}},
        "reach": {"b_range": [0.4999, 0.5001]},
    },
}
PROMPTLY_S = 10.0
"""Processor time until a hopeless body says so, on a slow machine too."""


def promptly(call, named):
    """Its error tells what was tried, within a few seconds."""
    began = time.process_time()
    with pytest.raises(BabbleError, match=named) as caught:
        call()
    assert time.process_time() - began < PROMPTLY_S
    return str(caught.value)


@pytest.mark.parametrize("name", HOPELESS)
def test_a_hopeless_body_says_so_in_seconds(name):
    config = HOPELESS[name]
    for control in ("delta_posture", "pattern"):
        env = BabbleReachEnv(config=config, control=control)
        said = promptly(lambda env=env: env.reset(seed=0), "no legal movement: of")
        drawn, played = map(int, re.findall(r"of (\d+) random .* ends of (\d+)", said)[0])
        assert drawn > 0
        assert drawn == 1_000_000 or played > 0
    promptly(lambda: scenarios("table1", 2, config=config), "no legal movement: of")
    env = BabbleReachEnv(config=config, control="pattern")
    for fast in (True, False):
        agent = HebbBabbling(env, quasi_static=fast, threads=1)
        promptly(lambda agent=agent: agent.learn(10), "no legal movement|only 0 of")
        assert (agent.babbled, agent.learnt) == (0, 0)


def test_a_hopeless_hand_says_so_in_seconds():
    # An open hand, and a palm too near for an object before it: 500 babbles of 5 ms are tried.
    config = {"body": {"grip": {"reflex_deg": [0, 0]}}, "grasp": {"palm_reach_m": 0.01}}
    agent = HebbBabbling(BabbleGraspEnv(config=config), threads=1)
    promptly(lambda: agent.learn(10), "only 0 of 5.. babbles")
    region = {"radius_m": [0.01, 0.011], "polar_deg": [-5, 5]}
    nowhere = {"grasp": {"palm_side": region, "full": region}}
    for protocol in ("palm_side", "full"):
        promptly(lambda p=protocol: scenarios(p, 2, config=nowhere), "no case in 10000 tries")


def test_a_config_with_no_room_for_a_grasp_says_so():
    # All objects lie in the shoulder.
    region = {"radius_m": [0.01, 0.011], "polar_deg": [-5, 5]}
    env = BabbleGraspEnv(config={"grasp": {"palm_side": region}})
    with pytest.raises(BabbleError, match=r"no case in 10000 tries.*object"):
        env.reset(seed=0)


def test_the_config_is_whole_in_asdict_of_a_profile():
    whole = json.loads(json.dumps(asdict(Config.profile_named("icub"))))
    # A document leaves out noise while there is none.
    assert not any(whole.pop("noise").values())
    assert dict(leaves(whole)) == dict(leaves(ICUB))
