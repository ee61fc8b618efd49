"""MuJoCo's physics step on the grasping robot; imported in MuJoCo's virtual environment.

The robot is this package's export; docs/export.md lists the differences.
rust/babble_env/benches/physics.rs measures the same with this package's engines.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np

if TYPE_CHECKING:
    from bench.clock import Row

TARGETS = {
    "shoulder": (-1.2, 1.2),
    "elbow": (0.1, 1.6),
    "fingers": (0.0, 1.57),
    "thumb": (0.0, 1.57),
}
"""Range of the random equilibrium points [rad]."""
TARGET_S = 0.5
"""Time between two equilibrium points."""
BLOCK_TARGETS = 20
"""Equilibrium points before the motion restarts from the same state: ten seconds."""
CLOSING_S, SETTLING_S = 3.0, 0.5
"""Time for closing the hand, and for holding the object before the clock starts."""
SLIP_M = 0.02
"""Beyond this distance from its place in the hand, an object counts as dropped."""


def physics(
    seconds: float, *, model: str, place: tuple[float, float], reflex: dict[str, float] | None
) -> Row:
    """CPU time of one physics step, of a hand that holds an object or of a free one.

    Args:
        seconds: Duration of the measurement.
        model: The robot, the object and its support as MJCF, the arm straight along x.
        place: Position of the object (x, y) [m].
        reflex: Flexions of fingers and thumb that hold the object [rad]; without
            them the hand moves freely.

    Raises:
        RuntimeError: The object was dropped.
    """
    robot = Twin(model, place)
    if reflex is not None:
        robot.grasp(reflex)
    moving = ["shoulder", "elbow", *(["fingers", "thumb"] if reflex is None else [])]
    start, in_hand = robot.state(), robot.object_in_palm()
    steps, cpu, clock = 0, 0.0, 0.0
    while clock < seconds:
        robot.restore(start)
        for _ in range(BLOCK_TARGETS):
            robot.draw_targets(moving)
            cpu_before, before = time.thread_time(), time.perf_counter()
            steps += robot.step(TARGET_S)
            cpu += time.thread_time() - cpu_before
            clock += time.perf_counter() - before
        if reflex is not None and abs(robot.object_in_palm() - in_hand).max() > SLIP_M:
            raise RuntimeError(f"the object was dropped within {steps} steps")
    return {"cpu_us": 1e6 * cpu / steps, "clock_us": 1e6 * clock / steps}


class Twin:
    """The model and its state."""

    def __init__(self, xml: str, place: tuple[float, float]) -> None:
        self._random = np.random.default_rng(0)
        model: Any = mujoco.MjModel.from_xml_string(xml)
        data: Any = mujoco.MjData(model)
        self._model, self._data = model, data
        self._muscles: dict[str, list[int]] = {name: [] for name in TARGETS}
        for i, (joint, _) in enumerate(model.actuator_trnid):
            name = model.joint(joint).name.split("_")[0]
            self._muscles[name if name in TARGETS else "fingers"].append(i)
        self._object = model.body("object").id
        model.body_pos[self._object, :2] = place
        self._palm = model.jnt_bodyid[model.joint("elbow").id]

    def state(self) -> Any:
        """Everything that a step depends on."""
        kind = mujoco.mjtState.mjSTATE_INTEGRATION
        state = np.empty(mujoco.mj_stateSize(self._model, kind))
        mujoco.mj_getState(self._model, self._data, state, kind)
        return state

    def restore(self, state: Any) -> None:
        """Restores such a state."""
        kind = mujoco.mjtState.mjSTATE_INTEGRATION
        mujoco.mj_setState(self._model, self._data, state, kind)

    def draw_targets(self, muscles: list[str]) -> None:
        """Random equilibrium points."""
        for name in muscles:
            self._data.ctrl[self._muscles[name]] = self._random.uniform(*TARGETS[name])

    def step(self, seconds: float) -> int:
        """Steps for some time and returns the number of steps."""
        steps: int = round(seconds / self._model.opt.timestep)
        mujoco.mj_step(self._model, self._data, nstep=steps)
        return steps

    def grasp(self, reflex: dict[str, float]) -> None:
        """Closes the hand on the object and removes the support."""
        for name, flexion in reflex.items():
            self._data.ctrl[self._muscles[name]] = flexion
        self.step(CLOSING_S)
        self._model.geom("support").conaffinity = 0
        self.step(SETTLING_S)

    def object_in_palm(self) -> Any:
        """Place of the object in the frame of forearm and palm [m]."""
        data = self._data
        mujoco.mj_forward(self._model, data)
        offset = data.xpos[self._object] - data.xpos[self._palm]
        return data.xmat[self._palm].reshape(3, 3).T @ offset
