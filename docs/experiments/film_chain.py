"""The film of the chain: its first babble, and how it grasps a small ball after more and more.

Left, the first babble of a hand that knows nothing but its reflex, chunk by chunk as in
own_chain.py. On its right, the agent that learns from such babbles tries the same small ball after
few babbles and after many.

python docs/experiments/film_chain.py --out docs/images/chain.gif --strip docs/images/chain.png
"""

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np

from gym_babble import HebbBabbling, Joints, scenarios
from gym_babble.agents.loading import acting_agent
from gym_babble.files import check_file, write_file
from gym_babble.viz.episode import Episode, play
from gym_babble.viz.film import Film, Scene
from gym_babble.viz.panel import Panel
from gym_babble.viz.scenes import stages
from gym_babble.viz.text import INK, draw_on, font
from gym_babble.viz.video import check_film, contact_sheet, film_bytes, png

ENV = "BabbleGrasp-v0"
STEP = np.radians(1.5)  # How far the arm advances in a control step.
OPEN = np.zeros(2)
STILL, MIDDLE = 520, (slice(115, 415), slice(155, 455))
"""Edge of a still [pixel], and its part that the strip shows."""


class Infant:
    """An arm with a small ball in its hand, which moves chunk by chunk."""

    def __init__(self, seed: int) -> None:
        self.env = gym.make(
            ENV, control="posture", max_episode_steps=600, enclosure_reflex=True,
            reflex_releases=True, support_stays=True, record=True,
        ).unwrapped  # fmt: skip
        self.joints, self.random = Joints(self.env), np.random.default_rng(seed)
        start = {"in_hand": True, "diameter": 0.024, "start": (0.5, 1.2)}
        self.seen, _ = self.env.reset(seed=seed, options=start)
        self.observations, self.chunks = [self.seen], ["the ball lies at the palm"]

    @property
    def arm(self) -> Any:
        """Shoulder and elbow [rad]."""
        return self.joints.posture(self.seen)[:2]

    def move(self, chunk: str, arm: Any, hand: Any) -> None:
        """A control step with these equilibrium points [rad]."""
        action = self.joints.actions(np.concatenate([arm, hand]))
        self.seen = self.env.step(action)[0]
        self.observations.append(self.seen)
        self.chunks.append(chunk)

    def moves(self, chunk: str, arm: Any, hand: Any, steps: int) -> None:
        """Several of them."""
        for _ in range(steps):
            self.move(chunk, arm, hand)

    def babble(self) -> bool:
        """All chunks of a babble; whether the hand feels the ball between its sides at the end."""
        uniform, reflex = self.random.uniform, self.env.interface.quantities["reflex"]
        low, high = np.radians([[40.0, 50.0], [110.0, 100.0]])  # In the middle of the picture.
        self.moves("close: the palm's reflex", self.arm, reflex, 45)
        self.moves("carry: to a random posture", uniform(low, high), reflex, 50)
        held = self.arm
        self.moves("open", held, OPEN, 40)
        way = np.array([0.0, np.radians(uniform(20, 40))])
        self.moves("withdraw: the elbow extends", held - way, OPEN, 40)
        away = np.array([np.radians(uniform(30, 70)), 0.0])
        self.moves("turn away: and look", held - way - away, OPEN, 50)
        self.moves("return", held - way, OPEN, 50)
        before = self.arm
        for step in range(60):
            advance = min(STEP * step / way[1], 1.6)
            self.move("advance: until the palm touches", before + advance * way, OPEN)
            if self.seen["touch"][0] > 0:
                break
        self.moves("close: and learn", self.arm, reflex, 45)
        palm, thumb, finger = self.seen["touch"] > 0
        return bool(finger and (palm or thumb))


def first_babble(seeds: int = 50) -> tuple[Infant, Episode]:
    """The babble of the first seed that ends with the ball in the hand."""
    for seed in range(seeds):
        infant = Infant(seed)
        if infant.babble():
            return infant, Episode(infant, infant.env, infant.observations, "success")
    raise SystemExit(f"none of {seeds} babbles kept the ball")


def learning(few: int, many: int, cases: Sequence[Any]) -> dict[str, Episode]:
    """The agent on the first case that it fails after few babbles and holds after many."""
    loaded = acting_agent(HebbBabbling(ENV, variant="chain", seed=0))
    agents = stages(loaded, [few, many], progress_bar=True)
    for case in cases:
        episodes = {title: play(agent, case) for title, agent in agents.items()}
        before, after = (episode.outcome == "success" for episode in episodes.values())
        if after and not before:
            print(f"case {case['index']} of {case['protocol']}")
            return episodes
    raise SystemExit(f"none of {len(cases)} cases shows what was learnt")


def stills(infant: Infant, grasp: Episode) -> bytes:
    """The last moment of each chunk, and four moments of a grasp, row by row."""
    last = {chunk: k for k, chunk in enumerate(infant.chunks)}
    pictures = [(infant.env, k, chunk.partition(":")[0]) for chunk, k in last.items()][1:]
    moments = np.linspace(0, grasp.moments - 1, 4).round().astype(int).tolist()
    names = ("learnt: it looks", "goes before the ball", "advances, closes", "holds")
    pictures += [(grasp.env, k, name) for k, name in zip(moments, names, strict=True)]
    tiles = []
    for env, moment, name in pictures:
        tile = env.picture("third_person", (STILL, STILL), moment)[MIDDLE].copy()
        with draw_on(tile) as draw:
            draw.text((8, 6), name, INK, font(18))
        tiles.append(tile)
    return png(contact_sheet(tiles, columns=4, rows=len(tiles) // 4))


def main() -> None:
    """Babbles, learns and films."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("chain.gif"), help="file for the film")
    parser.add_argument("--strip", type=Path, help="file for a strip of stills")
    parser.add_argument("--babbles", type=int, nargs=2, default=[10, 1_000], help="few, and many")
    parser.add_argument("--cases", type=int, default=50, help="validation cases to choose from")
    parser.add_argument("--width", type=int, default=300, help="width of a panel [pixel]")
    arguments = parser.parse_args()
    for path in filter(None, (arguments.out, arguments.strip)):
        check_file(path, "--out")
        check_film(path)
    infant, babble = first_babble()
    cases = scenarios("palm_side", arguments.cases, split="validation", diameters=[0.024])
    episodes = learning(*arguments.babbles, cases)
    panels = [Panel("The first babble", infant.chunks, babble)]
    panels += [
        Panel(title.capitalize(), "a ball of 2.4 cm", episode)
        for title, episode in episodes.items()
    ]
    for panel in panels:
        panel.maps = None  # The maps would make the film five times as big.
    film = Film([Scene(panels)], arguments.width, fps=8, speed=2.0)
    write_file(arguments.out, film_bytes(film, arguments.out.suffix, progress_bar=True))
    if arguments.strip:
        write_file(arguments.strip, stills(infant, [*episodes.values()][-1]))
    print(f"{arguments.out}: {arguments.out.stat().st_size / 1e3:.0f} kB")


if __name__ == "__main__":
    main()
