"""The robot of a config for other simulators, MJCF with the objects of a case and URDF without; networks of
models of stable-baselines3, to act without PyTorch."""

from gym_babble.export.mjcf import export_mjcf
from gym_babble.export.policy import export_policy
from gym_babble.export.urdf import export_urdf

__all__ = ["export_mjcf", "export_policy", "export_urdf"]
