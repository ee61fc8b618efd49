"""Films of the environments for their pages: `python docs/_ext/films.py`, or `make pictures`.

In each one an agent that knows the geometry, or the chain after 1,000 babbles where objects are
carried, plays the first cases that it solves.
"""

from __future__ import annotations

import argparse
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

from environment_pages import CLASSES, DOCUMENTED
from PIL import Image

import gym_babble
from gym_babble.agents.base import predictor

if TYPE_CHECKING:
    from gym_babble.envs import BabbleEnv
    from gym_babble.envs.registry import Environment

FOLDER = Path(__file__).resolve().parents[1] / "images" / "environments"
SIZE = 320
"""Edge of a film [pixel]."""
EVERY = 2
"""Control steps from one frame to the next."""
FRAME_MS = 50
"""Time of a frame, so that films run twice as fast as simulated time [ms]."""
FRAMES = 160
"""Most frames of a film."""
LAST = 20
"""How often the last frame of an episode is shown."""


def agent_for(row: Environment, env: BabbleEnv) -> Any:
    """An agent that succeeds often there."""
    if row.task == "reach":
        return gym_babble.Oracle(env)
    if row.options["obs"] != "goal":
        return gym_babble.Scripted(env)
    return gym_babble.HebbBabbling(env, variant="chain", seed=0).learn(1_000)


def episode(env: BabbleEnv, agent: Any, seed: int) -> list[Any]:
    """The frames of an episode; none if the agent failed."""
    predict = predictor(agent)
    observation, info = env.reset(seed=seed)
    state, ended = None, False
    while not ended:
        action, state = predict(observation, state, None, True)  # noqa: FBT003
        observation, _, terminated, truncated, info = env.step(action)
        ended = terminated or truncated
        if env.interface.obs == "goal" and info["is_success"]:
            break
    frames = env.render()
    return frames[::EVERY] + [frames[-1]] * LAST if info["is_success"] else []


def film(row: Environment, seed: int) -> bytes:
    """The film of an environment, as a GIF, from a seed on."""
    options = {**row.presets, "width": SIZE, "height": SIZE}
    env = CLASSES[row.task](render_mode="rgb_array_list", **options)
    agent = agent_for(row, env)
    frames: list[Any] = []
    while not frames or len(frames) < FRAMES // 2:
        frames += episode(env, agent, seed)[: FRAMES - len(frames)]
        seed += 1
    first, *others = (Image.fromarray(frame).quantize(64) for frame in frames)
    file = BytesIO()
    first.save(file, "GIF", save_all=True, append_images=others, duration=FRAME_MS, loop=0)
    return file.getvalue()


def main() -> None:
    """Writes the films."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=FOLDER, help="folder for the films")
    arguments = parser.parse_args()
    for k, row in enumerate(DOCUMENTED):
        path = arguments.out / f"{row.id}.gif"
        path.write_bytes(film(row, 100 * k))  # So that no two ids show the same cases.
        print(f"{path}: {path.stat().st_size / 1e3:.0f} kB")


if __name__ == "__main__":
    main()
