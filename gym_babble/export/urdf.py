"""The robot as URDF, for ROS and other simulators."""

from __future__ import annotations

import json
import math
import xml.etree.ElementTree as ET
from typing import TYPE_CHECKING, Any

from gym_babble.config import Config
from gym_babble.export.xml import (
    add_comment,
    attribute,
    axis,
    colour,
    colour_name,
    document,
    make_env,
)

if TYPE_CHECKING:
    from gym_babble.config import ConfigLike

__all__ = ["export_urdf"]


def export_urdf(task: str = "grasp", *, config: ConfigLike = "paper") -> str:
    """The robot as URDF, for ROS and other simulators.

    A capsule becomes a cylinder and two spheres. URDF has joint damping but no springs, and it
    describes the robot only: it omits the muscles' stiffness, object, support and obstacle.

    Args:
        task: "reach" or "grasp", as for `export_mjcf`.
        config: Body and task, as for the environments.

    Raises:
        ConfigError: An unknown name, or a number out of bounds.
    """
    core = make_env(task, config).interface.task
    root = ET.Element("robot", name=f"babble_{task}")
    add_comment(root, task, Config.from_json(core.config()))
    ET.SubElement(root, "link", name="base")
    links = json.loads(core.robot())
    for link in links:
        _add_urdf_link(root, link)
    for link in links:
        parent = "base" if link["parent"] is None else links[link["parent"]]["name"]
        _add_urdf_joint(root, link, parent)
    return document(root)


def _add_urdf_link(root: ET.Element, link: dict[str, Any]) -> None:
    element = ET.SubElement(root, "link", name=link["name"])
    inertial = ET.SubElement(element, "inertial")
    ET.SubElement(inertial, "origin", xyz=attribute(*link["centre"]), rpy="0 0 0")
    ET.SubElement(inertial, "mass", value=attribute(link["mass"]))
    xx, xy, xz, _, yy, yz, _, _, zz = map(attribute, link["inertia"])
    ET.SubElement(inertial, "inertia", ixx=xx, ixy=xy, ixz=xz, iyy=yy, iyz=yz, izz=zz)
    for solid in link["solids"]:
        for name, xyz, rpy, shape, size in _urdf_shapes(solid):
            for kind in ("visual", "collision"):
                piece = ET.SubElement(element, kind, name=name)
                ET.SubElement(piece, "origin", xyz=xyz, rpy=rpy)
                ET.SubElement(ET.SubElement(piece, "geometry"), shape, size)
                if kind == "visual":
                    material = ET.SubElement(piece, "material", name=colour_name(link))
                    ET.SubElement(material, "color", rgba=colour(link))


def _urdf_shapes(solid: dict[str, Any]) -> list[tuple[str, str, str, str, dict[str, str]]]:
    """Name, xyz, rpy, shape and size of the URDF shapes that form a solid."""
    name = solid["name"]
    if solid["shape"] == "cuboid":
        size = attribute(*(2 * half for half in solid["half"]))
        return [(name, attribute(*solid["centre"]), "0 0 0", "box", {"size": size})]
    a, b, radius = solid["a"], solid["b"], attribute(solid["radius"])
    x, y, z = (end - start for start, end in zip(a, b, strict=True))
    # Cylinders lie along z.
    turn = attribute(0, math.atan2(math.hypot(x, y), z), math.atan2(y, x))
    middle = attribute(*((start + end) / 2 for start, end in zip(a, b, strict=True)))
    cylinder = {"radius": radius, "length": attribute(math.hypot(x, y, z))}
    return [
        (name, middle, turn, "cylinder", cylinder),
        (f"{name}_near", attribute(*a), "0 0 0", "sphere", {"radius": radius}),
        (f"{name}_far", attribute(*b), "0 0 0", "sphere", {"radius": radius}),
    ]


def _add_urdf_joint(root: ET.Element, link: dict[str, Any], parent: str) -> None:
    muscles, (low, high) = link["muscles"], link["range"]
    # URDF requires both: the largest torque of these muscles, and the speed at which damping
    # cancels it.
    effort = max(muscles["kp"] * (high - low), muscles["torque_max"])
    joint = ET.SubElement(root, "joint", name=link["joint"], type="revolute")
    ET.SubElement(joint, "parent", link=parent)
    ET.SubElement(joint, "child", link=link["name"])
    ET.SubElement(
        joint, "origin", xyz=attribute(*link["origin"]), rpy=attribute(0, 0, link["direction"])
    )
    ET.SubElement(joint, "axis", xyz=axis(link))
    ET.SubElement(
        joint,
        "limit",
        lower=attribute(low),
        upper=attribute(high),
        effort=attribute(effort),
        velocity=attribute(effort / muscles["kd"]),
    )
    ET.SubElement(joint, "dynamics", damping=attribute(muscles["kd"]), friction="0")
