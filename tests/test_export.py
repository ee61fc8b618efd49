"""What MuJoCo reads of the exported robot: our links, masses, joints, muscles and things."""

from __future__ import annotations

import functools
import xml.etree.ElementTree as ET

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from planar import Ours, turned

from gym_babble import _core, export_mjcf, export_urdf
from gym_babble.envs import BabbleGraspEnv, BabbleReachEnv

mujoco = pytest.importorskip("mujoco", reason="MuJoCo has no wheel for this platform")

BENT = {
    joint: {"lower_deg": -90, "upper_deg": 90, "locked_deg": angle}
    for joint, angle in (("wrist_flexion", 20), ("thumb_1", 60), ("index_pivot", 15))
} | {"little_pivot": {"lower_deg": -90, "upper_deg": 90, "locked_deg": -15}}
FIVE_FINGERS = {"body": {"grip": {"fingers": "independent"}}}
ROBOTS = {
    "reach": ("reach", "paper"),
    "reach, bent hand": ("reach", {"profile": "icub", "body": {"joints": BENT}}),
    "grasp": ("grasp", "paper"),
    "grasp, five fingers": ("grasp", FIVE_FINGERS),
}
each_robot = pytest.mark.parametrize("robot", ROBOTS)
# Shares of the joint ranges; as many as the robot with the most joints has.
shares = st.lists(st.floats(0, 1), min_size=18, max_size=18)


@functools.cache
def ours(robot):
    return Ours(*ROBOTS[robot])


@functools.cache
def exported(robot, form):
    task, config = ROBOTS[robot]
    text = (export_mjcf if form == "mjcf" else export_urdf)(task, config=config)
    return mujoco.MjModel.from_xml_string(text)


def at(model, q):
    data = mujoco.MjData(model)
    data.qpos[: len(q)] = q
    mujoco.mj_forward(model, data)
    return data


def ends(model, data, name):
    """Both ends of a capsule's axis [m]."""
    geom = data.geom(name)
    along = geom.xmat.reshape(3, 3)[:, 2] * model.geom(name).size[1]
    return np.array([geom.xpos - along, geom.xpos + along])


def solids(robot, shape):
    """The solids of a shape, with the index of their link."""
    for i, link in enumerate(ours(robot).links):
        yield from ((i, solid) for solid in link["solids"] if solid["shape"] == shape)


def assert_weighs(model, link):
    """The body's mass, and the inertia that MuJoCo turned to its principal axes."""
    body = model.body(link["name"])
    assert body.mass[0] == pytest.approx(link["mass"], rel=1e-12)
    assert body.ipos == pytest.approx(np.array(link["centre"]), abs=1e-12)
    turn = np.zeros(9)
    mujoco.mju_quat2Mat(turn, body.iquat)
    turn = turn.reshape(3, 3)
    inertia = turn @ np.diag(body.inertia) @ turn.T
    assert inertia == pytest.approx(np.reshape(link["inertia"], (3, 3)), rel=1e-6, abs=1e-14)


@pytest.mark.parametrize("form", ["mjcf", "urdf"])
@each_robot
def test_masses_joints_and_ranges_are_ours(robot, form):
    # Catches inertias that MuJoCo infers from geoms, axes that turn the other way, degrees.
    model, links = exported(robot, form), ours(robot).links
    for i, link in enumerate(links):
        assert_weighs(model, link)
        joint = model.joint(link["joint"])
        assert joint.id == i
        assert joint.axis.tolist() == [0, 0, -1 if link["clockwise"] else 1]
        assert joint.range.tolist() == link["range"]
        assert bool(model.jnt_limited[i]) == (form == "urdf" or link["stops"])
    robot_mass = sum(model.body(link["name"]).mass[0] for link in links)
    assert robot_mass == pytest.approx(sum(link["mass"] for link in links), rel=1e-12)


@each_robot
def test_muscles_are_ours(robot):
    model, links = exported(robot, "mjcf"), ours(robot).links
    assert model.nu == len(links)
    for link in links:
        muscle, kp, kd = model.actuator(link["joint"]), link["muscles"]["kp"], link["muscles"]["kd"]
        # T = K_P (q_des − q) − K_D q̇
        assert muscle.gainprm[0] == kp
        assert muscle.biasprm[:3].tolist() == [0, -kp, -kd]
        assert muscle.ctrlrange.tolist() == link["range"]
        assert muscle.trnid[0] == model.joint(link["joint"]).id
        assert model.joint(link["joint"]).damping[0] == 0
        dof = model.joint(link["joint"]).dofadr[0]
        assert model.dof_armature[dof] == pytest.approx(model.opt.timestep * kd)


@each_robot
@given(shares=shares)
def test_solids_are_where_ours_are(robot, shares):
    model, mine = exported(robot, "mjcf"), ours(robot)
    q = mine.posture(shares)
    data, placed = at(model, q), mine.place(q)
    for i, solid in solids(robot, "capsule"):
        angle, origin = placed[i]
        expected = np.array([origin + turned(solid[end], angle) for end in "ab"])
        found = ends(model, data, solid["name"])
        # Which end MuJoCo calls the first is its own business.
        error = min(abs(found - expected).max(), abs(found[::-1] - expected).max())
        assert error < 1e-12
        assert model.geom(solid["name"]).size[0] == solid["radius"]
    for i, solid in solids(robot, "cuboid"):
        angle, origin = placed[i]
        assert data.geom(solid["name"]).xpos == pytest.approx(
            origin + turned(solid["centre"], angle), abs=1e-12
        )
        assert model.geom(solid["name"]).size.tolist() == solid["half"]


@pytest.mark.parametrize("robot", ["reach", "reach, bent hand"])
@given(shares=shares)
def test_the_fingertips_are_where_the_arm_reaches(robot, shares):
    model, mine = exported(robot, "mjcf"), ours(robot)
    q = mine.posture(shares)
    data = at(model, q)
    tips = []
    for _, solid in solids(robot, "capsule"):
        if solid["name"] in ("index_3", "middle_3", "ring_3", "little_3"):
            placed = data.body("forearm").xmat.reshape(3, 3) @ solid["b"]
            tips.append(data.body("forearm").xpos + placed)
    elbow, tip = _core.place(mine.core, tuple(q))
    assert data.body("forearm").xpos[:2] == pytest.approx(elbow, abs=1e-12)
    assert np.mean(tips, axis=0) == pytest.approx([*tip, 0], abs=1e-12)


@each_robot
@given(shares=shares)
def test_the_mass_matrix_is_ours(robot, shares):
    model, mine = exported(robot, "mjcf"), ours(robot)
    q = mine.posture(shares)
    data, n = at(model, q), len(mine.links)
    column, found = np.zeros(model.nv), np.zeros((n, n))
    for i in range(n):
        mujoco.mj_mulM(model, data, column, np.eye(model.nv)[i])
        found[:, i] = column[:n]
    found -= np.diag(model.dof_armature[:n])
    expected = mine.mass_matrix(q)
    # Beside the armature the smallest entries have lost digits.
    assert abs(found - expected).max() < 1e-12 * max(1, model.dof_armature.max())


@each_robot
@given(shares=shares)
def test_urdf_moves_as_mjcf(robot, shares):
    mine = ours(robot)
    q = mine.posture(shares)
    urdf, mjcf = exported(robot, "urdf"), exported(robot, "mjcf")
    one, other = at(urdf, q), at(mjcf, q)
    for link in mine.links:
        assert one.body(link["name"]).xpos == pytest.approx(other.body(link["name"]).xpos, abs=1e-9)
        assert one.body(link["name"]).xmat == pytest.approx(other.body(link["name"]).xmat, abs=1e-9)
    for _, solid in solids(robot, "capsule"):
        name, radius = solid["name"], solid["radius"]
        balls = np.array([one.geom(f"{name}_{end}").xpos for end in ("near", "far")])
        cylinder = ends(urdf, one, name)
        capsule = ends(mjcf, other, name)
        for found in (balls, cylinder):
            error = min(abs(found - capsule).max(), abs(found[::-1] - capsule).max())
            assert error < 1e-9
        sizes = {urdf.geom(f"{name}{end}").size[0] for end in ("", "_near", "_far")}
        assert sizes == {radius}
    for _, solid in solids(robot, "cuboid"):
        name = solid["name"]
        assert urdf.geom(name).size == pytest.approx(np.array(solid["half"]), rel=1e-12)
        assert one.geom(name).xpos == pytest.approx(other.geom(name).xpos, abs=1e-9)


@each_robot
def test_urdf_is_one_tree_that_damps(robot):
    task, config = ROBOTS[robot]
    root = ET.fromstring(export_urdf(task, config=config))  # noqa: S314 - our own text
    links = [link.get("name") for link in root.iter("link")]
    joints = root.findall("joint")
    assert len(set(links)) == len(links) == len(joints) + 1
    children = [joint.find("child").get("link") for joint in joints]
    assert {*links} - {*children} == {"base"}
    assert len(set(children)) == len(children)
    for joint, link in zip(joints, ours(robot).links, strict=True):
        limit = {name: float(value) for name, value in joint.find("limit").items()}
        assert [limit["lower"], limit["upper"]] == link["range"]
        muscles, width = link["muscles"], link["range"][1] - link["range"][0]
        assert limit["effort"] >= max(muscles["kp"] * width, muscles["torque_max"])
        assert limit["velocity"] == pytest.approx(limit["effort"] / muscles["kd"])
        assert float(joint.find("dynamics").get("damping")) == muscles["kd"]
    for link in root.iter("link"):
        seen, touched = (
            [(shape.tag, shape.attrib) for shape in link.findall(f"{kind}/geometry/*")]
            for kind in ("visual", "collision")
        )
        assert seen == touched


def test_the_case_is_the_environments():
    options = {"object": (0.05, 0.25), "diameter": 0.05, "obstacle": (-0.1, 0.3, 0.02)}
    model = mujoco.MjModel.from_xml_string(export_mjcf("grasp", seed=3, options=options))
    env = BabbleGraspEnv()
    env.reset(seed=3, options=options)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    mujoco.mj_forward(model, data)
    assert data.joint("shoulder").qpos[0] == env.scenario["start"][0]
    assert data.joint("elbow").qpos[0] == env.scenario["start"][1]
    assert not data.qpos[2 : model.nu].any()
    assert data.ctrl.tolist() == data.qpos[: model.nu].tolist()
    assert data.geom("object").xpos.tolist() == [0.05, 0.25, 0]
    assert model.geom("object").size[0] == 0.025
    # 500 kg/m³
    mass = 500 * 4 / 3 * np.pi * 0.025**3
    assert model.body("object").mass[0] == pytest.approx(mass)
    assert model.body("object").inertia == pytest.approx([0.4 * mass * 0.025**2] * 3)
    # 0.5 1/s and 20 1/s
    motion = [model.joint(f"object_{axis}").damping[0] for axis in "xyz"]
    assert motion == pytest.approx([0.5 * mass] * 3)
    moment = 0.4 * mass * 0.025**2
    assert model.joint("object_rotation").damping == pytest.approx([20 * moment] * 3)
    assert data.geom("support").xpos.tolist() == [0, 0, -0.025]
    assert data.geom("obstacle").xpos.tolist() == [-0.1, 0.3, 0]
    assert model.geom("obstacle").size[:2].tolist() == [0.02, 0.06]


def test_reachings_case_is_the_environments():
    env = BabbleReachEnv(config="icub")
    env.reset(seed=5)
    model = mujoco.MjModel.from_xml_string(export_mjcf("reach", config="icub", seed=5))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    start = _core.place(env.interface.task, tuple(data.qpos))[1]
    assert start == pytest.approx(env.scenario["start"], abs=1e-12)
    assert data.site("target").xpos.tolist() == [*env.scenario["target"], 0]
    x, y, radius = env.scenario["obstacle"]
    assert data.geom("obstacle").xpos.tolist() == [x, y, 0]
    assert model.geom("obstacle").size[0] == radius


def test_only_what_touches_here_touches_there():
    friction = {"friction": 0.7, "support_friction": 0.4}
    model = mujoco.MjModel.from_xml_string(
        export_mjcf(
            "grasp", config={"body": {"object": friction}}, options={"obstacle": (-0.1, 0.3, 0.02)}
        )
    )
    # Of two frictions MuJoCo takes the larger, or that of the higher priority.
    support = model.geom("support")
    assert (support.friction[0], support.priority[0]) == (0.4, 1)
    others = [i for i in range(model.ngeom) if i != support.id]
    assert set(model.geom_friction[others, 0]) == {0.7}
    assert not model.geom_priority[others].any()
    names = [model.geom(i).name for i in range(model.ngeom)]
    kinds = [name if name in ("object", "support", "obstacle") else "robot" for name in names]
    touching = set()
    for i in range(model.ngeom):
        for j in range(i):
            if (
                model.geom_contype[i] & model.geom_conaffinity[j]
                or model.geom_contype[j] & model.geom_conaffinity[i]
            ):
                touching.add(frozenset((kinds[i], kinds[j])))
    pairs = [("robot", "object"), ("robot", "obstacle"), ("object", "obstacle")]
    assert touching == {frozenset(pair) for pair in [*pairs, ("object", "support")]}


@settings(max_examples=20)
@given(timestep=st.floats(1e-4, 0.05))
def test_armature_and_contacts_go_with_the_step(timestep):
    model = mujoco.MjModel.from_xml_string(export_mjcf("reach", timestep=timestep))
    assert model.opt.timestep == timestep
    assert model.dof_armature == pytest.approx(40 * timestep)
    assert model.geom_solref[:, 0] == pytest.approx(2 * timestep)
