"""What other programs read: the robot as MJCF with the objects of a case, or URDF; networks."""

from gym_babble.export.mjcf import export_mjcf
from gym_babble.export.policy import export_policy
from gym_babble.export.urdf import export_urdf

__all__ = ["export_mjcf", "export_policy", "export_urdf"]
