"""The paper's agent: motor babbling and a Hebb rule."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble import _core
from gym_babble.agents.base import merge, processors
from gym_babble.agents.movements import MovementAgent
from gym_babble.envs import BabbleReachEnv
from gym_babble.envs.interface import check_seed
from gym_babble.errors import AgentFileError, ConfigError
from gym_babble.progress import track

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from numpy.typing import NDArray

    from gym_babble.agents.base import EnvLike

__all__ = ["VARIANTS", "HebbBabbling"]

VARIANTS = ("paper", "conjunctive")
MOVEMENTS_A_CALL = 250


class HebbBabbling(MovementAgent):
    """Learns by motor babbling which movement fits what is seen (Caligiore et al. 2008, Sect. III).

    Random movements are made; from each one that neither touches the obstacle nor leaves the joint
    ranges, the covariance rule (Eq. 7) ties the obstacle's place in the eye-centred map to the
    movement's parameters (b1, b2). Seeing an obstacle then recalls a movement (Eq. 4).

    Args:
        env: An id or an environment; its body is babbled on, its control decides how the agent
            acts (see `MovementAgent`).
        variant: "paper", or "conjunctive": obstacle and target in one map of pairs, and a readout
            around the strongest neuron.
        seed: Seed of the babbling.
        quasi_static: Babble without the muscles' lag: faster, and less like the paper.
        threads: Threads that babble and learn; all processors if not given. Results do not depend
            on it.
        config: Numbers of maps and rule that differ from the variant's, e.g.
            `{"sigma": 1.0, "rule": {"eta": 0.5}}`; `agent.config` has them all.

    Raises:
        ConfigError: An argument or a number of the config is not one there is.
    """

    def __init__(
        self,
        env: EnvLike = "BabbleReachPattern-v0",
        variant: str = "paper",
        *,
        seed: int = 0,
        quasi_static: bool = False,
        threads: int | None = None,
        config: Mapping[str, Any] | None = None,
    ) -> None:
        super().__init__(env)
        check_seed(seed)
        numbers = json.loads(_core.Hebb.variant_config(variant))
        merge(numbers, config or {}, "config")
        self._hebb = _core.Hebb(json.dumps(numbers), seed, quasi_static, processors(threads))

    def learn(
        self,
        movements: int = 20_000,
        *,
        progress_bar: bool = False,
        callback: Callable[[HebbBabbling], bool | None] | None = None,
    ) -> HebbBabbling:
        """Babbles until so many more movements were legal, and learns from these.

        Interrupted by Ctrl-C, the agent is as after the last 250 of them, and can go on from there.

        Args:
            movements: Legal movements to learn from; the paper's 20,000.
            progress_bar: Show a bar with the time left.
            callback: Called with the agent about every 250 legal movements; False stops.

        Returns:
            The agent itself.

        Raises:
            ConfigError: `movements` is negative.
            ScenarioError: Hardly any movement is legal on this body.
            BusyError: Another thread uses the agent.
        """
        if movements < 0:
            raise ConfigError(f"movements = {movements} is not at least 0")
        chunks = [MOVEMENTS_A_CALL] * (movements // MOVEMENTS_A_CALL)
        if movements % MOVEMENTS_A_CALL:
            chunks.append(movements % MOVEMENTS_A_CALL)
        with self._hebb:
            for chunk in track(chunks, "babbling", total=movements, show=progress_bar):
                self._hebb.learn(self._interface.task, chunk)
                if callback is not None and callback(self) is False:
                    break
        return self

    def decide(self, senses: NDArray[np.float32]) -> NDArray[np.float64]:
        """Parameters (b1, b2) of movements (n, 2), for flat senses (n, 11)."""
        return self._hebb.decide(senses)

    def recall(self, senses: NDArray[np.float32]) -> NDArray[np.float32]:
        """Activity of the output map (21, 21), rows b2, columns b1, for flat senses (11,)."""
        return self._hebb.recall(np.asarray(senses, np.float32).tolist())

    def save(self, path: str | Path) -> None:
        """Writes the agent: weights as safetensors, all else as JSON in its metadata."""
        Path(path).write_bytes(self._hebb.save(self._interface.task.config()))

    @classmethod
    def load(
        cls, path: str | Path, env: EnvLike | None = None, *, threads: int | None = None
    ) -> HebbBabbling:
        """Reads an agent.

        Args:
            path: The file.
            env: Environment to act in; by default `pattern` control on the body it learnt on.
            threads: As for the class.

        Raises:
            FileNotFoundError: There is no such file.
            AgentFileError: The file is cut short, altered, or not an agent.
        """
        try:
            core, config = _core.Hebb.load(Path(path).read_bytes(), processors(threads))
        except ValueError as error:
            raise AgentFileError(f"{path}: {error}") from error
        agent = cls.__new__(cls)
        MovementAgent.__init__(agent, _pattern_env(config) if env is None else env)
        agent._hebb = core  # noqa: SLF001 - its own
        return agent

    @property
    def config(self) -> dict[str, Any]:
        """Numbers of maps and rule."""
        return json.loads(self._hebb.config())  # type: ignore[no-any-return]

    @property
    def variant(self) -> str:
        """Which variant this is: "paper" or "conjunctive"."""
        return str(self.config["variant"])

    @property
    def weights(self) -> dict[str, NDArray[np.float32]]:
        """Copies of the weights and running averages, by name.

        `weights` (output neurons, input neurons) is w_ji of Eq. 7; `a_bar` and `g_bar` are the
        running averages of output and input. Neuron j of a map of n × n stands in column j % n
        (first value) and row j // n (second value).
        """
        return self._hebb.weights()

    @property
    def input_shape(self) -> tuple[int, ...]:
        """Neurons along the axes of the input map."""
        return tuple(self._hebb.input_shape())

    @property
    def movements(self) -> int:
        """Movements babbled, legal or not."""
        return self._hebb.movements

    @property
    def legal_movements(self) -> int:
        """Legal movements, which were learnt from."""
        return self._hebb.legal

    @property
    def legal_rate(self) -> float:
        """Share of the babbled movements that were legal; NaN before the first."""
        return self.legal_movements / self.movements if self.movements else float("nan")


def _pattern_env(config: str) -> Any:
    return BabbleReachEnv(control="pattern", reward="sparse", config=json.loads(config))
