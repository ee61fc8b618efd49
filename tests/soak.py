"""Random play through Python for long: `python tests/soak.py 10000000` plays so many steps of each.

Every kind of action and observation, both bodies, actions at and beyond their bounds; actions that
are no numbers, and resets with options, in between. Fails at the first observation outside of its
space, reward that is not finite, refusal that left a trace, or memory that grew.
"""

from __future__ import annotations

import gc
import resource
import sys
from collections import Counter
from dataclasses import dataclass, field
from itertools import product
from math import ceil
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble.envs import BabbleGraspVectorEnv, BabbleReachVectorEnv
from gym_babble.errors import ActionError, ScenarioError
from gym_babble.progress import track

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from gymnasium.vector import VectorEnv

BATCHES = {"reach": BabbleReachVectorEnv, "grasp": BabbleGraspVectorEnv}
MOST_GROWTH_MB = 8.0
FORMS = (
    {"obs": "flat", "reward": "progress"},
    {"obs": "senses", "reward": "sparse", "max_episode_steps": 25},
    {"obs": "goal", "reward": "sparse"},
)
CONFIGS: tuple[Any, ...] = ("paper", "icub")


def forms(task: str) -> list[tuple[dict[str, Any], float]]:
    """Every combination of choices, with the share of steps that it is given."""
    if task == "reach":
        controls: tuple[tuple[str, float], ...] = (
            ("delta_posture", 1), ("posture", 1), ("torque", 1), ("pattern", 0.1),
        )  # fmt: skip
        extra: tuple[dict[str, Any], ...] = ({},)
    else:
        controls = (("delta_posture", 1), ("posture", 1), ("torque", 1))
        extra = (
            {"region": "palm_side", "enclosure_reflex": True},
            {"region": "full", "any_diameter_between": True},
        )
    found = [
        ({**form, **more, "control": control, "config": config}, share)
        for form, more, (control, share), config in product(FORMS, extra, controls, CONFIGS)
    ]
    # Slower ones: each image is drawn, and rapier has its own state.
    found.append(({"obs": "retina", "retina_size": 36}, 0.01))
    if task == "grasp":
        rapier = {"body": {"engine": "rapier"}}
        independent = {"body": {"grip": {"fingers": "independent"}}}
        found += [({**FORMS[0], "config": rapier}, 0.2), ({**FORMS[0], "config": independent}, 0.2)]
    return found


@dataclass
class Tally:
    """What was played."""

    steps: int = 0
    refused: int = 0
    resets: int = 0
    impossible: int = 0
    outcomes: Counter[str] = field(default_factory=Counter)
    most_reward: float = 0.0
    memory_mb: list[float] = field(default_factory=list)


class Soak:
    """One batch, played at random."""

    def __init__(self, envs: VectorEnv[Any, Any, Any], seed: int, tally: Tally) -> None:
        self._envs, self._tally = envs, tally
        self._random = np.random.default_rng(seed)
        envs.reset(seed=seed)
        space = envs.single_observation_space
        self._boxes = dict(space.items()) if hasattr(space, "items") else {"": space}
        self._actions = np.zeros(envs.action_space.shape, np.float32)

    def play(self, steps: int) -> None:
        """So many steps of all environments together, and no fewer than a few of each."""
        for k in range(max(3, ceil(steps / self._envs.num_envs))):
            self._draw()
            if k % 23 == 1:
                self._bad_action()
            if k % 37 == 2:
                self._reset()
            observation, reward, terminated, truncated, infos = self._envs.step(self._actions)
            self._check(observation, reward)
            ended = terminated | truncated
            if ended.any():
                for name in self._envs.unwrapped.interface.spec.outcomes:
                    count = np.count_nonzero(infos["outcome"][name][ended])
                    self._tally.outcomes[name] += int(count)
            self._tally.steps += self._envs.num_envs

    def _draw(self) -> None:
        """New actions for some environments: others hold theirs, so that arms get somewhere."""
        random, shape = self._random, self._actions.shape
        new = random.uniform(-1, 1, shape)
        extreme = random.random((shape[0], 1)) < 0.4
        new = np.where(extreme, np.sign(new), new)
        new *= random.choice([0.0, 1e-40, 0.1, 1.0, 1.0, 1.0, 3.0, 1e30, 3e38], (shape[0], 1))
        renewed = random.random((shape[0], 1)) < 0.08
        self._actions = np.where(renewed, new, self._actions).astype(np.float32)

    def _bad_action(self) -> None:
        before = self._envs.call("state_hash")
        bad = self._actions.copy()
        place = tuple(self._random.integers(bad.shape))
        bad[place] = self._random.choice([np.nan, np.inf, -np.inf])
        try:
            self._envs.step(bad)
        except ActionError:
            self._tally.refused += 1
        else:
            raise AssertionError(f"{bad[place]} was played")
        assert self._envs.call("state_hash") == before

    def _reset(self) -> None:
        """Some environments anew, with cases of others, or with a part of them."""
        random = self._random
        mask = random.random(self._envs.num_envs) < 0.2
        mask[random.integers(len(mask))] = True
        case = random.choice(np.array(self._envs.get_attr("scenario"), dtype=object))
        if self._envs.interface.obs != "goal":
            case.pop("goal", None)
        parts = [name for name in case if random.random() < 0.7]
        options = {name: case[name] for name in parts}
        if random.random() < 0.2:
            options["obstacle"] = (*random.uniform(-0.3, 0.3, 2), 0.02)
        try:
            self._envs.reset(options={**options, "reset_mask": mask})
            self._tally.resets += int(mask.sum())
        except ScenarioError:
            # Obstacles may stand in the way of all cases; then the episodes go on.
            self._tally.impossible += 1

    def _check(self, observation: Any, reward: Any) -> None:
        parts = observation if isinstance(observation, dict) else {"": observation}
        for name, box in self._boxes.items():
            values = parts[name]
            assert values.dtype == box.dtype, name
            inside = (box.low <= values) & (values <= box.high)
            assert inside.all(), (name, values[~inside])
        assert np.isfinite(reward).all()
        self._tally.most_reward = max(self._tally.most_reward, float(np.abs(reward).max()))


def memory_mb() -> float:
    """Memory in use; where the system does not say, the most that ever was."""
    gc.collect()
    statm = Path("/proc/self/statm")
    if statm.exists():
        return int(statm.read_text().split()[1]) * resource.getpagesize() / 1e6
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3


def soak(
    task: str,
    steps: int,
    *,
    rounds: int = 10,
    num_envs: int = 64,
    show: bool = False,
    make: Callable[..., VectorEnv[Any, Any, Any]] | None = None,
) -> Tally:
    """Plays at least so many steps of a task in all forms, in batches that `make` makes.

    Memory is compared between the first and the last round through the forms.
    """
    make = make or BATCHES[task]
    all_forms = forms(task)
    whole = rounds * sum(share for _, share in all_forms)
    tally = Tally()

    def turns() -> Iterator[int]:
        for turn, (i, (form, share)) in product(range(rounds), enumerate(all_forms)):
            before = tally.steps
            envs = make(num_envs, threads=1, **form)
            Soak(envs, 1000 * turn + i, tally).play(ceil(steps * share / whole))
            envs.close()
            if i + 1 == len(all_forms):
                tally.memory_mb.append(memory_mb())
            yield tally.steps - before

    for _ in track(turns(), task, total=steps, show=show):
        pass
    growth = tally.memory_mb[-1] - tally.memory_mb[0]
    assert growth < MOST_GROWTH_MB, tally.memory_mb
    return tally


if __name__ == "__main__":
    for name in BATCHES:
        print(name, soak(name, int(float(sys.argv[1])), show=True))
