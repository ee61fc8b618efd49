"""The environments' physics against MuJoCo's, which has the same robot from the exporter."""

from __future__ import annotations

import json

import numpy as np
import pytest
from planar import Ours, turned

from gym_babble import _core, export_mjcf
from gym_babble.envs import BabbleGraspEnv, BabbleReachEnv
from gym_babble.envs.interface import outcome_of

mujoco = pytest.importorskip("mujoco", reason="MuJoCo has no wheel for this platform")

CONTROL_S = 0.05
HEAVY = {
    # Weak muscles on a heavy arm swing: inertia, its coupling and the Coriolis torque decide.
    "reach": {"arm": {"density_kg_m3": 2e4}, "muscles": {"kp": 2, "kd": 0.6}},
    "grasp": {
        "arm": {"density_kg_m3": 2e4},
        "grip": {
            "arm_muscles": {"kp": 2, "kd": 0.6},
            "hand_muscles": {"kp": 0.1, "kd": 0.03},
        },
    },
}


class Pair:
    """An environment under `posture` control, and its robot in MuJoCo, from the same start."""

    def __init__(self, task, config, options, timestep=None):
        given = {"control": "posture", "config": config, "max_episode_steps": 10_000}
        if task == "reach":
            # In the goal form success ends nothing.
            self.env = BabbleReachEnv(obs="goal", reward="sparse", **given)
        else:
            self.env = BabbleGraspEnv(obs="flat", **given)
        self.observation, _ = self.env.reset(seed=0, options=options)
        text = export_mjcf(task, config=config, seed=0, options=options, timestep=timestep)
        self.model = mujoco.MjModel.from_xml_string(text)
        self.data = mujoco.MjData(self.model)
        mujoco.mj_resetDataKeyframe(self.model, self.data, 0)
        muscles = [self.model.actuator(i).name for i in range(self.model.nu)]
        # Which number of an action moves each joint.
        arm = {"shoulder": 0, "elbow": 1}
        self.moved_by = np.array([arm.get(m, 2 if m.startswith("thumb") else 3) for m in muscles])
        width = self.env.action_space.shape[0]
        first = [int(np.argmax(self.moved_by == i)) for i in range(width)]
        self.low, self.high = self.model.actuator_ctrlrange[first].T

    def step(self, action):
        """One control period of both."""
        action = np.asarray(action, np.float32)
        self.observation, _, terminated, _, info = self.env.step(action)
        assert not terminated, info
        # The equilibrium points that the environment makes of the action.
        point = self.low + (0.5 + 0.5 * action.astype(float)) * (self.high - self.low)
        self.data.ctrl[:] = point[self.moved_by]
        mujoco.mj_step(self.model, self.data, round(CONTROL_S / self.model.opt.timestep))

    def sense(self, name):
        at = 0
        for entry in self.env.interface.spec.senses:
            if entry.name == name:
                flat = self.observation
                flat = flat["observation"] if isinstance(flat, dict) else flat
                return flat[at : at + len(entry.labels)].astype(float)
            at += len(entry.labels)
        raise KeyError(name)

    def ours(self):
        """Joint angles [rad]; the mean of a digit's."""
        arm = self.sense("arm")
        share = arm if len(self.low) == 2 else np.concatenate([arm, self.sense("hand")])
        return self.low + share * (self.high - self.low)

    def mujocos(self):
        q = self.data.qpos[: self.model.nu]
        means = [q[self.moved_by == i].mean() for i in range(len(self.low))]
        # The sense ends where the range does.
        return np.clip(means, self.low, self.high)

    def mujocos_touch(self):
        """Normal forces on the object [N] of palm, thumb and fingers."""
        forces, force = {"palm": 0.0, "thumb": 0.0, "fingers": 0.0}, np.zeros(6)
        for i in range(self.data.ncon):
            mujoco.mj_contactForce(self.model, self.data, i, force)
            names = {self.model.geom(geom).name for geom in self.data.contact[i].geom}
            if "support" not in names:
                part = (names - {"object"}).pop().partition("_")[0]
                forces[part if part in forces else "fingers"] += force[0]
        return np.array(list(forces.values()))


def difference(task, body, steps, width):
    """Ours less MuJoCo's joint angles [rad] over 6 s of random targets.

    They come from the middle `width` of the joint ranges; `steps` of physics make a control period.
    """
    far = {"object": (0.0, -0.28), "start": (0.3, 1.0)} if task == "grasp" else {"obstacle": None}
    pair = Pair(task, {"body": body, task: {"physics_steps": steps}}, far)
    random = np.random.default_rng(0)
    found = []
    for k in range(round(6 / CONTROL_S)):
        if k % 10 == 0:
            target = width * random.uniform(-1, 1, len(pair.low))
        pair.step(target)
        found.append(pair.ours() - pair.mujocos())
    return np.array(found)


@pytest.mark.parametrize("task", ["reach", "grasp"])
@pytest.mark.parametrize(("weight", "width"), [("light", 1.0), ("heavy", 0.4)])
def test_free_motion_is_mujocos(task, weight, width):
    """The difference is the integrators': at most one step's motion, and none is left at no step.

    Catches another mass, inertia, stiffness, damping or Coriolis torque in one of the two: what
    that changes stays when the step shrinks, and Richardson's extrapolation to no step shows it.
    """
    body = HEAVY[task] if weight == "heavy" else {}
    coarse, fine = (difference(task, body, steps, width) for steps in (10, 20))
    worst, left = abs(coarse).max(), abs(2 * fine - coarse).max()
    print(f"{task}, {weight}: {1e3 * worst:.2f} mrad at 5 ms, {1e3 * left:.3f} mrad extrapolated")
    # A target at the other end of the range pulls a joint over it in a time constant.
    fastest = max(
        width * np.ptp(link["range"]) * link["muscles"]["kp"] / link["muscles"]["kd"]
        for link in Ours(task, {"body": body}).links
    )
    assert worst < 0.005 * fastest
    assert left < 0.05 * worst


SMOOTH = {"friction": 0.0, "support_friction": 0.0}


def balance(fingers, timestep):
    """A squeezed ball: forces of palm, thumb and fingers [N], postures [rad], ours and MuJoCo's.

    Without friction, which would remember the way there, one balance is possible.
    """
    config = {
        "body": {"object": SMOOTH, "grip": {"fingers": fingers}},
        # The support stays; the sense of touch goes up to 100 N.
        "grasp": {"hold_steps": 1000, "touch_max_n": 100.0},
    }
    diameter, q1, q2 = 0.04, 0.3, 1.0
    along, across = (np.array([np.cos(q1 + q2 + a), np.sin(q1 + q2 + a)]) for a in (0, np.pi / 2))
    elbow = 0.15 * np.array([np.cos(q1), np.sin(q1)])
    place = elbow + 0.17 * along + (0.01 + diameter / 2 + 0.0055) * across
    options = {"start": (q1, q2), "object": tuple(place), "diameter": diameter}
    pair = Pair("grasp", config, options, timestep)
    squeeze = 2 * (np.array([q1, q2, 1.0, 1.4]) - pair.low) / (pair.high - pair.low) - 1
    for _ in range(round(12 / CONTROL_S)):
        pair.step(squeeze)
    return 100 * pair.sense("touch"), pair.mujocos_touch(), pair.ours(), pair.mujocos()


@pytest.mark.parametrize("fingers", ["virtual", "independent"])
def test_a_squeezed_ball_is_in_mujocos_balance(fingers):
    """Palm, thumb and fingers press as hard as in MuJoCo, where surfaces sink in as deep.

    How deep they sink is each engine's own: in MuJoCo 1.5 mm at steps of 5 ms, 0.2 mm at 1.25 ms.
    Its balances over that depth are a line, on which ours has to be: the thumb's angle says where.
    Catches forces in another unit or of another time, springs of other stiffness, and levers.
    """
    forces, coarse, posture, coarse_posture = balance(fingers, 0.005)
    _, fine, _, fine_posture = balance(fingers, 0.00125)
    deep = (posture - fine_posture)[2] / (coarse_posture - fine_posture)[2]
    print(
        f"{fingers}: {forces} N, MuJoCo {fine} N, and {coarse} N at 5 ms; ours at {deep:.2f} of it"
    )
    assert 0 <= deep < 1
    assert min(forces) > 1
    assert forces == pytest.approx(fine + deep * (coarse - fine), rel=0.01)
    assert posture == pytest.approx(fine_posture + deep * (coarse_posture - fine_posture), abs=2e-3)


def test_a_collision_is_one_in_mujoco():
    # The arm stops at the first touch: MuJoCo's distance there is none, and was some before.
    env, mine, hit = BabbleReachEnv(control="posture"), Ours("reach", "paper"), 0
    for seed in range(12):
        observation, _ = env.reset(seed=seed)
        goal = np.array(_core.posture_at(mine.core, env.scenario["target"]))
        action = (2 * (goal - mine.low) / (mine.high - mine.low) - 1).astype(np.float32)
        ended, info = False, {}
        while not ended:
            observation, _, terminated, truncated, info = env.step(action)
            ended = terminated or truncated
        if outcome_of(info) != "collision":
            continue
        hit += 1
        model = mujoco.MjModel.from_xml_string(export_mjcf("reach", seed=seed))
        data = mujoco.MjData(model)
        data.qpos[:] = mine.posture(observation["arm"].astype(float))
        mujoco.mj_kinematics(model, data)
        obstacle = model.geom("obstacle").id
        names = [solid["name"] for link in mine.links for solid in link["solids"]]
        distances = [
            mujoco.mj_geomDistance(model, data, model.geom(name).id, obstacle, 1.0, None)
            for name in names
        ]
        assert abs(min(distances)) < 5e-6
    assert hit > 3


def held_in_mujoco(diameter, seed):
    """Whether the exported hand keeps a ball through 10 s of arm motion without its support."""
    mine = Ours("grasp", "paper")
    options = {"start": (0.2, 0.8), "object": (0.0, 0.3), "diameter": diameter}
    model = mujoco.MjModel.from_xml_string(export_mjcf("grasp", options=options))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_kinematics(model, data)
    angle, elbow = mine.place(data.qpos[: model.nu])[1]
    # Where a ball lies against the palm, in the forearm's frame.
    palm = np.array([0.17, 0.01 + diameter / 2, 0])
    data.qpos[model.nu : model.nu + 3] = elbow + turned(palm, angle) - data.body("object").xpos
    names = [link["joint"] for link in mine.links[2:]]
    thumb, finger = json.loads(mine.core.quantities())["reflex"]
    data.ctrl[2:] = [thumb if name.startswith("thumb") else finger for name in names]
    mujoco.mj_step(model, data, 400)
    model.geom("support").conaffinity = 0
    random = np.random.default_rng(seed)
    for _ in range(10):
        data.ctrl[:2] = random.uniform(mine.low[:2], mine.high[:2])
        mujoco.mj_step(model, data, 200)
    angle, elbow = mine.place(data.qpos[: model.nu])[1]
    return np.linalg.norm(turned(data.geom("object").xpos - elbow, -angle) - palm) < 0.06


def test_the_exported_hand_holds_a_ball():
    assert held_in_mujoco(0.04, seed=0)


@pytest.mark.slow
@pytest.mark.parametrize("diameter", [0.024, 0.03, 0.04, 0.05, 0.06, 0.07])
def test_the_exported_hand_holds_balls_of_all_sizes(diameter):
    held = sum(held_in_mujoco(diameter, seed) for seed in range(20))
    print(f"{100 * diameter:g} cm: {held} of 20 held in MuJoCo at steps of 5 ms")
    assert held >= 19
