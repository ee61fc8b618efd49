"""The paper's agent of grasping, and one that knows the geometry."""

from __future__ import annotations

import json
from abc import ABC, abstractmethod
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from gym_babble import _core
from gym_babble.agents.base import EnvLike, flat_senses, interface_of, merge, processors
from gym_babble.envs.grasp import BabbleGraspEnv
from gym_babble.envs.interface import check_seed, check_whole
from gym_babble.envs.spaces import Spec
from gym_babble.errors import AgentFileError, ConfigError
from gym_babble.progress import track

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from numpy.typing import NDArray

    from gym_babble.envs.interface import Interface

__all__ = ["BABBLE_S", "GraspRandom", "GraspScripted", "HebbGrasping"]

BABBLES_A_CALL = 50
BABBLE_S = _core.GraspHebb.BABBLE_S
"""Time that one babble takes [s]."""


class Grasping(NamedTuple):
    """Grasps under way: one of each environment."""

    posture: NDArray[np.float64]
    """Shoulder, elbow, and flexions of thumb and finger once the hand closes (n, 4) [rad]."""
    touched: NDArray[np.bool_]
    """Whether the hand has touched the object (n,)."""


class GraspAgent(ABC):
    """An agent that decides once what posture to reach and to grasp with (Sect. IV).

    The arm moves there at once, with the hand open; the hand closes when it touches the object.
    """

    def __init__(self, env: EnvLike) -> None:
        self._interface = interface_of(env, "grasp")
        self._columns = dict(Spec.of(self._interface.task).slices)
        if self._interface.options["control"] == "torque":
            raise ConfigError(
                "control = 'torque': this agent plans postures; use posture or delta_posture"
            )

    @property
    def interface(self) -> Interface:
        """What the environment of this agent was made with."""
        return self._interface

    @abstractmethod
    def plan(self, senses: NDArray[np.float32]) -> NDArray[np.float64]:
        """Shoulder, elbow, and flexions of thumb and finger (n, 4) [rad], for flat senses."""

    def predict(
        self,
        observation: Any,
        state: Grasping | None = None,
        episode_start: Any = None,
        deterministic: bool = True,  # noqa: FBT001, FBT002 - stable-baselines3's signature
    ) -> tuple[NDArray[np.float32], Grasping]:
        """Actions for an observation, or a batch of them, as stable-baselines3's agents give them.

        Args:
            observation: As the environment gives it, of any `obs=`.
            state: What the last call returned; None at first.
            episode_start: Which of the environments have begun a new episode (n,).
            deterministic: Not used: a decision has no randomness.

        Returns:
            Actions (4,) or (n, 4), and the state for the next call.
        """
        del deterministic
        senses = flat_senses(observation, self._columns)
        batch = np.atleast_2d(senses)
        grasping = self._begin(batch, state, episode_start)
        touched = grasping.touched | (batch[:, self._columns["touch"]] > 0.0).any(axis=1)
        actions = self._actions(batch, grasping.posture, touched)
        grasping = Grasping(grasping.posture, touched)
        return (actions if senses.ndim == 2 else actions[0]), grasping

    def _begin(
        self, senses: NDArray[np.float32], state: Grasping | None, episode_start: Any
    ) -> Grasping:
        """Grasps under way, with new ones for the episodes that have just begun."""
        n = len(senses)
        if state is None or len(state.touched) != n:
            return Grasping(self.plan(senses), np.zeros(n, np.bool_))
        starts = np.zeros(n, np.bool_) if episode_start is None else episode_start
        starting = np.broadcast_to(np.asarray(starts, np.bool_), n)
        if not starting.any():
            return state
        posture, touched = state.posture.copy(), state.touched.copy()
        posture[starting] = self.plan(senses[starting])
        touched[starting] = False
        return Grasping(posture, touched)

    def _actions(
        self,
        senses: NDArray[np.float32],
        posture: NDArray[np.float64],
        touched: NDArray[np.bool_],
    ) -> NDArray[np.float32]:
        low, high = self._interface.quantities["ranges"].T
        open_hand = np.concatenate([posture[:, :2], np.broadcast_to(low[2:], (len(posture), 2))], 1)
        wanted = np.where(touched[:, None], posture, open_hand)
        if self._interface.options["control"] == "posture":
            actions = 2.0 * (wanted - low) / (high - low) - 1.0
        else:
            share = np.concatenate(
                [senses[:, self._columns["arm"]], senses[:, self._columns["hand"]]], axis=1
            )
            # The equilibrium point is angle plus stretch.
            now = low + share * (high - low) + senses[:, self._columns["stretch"]]
            actions = (wanted - now) / self._interface.quantities["delta_posture"]
        clipped: NDArray[np.float32] = np.clip(actions, -1.0, 1.0).astype(np.float32)
        return clipped


class HebbGrasping(GraspAgent):
    """Learns to reach and grasp by motor babbling (Caligiore et al. 2008, Sect. IV).

    Babbling puts the object into the hand: the enclosure reflex closes the hand, the arm moves to a
    random posture, and the covariance rule (Eq. 7) ties the eye's posture to the arm's and the
    fovea's edges to the hand's. The sight of an object then recalls both (Eq. 4). The arm moves at
    once; the hand closes when it touches the object.

    Args:
        env: An id or an environment; its body is babbled on, its control (posture or
            delta_posture) decides how the agent acts.
        seed: Seed of the babbling.
        threads: Threads that babble and learn; all processors if not given. Results do not depend
            on it.
        config: Numbers that differ from the paper's, e.g. `{"sigma": 1.0, "squeeze_deg": 0.0}`;
            `agent.config` has them all.

    Raises:
        ConfigError: An argument or a number of the config is not one there is.
    """

    def __init__(
        self,
        env: EnvLike = "BabbleGrasp-v0",
        *,
        seed: int = 0,
        threads: int | None = None,
        config: Mapping[str, Any] | None = None,
    ) -> None:
        super().__init__(env)
        check_seed(seed)
        numbers = json.loads(_core.GraspHebb.default_config())
        merge(numbers, config or {}, "config")
        self._hebb = _core.GraspHebb(json.dumps(numbers), seed, processors(threads))

    def learn(
        self,
        babbles: int = 1_000,
        *,
        progress_bar: bool = False,
        callback: Callable[[HebbGrasping], bool | None] | None = None,
    ) -> HebbGrasping:
        """Babbles until the hand has kept so many more objects, and learns from these.

        Interrupted by Ctrl-C, the agent is as after the last 50 of them, and can go on from there.

        Args:
            babbles: Objects kept in the hand to learn from.
            progress_bar: Show a bar with the time left.
            callback: Called with the agent about every 50 babbles; False stops.

        Returns:
            The agent itself.

        Raises:
            ConfigError: `babbles` is not a whole number of at least 0.
            ScenarioError: The hand keeps hardly any object.
            BusyError: Another thread uses the agent.
        """
        check_whole("babbles", babbles, 0, 10_000_000, "babbles")
        chunks = [BABBLES_A_CALL] * (babbles // BABBLES_A_CALL)
        if babbles % BABBLES_A_CALL:
            chunks.append(babbles % BABBLES_A_CALL)
        with self._hebb:
            for chunk in track(chunks, "babbling", total=babbles, show=progress_bar):
                self._hebb.learn(self._interface.task, chunk)
                if callback is not None and callback(self) is False:
                    break
        return self

    def decide(self, eyes: NDArray[np.float32], foveae: NDArray[np.float32]) -> NDArray[np.float64]:
        """What sights recall (n, 4), for eyes (n, 2) and foveae (n, 441).

        Shoulder and elbow as shares of their ranges, and equilibrium points of thumb and finger as
        the paper counts them, EP = 90° − flexion [deg].
        """
        return self._hebb.decide(
            np.ascontiguousarray(eyes, np.float32), np.ascontiguousarray(foveae, np.float32)
        )

    def plan(self, senses: NDArray[np.float32]) -> NDArray[np.float64]:
        """Shoulder, elbow, and flexions of thumb and finger (n, 4) [rad], for flat senses."""
        recalled = self.decide(senses[:, self._columns["eye"]], senses[:, self._columns["fovea"]])
        low, high = self._interface.quantities["ranges"][:2].T
        arm = low + recalled[:, :2] * (high - low)
        # A hand around the object would press with no force at its own posture.
        flexion = np.radians(90.0 - recalled[:, 2:] + self.config["squeeze_deg"])
        reflex = self._interface.quantities["reflex"]
        return np.concatenate([arm, np.minimum(flexion, reflex)], axis=1)

    def recall_arm(self, eye: NDArray[np.float32]) -> NDArray[np.float32]:
        """Activity of the arm's map (21, 21), rows elbow, columns shoulder, for an eye (2,)."""
        return self._hebb.recall_arm(np.asarray(eye, np.float32).tolist())

    def recall_hand(self, fovea: NDArray[np.float32]) -> NDArray[np.float32]:
        """Activity of the hand's map (21, 21), rows finger, columns thumb, for a fovea (441,)."""
        return self._hebb.recall_hand(np.ascontiguousarray(fovea, np.float32))

    def save(self, path: str | Path) -> None:
        """Writes the agent: weights as safetensors, all else as JSON in its metadata."""
        Path(path).write_bytes(self._hebb.save(self._interface.task.config()))

    @classmethod
    def load(
        cls, path: str | Path, env: EnvLike | None = None, *, threads: int | None = None
    ) -> HebbGrasping:
        """Reads an agent.

        Args:
            path: The file.
            env: Environment to act in; by default BabbleGrasp-v0 on the body it learnt on.
            threads: As for the class.

        Raises:
            FileNotFoundError: There is no such file.
            AgentFileError: The file is cut short, altered, or not such an agent.
        """
        try:
            core, config = _core.GraspHebb.load(Path(path).read_bytes(), processors(threads))
        except ValueError as error:
            raise AgentFileError(f"{path}: {error}") from error
        agent = cls.__new__(cls)
        GraspAgent.__init__(
            agent, BabbleGraspEnv(config=json.loads(config)) if env is None else env
        )
        agent._hebb = core  # noqa: SLF001 - its own
        return agent

    @property
    def config(self) -> dict[str, Any]:
        """Numbers of maps and rule."""
        return json.loads(self._hebb.config())  # type: ignore[no-any-return]

    @property
    def weights(self) -> dict[str, NDArray[np.float32]]:
        """Copies of the weights and running averages, by name.

        `reach.weights` (arm neurons, eye neurons) and `grasp.weights` (hand neurons, fovea neurons)
        are w_ji of Eq. 7; `reach.a_bar`, `reach.g_bar`, ... are the running averages of output and
        input. Neuron j of a map of n × n stands in column j % n and row j // n.
        """
        return self._hebb.weights()

    @property
    def babbled(self) -> dict[str, NDArray[Any]]:
        """What this object's own babbling left behind; it is not saved.

        `eye` (n, 2), `fovea` (n, 441), `arm` (n, 2), `hand` (n, 2) [deg] and `diameter` (n,) [m].
        """
        return self._hebb.babbled()  # type: ignore[return-value]

    @property
    def babbles(self) -> int:
        """Babbles made, whether the hand kept the object or not."""
        return self._hebb.babbles

    @property
    def kept(self) -> int:
        """Babbles in which the hand kept the object in sight of the eye, which were learnt from."""
        return self._hebb.kept


class GraspScripted(GraspAgent):
    """Goes straight to where the palm meets the object, and closes as the reflex does.

    It knows the arm's geometry and the eye's: where the eye looks the object is. The fovea's edges,
    which tell the size, it does not read: it aims the palm's surface at the object's middle, and
    the hand stops where it touches.
    """

    def __init__(self, env: EnvLike = "BabbleGrasp-v0") -> None:
        super().__init__(env)

    def plan(self, senses: NDArray[np.float32]) -> NDArray[np.float64]:
        """Shoulder, elbow, and flexions of thumb and finger (n, 4) [rad], for flat senses."""
        ranges = self._interface.quantities["ranges"]
        eyes = senses[:, self._columns["eye"]]
        arms = [self._arm(eye.tolist()) or ranges[:2].mean(axis=1).tolist() for eye in eyes]
        hands = np.broadcast_to(self._interface.quantities["reflex"], (len(senses), 2))
        return np.concatenate([np.array(arms).reshape(-1, 2), hands], axis=1)

    def _arm(self, eye: list[float]) -> list[float] | None:
        task = self._interface.task
        point = _core.looked_at(task, eye)
        return None if point is None else _core.grasp_posture(task, (point[0], point[1]), 0.0)


class GraspRandom:
    """Draws each action uniformly from [−1, 1]⁴, whatever it sees."""

    def __init__(self, env: EnvLike = "BabbleGrasp-v0", *, seed: int | None = None) -> None:
        self._interface = interface_of(env, "grasp")
        self._senses = dict(Spec.of(self._interface.task).slices)
        self._random = np.random.default_rng(seed)

    def predict(
        self,
        observation: Any,
        state: None = None,
        episode_start: Any = None,
        deterministic: bool = False,  # noqa: FBT001, FBT002 - stable-baselines3's signature
    ) -> tuple[NDArray[np.float32], None]:
        """Actions (4,) for an observation, or (n, 4) for a batch of them; no state."""
        del episode_start, deterministic
        shape = flat_senses(observation, self._senses).shape[:-1]
        return self._random.uniform(-1.0, 1.0, (*shape, 4)).astype(np.float32), state
