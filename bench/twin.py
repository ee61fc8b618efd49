"""MuJoCo's physics step on the robot that grasps; imported under MuJoCo's virtual environment.

The robot is this package's export: docs/export.md says what differs.

rust/babble_env/benches/physics.rs does the same with this package's own.
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
"""Where random equilibrium points are [rad]."""
TARGET_S = 0.5
"""Time between two of them."""
BLOCK_TARGETS = 20
"""Targets until the motion begins anew from the same state: ten seconds."""
CLOSING_S, SETTLING_S = 3.0, 0.5
"""Time that the hand closes on the object, and that it then holds it before the clock starts."""
SLIP_M = 0.02
"""An object further than this from its place in the hand has been dropped."""


def physics(
    seconds: float, *, model: str, place: tuple[float, float], reflex: dict[str, float] | None
) -> Row:
    """CPU time of one physics step, of a hand that holds an object or of a free one.

    Args:
        seconds: How long to measure.
        model: The robot, the object and its support as MJCF, the arm straight along x.
        place: Where the object lies (x, y) [m].
        reflex: Flexions of fingers and thumb that hold the object [rad]; the hand moves freely if
            there are none.

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
        """All that a step depends on."""
        kind = mujoco.mjtState.mjSTATE_INTEGRATION
        state = np.empty(mujoco.mj_stateSize(self._model, kind))
        mujoco.mj_getState(self._model, self._data, state, kind)
        return state

    def restore(self, state: Any) -> None:
        """Continues from there."""
        kind = mujoco.mjtState.mjSTATE_INTEGRATION
        mujoco.mj_setState(self._model, self._data, state, kind)

    def draw_targets(self, muscles: list[str]) -> None:
        """Random equilibrium points."""
        for name in muscles:
            self._data.ctrl[self._muscles[name]] = self._random.uniform(*TARGETS[name])

    def step(self, seconds: float) -> int:
        """Steps for some time; returns the number of steps."""
        steps: int = round(seconds / self._model.opt.timestep)
        mujoco.mj_step(self._model, self._data, nstep=steps)
        return steps

    def grasp(self, reflex: dict[str, float]) -> None:
        """Closes the hand on the object before it and takes the support away."""
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
