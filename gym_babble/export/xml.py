"""Shared by both formats: the environment of a task, attributes of links, and XML."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from typing import TYPE_CHECKING, Any

from gym_babble._core import __version__
from gym_babble.envs import BabbleEnv
from gym_babble.envs.registry import task_entry

if TYPE_CHECKING:
    from gym_babble.config import Config, ConfigLike

__all__ = [
    "COLOURS",
    "add_comment",
    "attribute",
    "axis",
    "colour",
    "colour_name",
    "document",
    "make_env",
]

COLOURS = {
    "sleeve": "0.36 0.53 0.7 1",
    "skin": "0.89 0.72 0.59 1",
    "object": "0.85 0.15 0.12 1",
    "target": "0.85 0.15 0.12 0.5",
    "obstacle": "0.38 0.42 0.47 1",
    "support": "0.77 0.77 0.74 1",
}
"""Red, green, blue and opacity, each in [0, 1]."""


def make_env(task: str, config: ConfigLike) -> Any:
    """The environment of a task; raises `ConfigError` for an unknown one."""
    return BabbleEnv(task=task_entry(task).name, config=config)


def axis(link: dict[str, Any]) -> str:
    """The axis of a link's joint: the vertical, up or down."""
    return "0 0 -1" if link["clockwise"] else "0 0 1"


def colour_name(link: dict[str, Any]) -> str:
    """The key of `COLOURS` for a link: the upper arm wears a sleeve."""
    return "sleeve" if link["parent"] is None else "skin"


def colour(link: dict[str, Any]) -> str:
    """The colour of a link."""
    return COLOURS[colour_name(link)]


def add_comment(root: ET.Element, task: str, config: Config) -> None:
    """Adds a comment with the version, the task and the config's profile."""
    root.append(ET.Comment(f" gym-babble {__version__}, task {task}, profile {config.profile} "))


def attribute(*numbers: float) -> str:
    """Numbers as an XML attribute. They keep every bit, except that −0 becomes 0."""
    return " ".join(f"{float(number) + 0.0!r}" for number in numbers)


def document(root: ET.Element) -> str:
    """The XML document as text."""
    ET.indent(root)
    return ET.tostring(root, encoding="unicode") + "\n"
