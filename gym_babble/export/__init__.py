"""The robot of a config for other simulators: MJCF with the objects of a case, URDF without."""

from gym_babble.export.mjcf import export_mjcf
from gym_babble.export.urdf import export_urdf

__all__ = ["export_mjcf", "export_urdf"]
