"""The robot of a config, and a case's things, as MJCF or URDF for other simulators."""

from __future__ import annotations

import json
import math
import xml.etree.ElementTree as ET
from typing import TYPE_CHECKING, Any

from gym_babble._core import __version__
from gym_babble.config import Config, ConfigLike
from gym_babble.envs import BabbleGraspEnv, BabbleReachEnv
from gym_babble.errors import ConfigError

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = ["export_mjcf", "export_urdf"]

ENVS = {"reach": BabbleReachEnv, "grasp": BabbleGraspEnv}

# Bits of contype and conaffinity: arm and hand touch neither themselves nor the support.
ROBOT, OBJECT = 1, 2

CONTACT_PATCH_M = 0.0025
"""MuJoCo's torsional over its sliding friction: about the radius of where ball and finger touch."""

COLOURS = {
    "sleeve": "0.36 0.53 0.7 1",
    "skin": "0.89 0.72 0.59 1",
    "object": "0.85 0.15 0.12 1",
    "target": "0.85 0.15 0.12 0.5",
    "obstacle": "0.38 0.42 0.47 1",
    "support": "0.77 0.77 0.74 1",
}


def export_mjcf(
    task: str = "grasp",
    *,
    config: ConfigLike = "paper",
    seed: int = 0,
    options: Mapping[str, Any] | None = None,
    timestep: float | None = None,
) -> str:
    """Robot and case as MJCF, MuJoCo's format.

    Links, masses, inertias, joints, muscles (a position actuator for each joint) and the object are
    the environment's, contacts are MuJoCo's: docs/export.md says what differs. The keyframe "start"
    is the case's start, at rest.

    Args:
        task: "reach": upper arm, and forearm with its rigid hand; the target is a site. "grasp": a
            hand that moves, the object, and a support that carries nothing else.
        config: Body and task, as for the environments.
        seed: The case is the one that `reset(seed=seed, options=options)` gives.
        options: What `reset` takes, for a case of your own.
        timestep: MuJoCo's step [s]; the environment's own if not given. The joints' armature and
            the contacts' stiffness go with it.

    Raises:
        ConfigError: A name, number or option is not one there is.
        ScenarioError: The case cannot be played.
    """
    env = _env(task, config)
    env.reset(seed=seed, options=None if options is None else dict(options))
    core, case = env.choices.task, env.scenario
    whole = Config.from_json(core.config())
    links = json.loads(core.robot())
    dt = _timestep(timestep, whole.reach if task == "reach" else whole.grasp)

    root = ET.Element("mujoco", model=f"babble_{task}")
    _add_comment(root, task, whole)
    ET.SubElement(root, "compiler", angle="radian")
    solver = {"integrator": "implicitfast", "cone": "elliptic", "impratio": "10"}
    ET.SubElement(root, "option", solver, timestep=_text(dt))
    _add_defaults(root, whole, dt)
    world = ET.SubElement(root, "worldbody")
    ET.SubElement(world, "light", pos="0 0 1", dir="0 0 -1")
    _add_links(world, links, dt)
    if task == "reach":
        radius = _text(whole.body.target.radius_m)
        at = _text(*case["target"], 0)
        ET.SubElement(world, "site", name="target", pos=at, size=radius, rgba=COLOURS["target"])
    else:
        _add_object(world, whole, case)
    if case["obstacle"] is not None:
        _add_obstacle(world, whole, case["obstacle"])
    _add_muscles(root, links)
    arm = core.posture_at(case["start"]) if task == "reach" else case["start"]
    _add_start(root, [*arm, *(link["range"][0] for link in links[2:])], has_object=task == "grasp")
    return _document(root)


def export_urdf(task: str = "grasp", *, config: ConfigLike = "paper") -> str:
    """The robot as URDF, for ROS and other simulators.

    A capsule is a cylinder and two spheres. URDF knows joint damping but no springs, and no things
    around the robot: muscles' stiffness, object, support and obstacle are left out.

    Args:
        task: "reach" or "grasp", as for `export_mjcf`.
        config: Body and task, as for the environments.

    Raises:
        ConfigError: A name or number is not one there is.
    """
    core = _env(task, config).choices.task
    root = ET.Element("robot", name=f"babble_{task}")
    _add_comment(root, task, Config.from_json(core.config()))
    ET.SubElement(root, "link", name="base")
    links = json.loads(core.robot())
    for link in links:
        _add_urdf_link(root, link)
    for link in links:
        parent = "base" if link["parent"] is None else links[link["parent"]]["name"]
        _add_urdf_joint(root, link, parent)
    return _document(root)


def _env(task: str, config: ConfigLike) -> Any:
    if task not in ENVS:
        raise ConfigError(f"task = {task!r} is not one of {', '.join(ENVS)}")
    return ENVS[task](config=config)


def _timestep(given: Any, numbers: Any) -> float:
    longest: float = numbers.control_period_s
    if given is None:
        return longest / float(numbers.physics_steps)
    if not isinstance(given, int | float) or not 0 < given <= longest:
        raise ConfigError(f"timestep = {given!r} is not a number above 0 and at most {longest} s")
    return given


def _add_defaults(root: ET.Element, config: Config, dt: float) -> None:
    thing = config.body.object
    defaults = ET.SubElement(root, "default")
    # The hardest contact that MuJoCo allows at this step, with torsional friction.
    ET.SubElement(defaults, "geom", solref=_text(2 * dt, 1), condim="4")
    # Class, what it is, what touches it, friction, whether its friction counts alone.
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
            friction=_text(friction, CONTACT_PATCH_M * friction, 0),
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
            pos=_text(*link["origin"]),
            quat=_text(math.cos(half), 0, 0, math.sin(half)),
            gravcomp="1",
        )
        bodies.append(body)
        xx, xy, xz, _, yy, yz, _, _, zz = link["inertia"]
        ET.SubElement(
            body,
            "inertial",
            pos=_text(*link["centre"]),
            mass=_text(link["mass"]),
            fullinertia=_text(xx, yy, zz, xy, xz, yz),
        )
        ET.SubElement(
            body,
            "joint",
            name=link["joint"],
            axis=_axis(link),
            range=_text(*link["range"]),
            limited="true" if link["stops"] else "false",
            # MuJoCo's contacts do not feel the damping of muscles, which is nearly all that a step
            # of this length moves: they would eject what light fingers press.
            armature=_text(dt * link["muscles"]["kd"]),
        )
        for solid in link["solids"]:
            geom = {"class": "robot", "name": solid["name"], "rgba": _colour(link)}
            ET.SubElement(body, "geom", geom | _mjcf_shape(solid))


def _mjcf_shape(solid: dict[str, Any]) -> dict[str, str]:
    if solid["shape"] == "capsule":
        ends = _text(*solid["a"], *solid["b"])
        return {"type": "capsule", "fromto": ends, "size": _text(solid["radius"])}
    return {"type": "box", "pos": _text(*solid["centre"]), "size": _text(*solid["half"])}


def _add_object(world: ET.Element, config: Config, case: dict[str, Any]) -> None:
    thing, radius = config.body.object, case["diameter"] / 2
    mass = thing.density_kg_m3 * 4 / 3 * math.pi * radius**3
    moment = 0.4 * mass * radius**2
    body = ET.SubElement(world, "body", name="object", pos=_text(*case["object"], 0))
    # Not a free joint: that has one damping for motion and rotation.
    for axis, along in (("x", "1 0 0"), ("y", "0 1 0"), ("z", "0 0 1")):
        damping = _text(mass * thing.linear_damping)
        name = f"object_{axis}"
        ET.SubElement(body, "joint", name=name, type="slide", axis=along, damping=damping)
    damping = _text(moment * thing.angular_damping)
    ET.SubElement(body, "joint", name="object_rotation", type="ball", damping=damping)
    shape = {"type": "sphere", "size": _text(radius), "mass": _text(mass)}
    geom = {"class": "object", "name": "object", "rgba": COLOURS["object"]}
    ET.SubElement(body, "geom", geom | shape)
    plane = {"type": "plane", "pos": _text(0, 0, -radius), "size": "0.6 0.6 0.1"}
    geom = {"class": "support", "name": "support", "rgba": COLOURS["support"]}
    ET.SubElement(world, "geom", geom | plane)


def _add_obstacle(world: ET.Element, config: Config, obstacle: tuple[float, float, float]) -> None:
    x, y, radius = obstacle
    size = _text(radius, config.body.obstacle.height_m / 2)
    geom = {"class": "obstacle", "name": "obstacle", "rgba": COLOURS["obstacle"]}
    ET.SubElement(world, "geom", geom | {"type": "cylinder", "pos": _text(x, y, 0), "size": size})


def _add_muscles(root: ET.Element, links: list[dict[str, Any]]) -> None:
    """Eq. 2, with the equilibrium point as control [rad]."""
    actuators = ET.SubElement(root, "actuator")
    for link in links:
        ET.SubElement(
            actuators,
            "position",
            name=link["joint"],
            joint=link["joint"],
            kp=_text(link["muscles"]["kp"]),
            kv=_text(link["muscles"]["kd"]),
            ctrlrange=_text(*link["range"]),
        )


def _add_start(root: ET.Element, posture: list[float], *, has_object: bool) -> None:
    """The posture at rest; the object is where its body is, and not turned."""
    keys = ET.SubElement(root, "keyframe")
    unmoved = [0, 0, 0, 1, 0, 0, 0] if has_object else []
    ET.SubElement(keys, "key", name="start", qpos=_text(*posture, *unmoved), ctrl=_text(*posture))


def _add_urdf_link(root: ET.Element, link: dict[str, Any]) -> None:
    element = ET.SubElement(root, "link", name=link["name"])
    inertial = ET.SubElement(element, "inertial")
    ET.SubElement(inertial, "origin", xyz=_text(*link["centre"]), rpy="0 0 0")
    ET.SubElement(inertial, "mass", value=_text(link["mass"]))
    xx, xy, xz, _, yy, yz, _, _, zz = map(_text, link["inertia"])
    ET.SubElement(inertial, "inertia", ixx=xx, ixy=xy, ixz=xz, iyy=yy, iyz=yz, izz=zz)
    for solid in link["solids"]:
        for name, xyz, rpy, shape, size in _urdf_shapes(solid):
            for kind in ("visual", "collision"):
                piece = ET.SubElement(element, kind, name=name)
                ET.SubElement(piece, "origin", xyz=xyz, rpy=rpy)
                ET.SubElement(ET.SubElement(piece, "geometry"), shape, size)
                if kind == "visual":
                    colour = ET.SubElement(piece, "material", name=_colour_name(link))
                    ET.SubElement(colour, "color", rgba=_colour(link))


def _urdf_shapes(solid: dict[str, Any]) -> list[tuple[str, str, str, str, dict[str, str]]]:
    """Name, xyz, rpy, shape and size of what URDF makes a solid of."""
    name = solid["name"]
    if solid["shape"] == "cuboid":
        size = _text(*(2 * half for half in solid["half"]))
        return [(name, _text(*solid["centre"]), "0 0 0", "box", {"size": size})]
    a, b, radius = solid["a"], solid["b"], _text(solid["radius"])
    x, y, z = (end - start for start, end in zip(a, b, strict=True))
    # Cylinders lie along z.
    turn = _text(0, math.atan2(math.hypot(x, y), z), math.atan2(y, x))
    middle = _text(*((start + end) / 2 for start, end in zip(a, b, strict=True)))
    cylinder = {"radius": radius, "length": _text(math.hypot(x, y, z))}
    return [
        (name, middle, turn, "cylinder", cylinder),
        (f"{name}_near", _text(*a), "0 0 0", "sphere", {"radius": radius}),
        (f"{name}_far", _text(*b), "0 0 0", "sphere", {"radius": radius}),
    ]


def _add_urdf_joint(root: ET.Element, link: dict[str, Any], parent: str) -> None:
    muscles, (low, high) = link["muscles"], link["range"]
    # URDF wants both: the most that these muscles pull, and the speed at which that is damped away.
    effort = max(muscles["kp"] * (high - low), muscles["torque_max"])
    joint = ET.SubElement(root, "joint", name=link["joint"], type="revolute")
    ET.SubElement(joint, "parent", link=parent)
    ET.SubElement(joint, "child", link=link["name"])
    ET.SubElement(joint, "origin", xyz=_text(*link["origin"]), rpy=_text(0, 0, link["direction"]))
    ET.SubElement(joint, "axis", xyz=_axis(link))
    ET.SubElement(
        joint,
        "limit",
        lower=_text(low),
        upper=_text(high),
        effort=_text(effort),
        velocity=_text(effort / muscles["kd"]),
    )
    ET.SubElement(joint, "dynamics", damping=_text(muscles["kd"]), friction="0")


def _axis(link: dict[str, Any]) -> str:
    return "0 0 -1" if link["clockwise"] else "0 0 1"


def _colour_name(link: dict[str, Any]) -> str:
    return "sleeve" if link["parent"] is None else "skin"


def _colour(link: dict[str, Any]) -> str:
    return COLOURS[_colour_name(link)]


def _add_comment(root: ET.Element, task: str, config: Config) -> None:
    root.append(ET.Comment(f" gym-babble {__version__}, task {task}, profile {config.profile} "))


def _text(*numbers: float) -> str:
    """Numbers as XML attributes have them; every bit comes back. No minus before a zero."""
    return " ".join(f"{float(number) + 0.0!r}" for number in numbers)


def _document(root: ET.Element) -> str:
    ET.indent(root)
    return ET.tostring(root, encoding="unicode") + "\n"
