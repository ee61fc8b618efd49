"""A batch of environments on a server, with the methods of the core's `Batch`."""

from __future__ import annotations

import weakref
from threading import RLock
from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble.errors import BusyError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from gym_babble.envs.interface import Interface
    from gym_babble.remote.session import Session

__all__ = ["RemoteBatch"]

One = tuple["NDArray[np.float32]", float, bool, bool, dict[str, Any]]


class RemoteBatch:
    """The environments of a session.

    What `reset`, `step` and the like show comes with the reply to one request; seeds and requests
    of cases go out with the reset. In `with batch:` no other thread can use it.
    """

    def __init__(self, interface: Interface, session: Session, num_envs: int) -> None:
        self._session = session
        self._n = num_envs
        spec = interface.spec
        self._spec = spec
        self._codes = np.array([code for _, code in interface.outcome_codes], np.uintp)
        self._retina_size = interface.retina_size
        self._goals = len(spec.goals[0].labels) if spec.goals else 0
        self._stepped: dict[str, Any] = {}
        self._ended: list[int] = []
        self._seeds: list[int | None] | None = None
        self._cases: list[dict[str, Any] | None] | None = None
        self._in_use = RLock()
        self._end = weakref.finalize(self, session.close)

    def __enter__(self) -> None:
        if not self._in_use.acquire(blocking=False):
            raise BusyError(
                "this environment is in use by another thread: give each thread an environment of "
                "its own"
            )

    def __exit__(self, *_: object) -> None:
        self._in_use.release()

    @property
    def threads(self) -> int:
        """Threads that step the batch on the server."""
        threads: int = self._session.made["threads"]
        return threads

    def close(self) -> None:
        """Ends the session."""
        self._end()

    def _ask(self, operation: str, **body: Any) -> Any:
        with self:
            return self._session.request(operation, body)

    def seed(self, i: int, seed: int) -> None:
        """Starts the stream of cases of environment `i` anew, with the next reset."""
        self._seeds = self._seeds or [None] * self._n
        self._seeds[i] = seed

    def request(self, i: int, asked: dict[str, Any]) -> None:
        """What to ask of the cases of environment `i`, from the next reset on."""
        self._cases = self._cases or [None] * self._n
        self._cases[i] = asked

    def reset(self, mask: Sequence[bool] | None = None) -> None:
        """Begins new episodes where `mask` is true; in all environments without one."""
        seeds, self._seeds = self._seeds, None
        cases, self._cases = self._cases, None
        body: dict[str, Any] = {"seeds": seeds, "cases": cases}
        if mask is not None:
            body["mask"] = bytes(mask)
        self._show(self._ask("reset", **body))

    def step(self, actions: NDArray[np.float32]) -> None:
        """One step of all environments; `actions` (n, k)."""
        self._show(self._ask("step", actions=actions.tobytes()))

    def _show(self, stepped: dict[str, Any]) -> None:
        self._stepped = stepped
        self._ended = np.frombuffer(stepped["ended"], np.uint32).tolist()

    def step_one(self, actions: NDArray[np.float32]) -> One:
        """One step of a batch of one, and what it shows."""
        self.step(actions)
        return self.one()

    def one(self) -> One:
        """What environment 0 showed last: (senses, reward, terminated, truncated, info)."""
        now, spec = self._stepped["now"], self._spec
        info: dict[str, Any] = {
            name: fact != 0 for name, fact in zip(spec.facts, now["facts"], strict=True)
        }
        outcome = now["outcome"][0]
        info["outcome"] = {name: k == outcome for k, name in enumerate(spec.outcomes)}
        terms = np.frombuffer(now["terms"]).tolist()
        info["reward_terms"] = dict(zip(spec.reward_terms, terms, strict=True))
        if spec.measures:
            info |= spec.measured(np.array(np.frombuffer(now["measures"])))
        return (
            np.array(np.frombuffer(now["senses"], np.float32)),
            float(np.frombuffer(now["reward"])[0]),
            now["terminated"] == b"\1",
            now["truncated"] == b"\1",
            info,
        )

    def one_goals(self) -> list[NDArray[np.float32]]:
        """Achieved and desired goal of environment 0; none where the task has no goals."""
        goals = self._goals_of(self._stepped["now"], 1)
        return [goal[0] for goal in goals.values()]

    def _goals_of(self, part: dict[str, Any], m: int) -> dict[str, NDArray[np.float32]]:
        if not self._goals:
            return {}
        return {
            f"{name}_goal": np.array(np.frombuffer(part[name], np.float32).reshape(m, self._goals))
            for name in ("achieved", "desired")
        }

    def all(self, mask: Sequence[bool] | None = None) -> dict[str, Any]:
        """What all environments showed last, as the core's batch gives it."""
        now, n = self._stepped["now"], self._n
        masked = np.ones(n, np.bool_) if mask is None else np.array(mask)
        shown = self._senses(now, n)
        shown["reward"] = np.array(np.frombuffer(now["reward"]))
        shown["terminated"] = np.array(np.frombuffer(now["terminated"], np.bool_))
        shown["truncated"] = np.array(np.frombuffer(now["truncated"], np.bool_))
        shown["infos"] = self._infos(now, masked)
        return shown

    def _senses(self, part: dict[str, Any], m: int) -> dict[str, Any]:
        senses = np.array(np.frombuffer(part["senses"], np.float32).reshape(m, -1))
        return {"senses": senses, **self._goals_of(part, m)}

    def _infos(self, now: dict[str, Any], mask: NDArray[np.bool_]) -> dict[str, Any]:
        """Facts, outcomes, reward terms and measures; false and 0 where `mask` is false."""
        spec, n = self._spec, self._n
        infos: dict[str, Any] = {}

        def add(infos: dict[str, Any], name: str, values: Any) -> None:
            infos[name] = values
            infos[f"_{name}"] = mask.copy()

        facts = np.frombuffer(now["facts"], np.bool_).reshape(n, -1)
        for k, name in enumerate(spec.facts):
            add(infos, name, facts[:, k] & mask)
        outcome = np.frombuffer(now["outcome"], np.uint8)
        outcomes: dict[str, Any] = {}
        for k, name in enumerate(spec.outcomes):
            add(outcomes, name, (outcome == k) & mask)
        terms: dict[str, Any] = {}
        shown = np.frombuffer(now["terms"]).reshape(n, -1)
        for k, name in enumerate(spec.reward_terms):
            add(terms, name, np.where(mask, shown[:, k], 0.0))
        add(infos, "outcome", outcomes)
        add(infos, "reward_terms", terms)
        if spec.measures:
            measures = np.frombuffer(now["measures"]).reshape(n, -1)
            for name, values in spec.measured(np.where(mask[:, None], measures, 0.0)).items():
                add(infos, name, np.array(values))
        return infos

    def ended(self) -> tuple[NDArray[np.intp], dict[str, Any]] | None:
        """What the episodes that ended within the last step showed last; None without any."""
        if not self._ended:
            return None
        last, m = self._stepped["last"], len(self._ended)
        shown = self._senses(last, m)
        shown["outcome"] = self._codes[np.frombuffer(last["outcome"], np.uint8)]
        shown["facts"] = np.frombuffer(last["facts"], np.bool_).reshape(m, -1)
        shown["terms"] = np.frombuffer(last["terms"]).reshape(m, -1)
        if self._spec.measures:
            shown["measures"] = np.array(np.frombuffer(last["measures"]).reshape(m, -1))
        return np.array(self._ended, np.intp), shown

    def retina(self, i: int, size: int) -> NDArray[np.uint8]:
        """The eye's image (size, size, 3) of environment `i`."""
        return self._image(self._stepped["now"]["retina"], i, size)

    def retina_ended(self, i: int, size: int) -> NDArray[np.uint8] | None:
        """The eye's last image of environment `i`'s episode, if it ended within the last step."""
        if i not in self._ended:
            return None
        return self._image(self._stepped["last"]["retina"], self._ended.index(i), size)

    def _image(self, images: bytes, k: int, size: int) -> NDArray[np.uint8]:
        pixels = np.frombuffer(images, np.uint8, size * size * 3, k * size * size * 3)
        return np.array(pixels.reshape(size, size, 3))

    def save(self, i: int) -> bytes:
        """Bytes from which environment `i` continues bit for bit."""
        state: bytes = self._ask("save", envs=[i])["states"][0]
        return state

    def save_all(self) -> list[bytes]:
        """Such bytes of each environment."""
        states: list[bytes] = self._ask("save")["states"]
        return states

    def save_ended(self, i: int) -> bytes | None:
        """Such bytes of environment `i`'s episode, if it ended within the last step."""
        if i not in self._ended:
            return None
        state: bytes | None = self._ask("save", envs=[i], ended=True)["states"][0]
        return state

    def load(self, i: int, state: bytes) -> None:
        """Continues environment `i` from bytes."""
        states: list[bytes | None] = [None] * self._n
        states[i] = state
        self.load_all(states)

    def load_all(self, states: Sequence[bytes | None]) -> None:
        """Continues environments from bytes, where there are any; all or, after an error, none."""
        self._ask("load", states=states)

    def state_hash(self, i: int) -> int:
        """A number that two states share only if they are the same to the bit."""
        found: int = self._ask("hash", env=i)["hash"]
        return found

    def case(self, i: int) -> dict[str, Any]:
        """The case of environment `i`."""
        case = self._ask("case", env=i)["case"]
        return {k: tuple(v) if isinstance(v, list) else v for k, v in case.items()}

    def trail(self, i: int) -> NDArray[np.float64]:
        """The recorded way of the hand of environment `i` (k, 2) [m]."""
        trail = self._ask("trail", env=i)["trail"]
        return np.array(np.frombuffer(trail).reshape(-1, 2))

    def moments(self, i: int) -> int:
        """How many moments of environment `i` were recorded since its reset."""
        moments: int = self._ask("moments", env=i)["moments"]
        return moments

    def render(
        self, i: int, camera: str, width: int, height: int, frame: int | None = None
    ) -> NDArray[np.uint8]:
        """A picture (height, width, 3) of environment `i`, now or at a recorded moment."""
        asked = {"env": i, "camera": camera, "width": width, "height": height, "moment": frame}
        image = self._ask("render", **asked)["image"]
        return np.array(np.frombuffer(image, np.uint8).reshape(height, width, 3))
