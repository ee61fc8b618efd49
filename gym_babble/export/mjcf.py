"""Robot and case as MJCF, MuJoCo's format."""

from __future__ import annotations

import json
import math
import xml.etree.ElementTree as ET
from typing import TYPE_CHECKING, Any

from gym_babble import _core
from gym_babble.checks import check_number, check_seed
from gym_babble.config import Config
from gym_babble.errors import ConfigError
from gym_babble.export.xml import COLOURS, add_comment, attribute, axis, colour, document, make_env

if TYPE_CHECKING:
    from collections.abc import Mapping

    from gym_babble.config import ConfigLike, GraspConfig, ReachConfig

__all__ = ["export_mjcf"]

# Bits of contype and conaffinity. Arm and hand touch neither themselves nor the support.
ROBOT, OBJECT = 1, 2

CONTACT_PATCH_M = 0.0025
"""Ratio of MuJoCo's torsional to its sliding friction: about the radius of the contact area."""


def export_mjcf(
    task: str = "grasp",
    *,
    config: ConfigLike = "paper",
    seed: int = 0,
    options: Mapping[str, Any] | None = None,
    timestep: float | None = None,
) -> str:
    """Robot and case as MJCF, MuJoCo's format.

    Links, masses, inertias, joints, muscles (a position actuator for each joint) and the object
    equal the environment's. Contacts are MuJoCo's; docs/export.md lists the differences. The
    keyframe "start" is the start of the case, at rest.

    Args:
        task: "reach": upper arm, and forearm with its rigid hand; the target is a site. "grasp": a
            moving hand, the object, and a support that touches only the object.
        config: Body and task, as for the environments.
        seed: The case is the one that `reset(seed=seed, options=options)` gives.
        options: Options of `reset`, for a case of your own.
        timestep: MuJoCo's step [s]; the environment's by default. It also sets the joints' armature
            and the contacts' stiffness.

    Raises:
        ConfigError: An unknown name or option, or a number out of bounds.
        ScenarioError: The case cannot be played.
    """
    env = make_env(task, config)
    env.reset(seed=check_seed(seed), options=options)
    core, case = env.interface.task, env.scenario
    whole = Config.from_json(core.config())
    links = json.loads(core.robot())
    dt = _timestep(timestep, whole.reach if task == "reach" else whole.grasp)

    root = ET.Element("mujoco", model=f"babble_{task}")
    add_comment(root, task, whole)
    ET.SubElement(root, "compiler", angle="radian")
    solver = {"integrator": "implicitfast", "cone": "elliptic", "impratio": "10"}
    ET.SubElement(root, "option", solver, timestep=attribute(dt))
    _add_defaults(root, whole, dt)
    world = ET.SubElement(root, "worldbody")
    ET.SubElement(world, "light", pos="0 0 1", dir="0 0 -1")
    _add_links(world, links, dt)
    _add_case(world, whole, case)
    _add_muscles(root, links)
    arm: Any = case["start"]
    if task == "reach":
        arm = _core.posture_at(core, arm)
    _add_start(root, [*arm, *(link["range"][0] for link in links[2:])], has_object=task == "grasp")
    return document(root)


def _timestep(given: object, numbers: ReachConfig | GraspConfig) -> float:
    longest = numbers.control_period_s
    if given is None:
        return longest / numbers.physics_steps
    dt = check_number("timestep", given, 0.0, longest, "s")
    if dt == 0:
        raise ConfigError("timestep = 0 is not above 0 s")
    return dt


def _add_defaults(root: ET.Element, config: Config, dt: float) -> None:
    thing = config.body.object
    defaults = ET.SubElement(root, "default")
    # The hardest contact that MuJoCo allows at this step, with torsional friction.
    ET.SubElement(defaults, "geom", solref=attribute(2 * dt, 1), condim="4")
    # Class, its own bits, bits of what touches it, friction, priority (1: its friction decides).
    for name, is_a, touched_by, friction, priority in (
        ("robot", ROBOT, 0, thing.friction, 0),
        ("object", OBJECT, ROBOT, thing.friction, 0),
        ("obstacle", 0, ROBOT | OBJECT, thing.friction, 0),
        ("support", 0, OBJECT, thing.support_friction, 1),
    ):
        of_class = ET.SubElement(defaults, "default", {"class": name})
        ET.SubElement(
            of_class,
            "geom",
            contype=str(is_a),
            conaffinity=str(touched_by),
            friction=attribute(friction, CONTACT_PATCH_M * friction, 0),
            priority=str(priority),
        )


def _add_links(world: ET.Element, links: list[dict[str, Any]], dt: float) -> None:
    bodies: list[ET.Element] = []
    for link in links:
        parent = world if link["parent"] is None else bodies[link["parent"]]
        half = link["direction"] / 2
        body = ET.SubElement(
            parent,
            "body",
            name=link["name"],
            pos=attribute(*link["origin"]),
            quat=attribute(math.cos(half), 0, 0, math.sin(half)),
            gravcomp="1",
        )
        bodies.append(body)
        xx, xy, xz, _, yy, yz, _, _, zz = link["inertia"]
        ET.SubElement(
            body,
            "inertial",
            pos=attribute(*link["centre"]),
            mass=attribute(link["mass"]),
            fullinertia=attribute(xx, yy, zz, xy, xz, yz),
        )
        ET.SubElement(
            body,
            "joint",
            name=link["joint"],
            axis=axis(link),
            range=attribute(*link["range"]),
            limited="true" if link["stops"] else "false",
            # MuJoCo's contacts ignore the damping of muscles, which limits motion within a step.
            # Without armature they would eject what light fingers press.
            armature=attribute(dt * link["muscles"]["kd"]),
        )
        for solid in link["solids"]:
            geom = {"class": "robot", "name": solid["name"], "rgba": colour(link)}
            ET.SubElement(body, "geom", geom | _mjcf_shape(solid))


def _mjcf_shape(solid: dict[str, Any]) -> dict[str, str]:
    if solid["shape"] == "capsule":
        ends = attribute(*solid["a"], *solid["b"])
        return {"type": "capsule", "fromto": ends, "size": attribute(solid["radius"])}
    return {"type": "box", "pos": attribute(*solid["centre"]), "size": attribute(*solid["half"])}


def _add_case(world: ET.Element, config: Config, case: dict[str, Any]) -> None:
    if "target" in case:
        _add_target(world, config, case["target"])
    else:
        _add_object(world, config, case)
    if case["obstacle"] is not None:
        _add_obstacle(world, config, case["obstacle"])


def _add_target(world: ET.Element, config: Config, target: tuple[float, float]) -> None:
    size = attribute(config.body.target.radius_m)
    place = attribute(*target, 0)
    ET.SubElement(world, "site", name="target", pos=place, size=size, rgba=COLOURS["target"])


def _add_object(world: ET.Element, config: Config, case: dict[str, Any]) -> None:
    thing, radius = config.body.object, case["diameter"] / 2
    mass = thing.density_kg_m3 * 4 / 3 * math.pi * radius**3
    moment = 0.4 * mass * radius**2
    body = ET.SubElement(world, "body", name="object", pos=attribute(*case["object"], 0))
    # A free joint would have the same damping for motion and rotation.
    for name, along in (("x", "1 0 0"), ("y", "0 1 0"), ("z", "0 0 1")):
        damping = attribute(mass * thing.linear_damping)
        ET.SubElement(
            body, "joint", name=f"object_{name}", type="slide", axis=along, damping=damping
        )
    damping = attribute(moment * thing.angular_damping)
    ET.SubElement(body, "joint", name="object_rotation", type="ball", damping=damping)
    shape = {"type": "sphere", "size": attribute(radius), "mass": attribute(mass)}
    geom = {"class": "object", "name": "object", "rgba": COLOURS["object"]}
    ET.SubElement(body, "geom", geom | shape)
    plane = {"type": "plane", "pos": attribute(0, 0, -radius), "size": "0.6 0.6 0.1"}
    geom = {"class": "support", "name": "support", "rgba": COLOURS["support"]}
    ET.SubElement(world, "geom", geom | plane)


def _add_obstacle(world: ET.Element, config: Config, obstacle: tuple[float, float, float]) -> None:
    x, y, radius = obstacle
    size = attribute(radius, config.body.obstacle.height_m / 2)
    geom = {"class": "obstacle", "name": "obstacle", "rgba": COLOURS["obstacle"]}
    ET.SubElement(
        world, "geom", geom | {"type": "cylinder", "pos": attribute(x, y, 0), "size": size}
    )


def _add_muscles(root: ET.Element, links: list[dict[str, Any]]) -> None:
    """Adds the muscles of Eq. 2, with the equilibrium point as control [rad]."""
    actuators = ET.SubElement(root, "actuator")
    for link in links:
        ET.SubElement(
            actuators,
            "position",
            name=link["joint"],
            joint=link["joint"],
            kp=attribute(link["muscles"]["kp"]),
            kv=attribute(link["muscles"]["kd"]),
            ctrlrange=attribute(*link["range"]),
        )


def _add_start(root: ET.Element, posture: list[float], *, has_object: bool) -> None:
    """Adds the posture at rest; the object is where its body is, and not turned."""
    keys = ET.SubElement(root, "keyframe")
    unmoved = [0, 0, 0, 1, 0, 0, 0] if has_object else []
    ET.SubElement(
        keys, "key", name="start", qpos=attribute(*posture, *unmoved), ctrl=attribute(*posture)
    )
