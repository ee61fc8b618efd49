"""The rows: measurement, virtual environment, and label in the docs."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from gym_babble import Config, export_mjcf

if TYPE_CHECKING:
    from collections.abc import Iterator

BATCHES = (1, 4, 16, 64, 256, 1024, 4096)
THREADS = (1, 2)
LARGE_BATCHES = BATCHES[-2:]
DIAMETER_M = 0.05
"""Diameter of the object in the physics rows, as in rust/babble_env/benches/physics.rs."""
OURS, RUST, SERVED = "ours", "rust", "served"
"""The project's own virtual environment, its Rust, and the former with the server's program."""


@dataclass(frozen=True)
class Case:
    """One row."""

    name: str
    label: str
    venv: str
    function: str
    """`module:function` of this package; in Rust, the crate and its benchmark."""
    arguments: dict[str, Any] = field(default_factory=dict)
    step_ms: float | None = None
    """Simulated time of a step, if the unit is a step of an environment [ms]."""
    physics_steps: int | None = None
    """Physics steps in one step."""


def peers() -> Iterator[Case]:
    """Other packages, and environments that do nothing."""
    single = "gymnasium.make"
    yield Case("floor", f"does nothing, {single}", "gym", "peers:floor_single")
    yield Case("floor-64", "does nothing, batch of 64", "gym", "peers:floor_batch", {"n": 64})
    for name, title, venv, env_id, package, step_ms, physics_steps in (
        ("reacher", "Gymnasium", "gym", "Reacher-v5", "gymnasium", 20, 2),
        (
            "fetchreach",
            "Gymnasium-Robotics",
            "robotics",
            "FetchReach-v4",
            "gymnasium_robotics",
            40,
            20,
        ),
        (
            "handreach",
            "Gymnasium-Robotics",
            "robotics",
            "HandReach-v3",
            "gymnasium_robotics",
            40,
            20,
        ),
        ("myohandreach", "MyoSuite", "myo", "myoHandReachRandom-v0", "myosuite", 20, 10),
    ):
        arguments: dict[str, Any] = {"env_id": env_id, "package": package}
        label = f"{title} `{env_id}`, {single}"
        yield Case(name, label, venv, "peers:single", arguments, step_ms, physics_steps)
    for name, env_id, step_ms, physics_steps in (
        ("reacher", "Reacher-v5", 20, 2),
        ("handreach", "HandReach-v3", 40, 20),
    ):
        arguments = {"env_id": env_id, "n": 64, "threads": 2}
        label = f"EnvPool `{env_id}`, 64 on 2 threads"
        function = "peers:envpool"
        yield Case(f"envpool-{name}", label, "envpool", function, arguments, step_ms, physics_steps)


def environments() -> Iterator[Case]:
    """Our environments, single and in batches."""
    for name, title, single, batch, arguments in (
        ("reach", "`BabbleReach-v0`", "single", "batch", {"env_id": "BabbleReach-v0"}),
        ("grasp", "`BabbleGrasp-v0`, random play", "single", "batch", {"env_id": "BabbleGrasp-v0"}),
        ("held", "`BabbleGrasp-v0`, object held", "held_single", "held_batch", {}),
    ):
        yield Case(name, f"{title}, gymnasium.make", OURS, f"ours:{single}", arguments, 50, 10)
        for threads in THREADS:
            on = f"{threads} thread{'s' * (threads > 1)}"
            for n in BATCHES:
                yield Case(
                    batch_name(name, n, threads),
                    f"{title}, {n:,} on {on}",
                    OURS,
                    f"ours:{batch}",
                    {**arguments, "n": n, "threads": threads},
                    50,
                    10,
                )


def batch_name(name: str, n: int, threads: int) -> str:
    """The row of one of our batches."""
    return f"{name}-{n}-{threads}t"


def others() -> Iterator[Case]:
    """Resets, pictures and memory."""
    for name in ("Reach", "Grasp"):
        env_id, short = f"Babble{name}-v0", name.lower()
        label = f"`{env_id}`, reset with a given case"
        yield Case(f"reset-{short}", label, OURS, "ours:reset", {"env_id": env_id})
        for camera, pixels, title in (
            ("edges", 63, "the fovea's edges"),
            ("eye", 630, "the eye's image"),
            ("third_person", 480, "an onlooker's image"),
        ):
            yield Case(
                f"{camera}-{short}",
                f"`{env_id}`, {title}, {pixels} × {pixels}",
                OURS,
                "ours:picture",
                {"env_id": env_id, "camera": camera, "pixels": pixels},
            )
    for n in LARGE_BATCHES:
        arguments: dict[str, Any] = {"env_id": "BabbleReach-v0", "n": n}
        yield Case(f"memory-reach-{n}", f"reaching, {n:,}", OURS, "ours:memory", arguments)
        arguments = {"env_id": "BabbleGrasp-v0", "n": n}
        yield Case(f"memory-grasp-{n}", f"grasping, {n:,}", OURS, "ours:memory", arguments)
        label = f"grasping, object held, {n:,}"
        yield Case(f"memory-held-{n}", label, OURS, "ours:memory_held", {"n": n})


def core() -> Iterator[Case]:
    """Pictures in Rust, measured by criterion, which has only clock time."""
    for name, row, label in (
        ("fovea-beside", "foveal shape, hand beside", "the fovea's edges, hand beside the object"),
        ("fovea-over", "foveal shape, hand over", "the fovea's edges, hand over the object"),
        ("eye-core", "eye rgb 630", "the eye's image, 630 × 630"),
    ):
        yield Case(name, f"in Rust: {label}", RUST, "babble_eye:eye", {"row": row})


def physics() -> Iterator[Case]:
    """Physics steps of 5 ms without senses: ours, rapier's and MuJoCo's on the same robot."""
    body = Config.profile_named("paper").body
    reflex = map(math.radians, body.grip.reflex_deg)
    flexions = dict(zip(("thumb", "fingers"), reflex, strict=True))
    # A millimetre before the palm, the arm straight along x.
    palm = body.hand.palm_m + body.hand.finger_m[0]
    along = body.arm.upper_arm_m + body.arm.forearm_m + 0.62 * palm
    before_palm = (along, body.arm.half_width_m + DIAMETER_M / 2 + 0.001)
    for fingers, degrees in (("virtual", 9), ("independent", 18)):
        for scene, place, hand in (
            ("free", (0.0, -0.8), None),
            ("held", before_palm, flexions),
        ):
            name, label = f"{scene}-{degrees}", f"{degrees} degrees of freedom, {scene}"
            for row, engine in (("physics", "tree"), ("rapier", "rapier")):
                config = {"body": {"engine": engine, "grip": {"fingers": fingers}}}
                ours = {"scene": scene, "config": json.dumps(config)}
                yield Case(f"{row}-{name}", label, RUST, "babble_env:physics", ours)
            model = export_mjcf(config=config, options={"diameter": DIAMETER_M})
            theirs = {"model": model, "place": place, "reflex": hand}
            yield Case(f"mujoco-{name}", label, "gym", "twin:physics", theirs)


def wire() -> Iterator[Case]:
    """Round trips over loopback."""
    arguments: dict[str, Any]
    for name, label, venv, function, arguments in (
        ("echo", "plain TCP, 512 bytes there and back", "rpc", "echo", {"size": 512}),
        ("dm-env-rpc", "dm_env_rpc, does nothing", "rpc", "dm_env_rpc", {}),
        ("rlmesh", "RLMesh, does nothing", "rpc", "rlmesh", {}),
        ("openenv", "OpenEnv's client and server, does nothing", "openenv", "openenv", {}),
        ("openenv-ours", "OpenEnv's client, our `BabbleReach-v0`", "openenv", "openenv_ours", {}),
    ):
        yield Case(f"wire-{name}", label, venv, f"wire:{function}", arguments)
    for name in ("reach", "grasp"):
        env_id = f"Babble{name.title()}-v0"
        arguments = {"env_id": env_id}
        label = f"`RemoteEnv`, `{env_id}`"
        yield Case(f"wire-{name}", label, SERVED, "wire_ours:single", arguments)
    label = "`RemoteVectorEnv`, `BabbleReach-v0`, 64 on 1 thread"
    yield Case("wire-reach-64", label, SERVED, "wire_ours:batch", {"n": 64})
    label = "`RemoteVectorEnv`, `BabbleGrasp-v0`, object held, 64 on 1 thread"
    arguments = {"n": 64, "threads": 1}
    yield Case("wire-held-64", label, SERVED, "wire_ours:held_batch", arguments)
    label = "the same batch, local"
    yield Case("wire-local-held-64", label, OURS, "ours:held_batch", arguments)
    yield Case("wire-sessions", "64 `RemoteEnv` at once", SERVED, "wire_ours:sessions", {"n": 64})


CASES = {
    case.name: case for case in (*peers(), *environments(), *others(), *core(), *physics(), *wire())
}
"""All rows by name."""
