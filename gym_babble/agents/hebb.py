"""The paper's agent: motor babbling and a Hebb rule."""

from __future__ import annotations

import json
from collections.abc import Mapping
from copy import copy
from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble import _core
from gym_babble.agents.babbling import experiences_of
from gym_babble.agents.base import Planner, interface_of
from gym_babble.brain import is_own, rule_numbers, teach
from gym_babble.checks import (
    check_choice,
    check_flag,
    check_seed,
    check_threads,
    check_whole,
    plain,
    shaped,
    shown,
)
from gym_babble.envs.interface import Interface
from gym_babble.envs.registry import task_entry
from gym_babble.errors import AgentFileError, ConfigError
from gym_babble.files import read_agent, write_file
from gym_babble.progress import track

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from numpy.typing import ArrayLike, NDArray

    from gym_babble.agents.babbling import Experiences
    from gym_babble.agents.base import EnvLike, Observation
    from gym_babble.brain import OwnRule, RuleLike

__all__ = ["VARIANTS", "HebbBabbling"]

VARIANTS = ("paper", "conjunctive", "chain")
# How many babbles the paper's agent of a task learns from, and how many it learns from together.
PAPER = {"reach": (20_000, 250), "grasp": (1_000, 50)}
# Trials that `practise` learns from together.
ROUND = 50
# The most that it learns from together, so that their experiences fit into memory.
MOST_TOGETHER = 100_000
# The environment that an agent from a file acts in, by its task.
ACTS_IN = {"reach": {"control": "pattern", "reward": "sparse"}, "grasp": {}}


class HebbBabbling(Planner):
    """Learns by motor babbling (Caligiore et al. 2008).

    In reaching (Sect. III) it makes random movements; from each one that neither touches the
    obstacle nor leaves the joint ranges, the rule connects the obstacle's place in the eye-centred
    map with the movement's parameters (b1, b2). Seeing an obstacle then recalls a movement (Eq. 4).

    In grasping (Sect. IV) it babbles with the object in the hand: the enclosure reflex closes the
    hand, the arm moves to a random posture, and the rule connects the eye's posture with the arm's,
    and the fovea's edges with the hand's. The sight of an object then recalls both.

    The variant "chain" in grasping goes beyond the paper. In a babble the hand closes on the
    object, carries it, opens, withdraws, turns away, looks, returns, advances until the palm
    touches, and closes again. If the hand then feels the object between its sides, the rule
    connects what was seen (the eye's posture and the object's size) with the arm's posture before
    the grasp, its posture at contact, and the hand's. `practise` teaches it when to go around the
    object first.

    Args:
        env: An id or an environment; it decides the task, its config is babbled with, and its
            control decides how the agent acts.
        variant: "paper"; in reaching "conjunctive": obstacle and target in one map of pairs, and a
            readout around the strongest neuron; in grasping "chain": see above.
        rule: The learning rule: "covariance" (Eq. 7; the default, except for "chain"), "hebb",
            "oja" or "outstar" (the default for "chain"); an instance of the classes in
            `gym_babble.brain`; or a function of your own (`gym_babble.brain.OwnRule`).
        seed: Seed of the babbling.
        quasi_static: In reaching, babble without the muscles' lag: faster, and less like the paper.
        shuffled: Pair what is seen in a babble with what was done in the one before, moment by
            moment: a control that learns from the same percepts and actions, but not which belong
            together. Nothing is learnt from the first babble.
        threads: Threads that babble and learn; all processors if not given. Results do not depend
            on it.
        brain: Numbers of maps and rule that differ from the variant's, e.g.
            `{"sigma": 1.0, "rule": {"eta": 0.5}}`; `agent.brain` has them all.

    Raises:
        ConfigError: An argument or a number of the brain is unknown or out of bounds.
    """

    _core: _core.Learner

    def __init__(
        self,
        env: EnvLike = "BabbleReachPattern-v0",
        variant: str = "paper",
        *,
        rule: RuleLike | None = None,
        seed: int = 0,
        quasi_static: bool = False,
        shuffled: bool = False,
        threads: int | None = None,
        brain: Mapping[str, Any] | None = None,
    ) -> None:
        super().__init__(env)
        seed, self._threads = check_seed(seed), check_threads(threads)
        task = self._interface.entry.name
        numbers = json.loads(_core.brain_json(task, check_choice("variant", variant, VARIANTS)))
        if rule is not None:
            numbers["rule"] = rule_numbers(rule)
        _merge(numbers, _changes(brain), "brain")
        self._rule: OwnRule | None = rule if is_own(rule) else None  # type: ignore[assignment]
        babbling = {"quasi_static": True} if check_flag("quasi_static", quasi_static) else None
        self._core = _core.Learner(
            self._interface.task,
            json.dumps(numbers),
            seed,
            json.dumps(babbling),
            check_flag("shuffled", shuffled),
            self._threads,
        )
        self._core.check(self._interface.task)

    def learn(
        self,
        babbles: int | None = None,
        *,
        progress_bar: bool = False,
        callback: Callable[[HebbBabbling], bool | None] | None = None,
        callback_every: int | None = None,
    ) -> HebbBabbling:
        """Babbles until so many more babbles could be learnt from, and learns from these.

        Interrupted by Ctrl-C, the agent is as after its last call of `callback`, and can go on from
        there. What it learns does not depend on `callback_every`.

        Args:
            babbles: Legal movements, or objects kept in the hand, to learn from; the paper's 20,000
                or 1,000 if not given.
            progress_bar: Show a bar with the time left.
            callback: Called with the agent as it learns. It returns None to go on, or a truth
                value, of which a false one stops.
            callback_every: After how many babbles that were learnt from it is called, from 1 on;
                250 in reaching and 50 in grasping if not given.

        Returns:
            The agent itself.

        Raises:
            ConfigError: An argument is not a whole number within its bounds, the environment that
                the agent acts in has another config than the agent was made with, or the rule of
                your own returns no Δw: the agent is then as after the last call of `callback`.
            ScenarioError: Hardly any babble can be learnt from.
            BusyError: Another thread uses the agent.
        """
        paper, every = PAPER[self._interface.entry.name]
        babbles = paper if babbles is None else babbles
        every = every if callback_every is None else callback_every
        babbles = check_whole("babbles", babbles, 0, 100_000_000, "babbles")
        every = check_whole("callback_every", every, 1, MOST_TOGETHER, "babbles")
        show = check_flag("progress_bar", progress_bar)
        if callback is not None and not callable(callback):
            raise ConfigError(f"callback = {shown(callback)} is not a function")
        rule = None if self._rule is None else teach(self._rule, self.brain["rule"])
        chunks = (min(every, babbles - done) for done in range(0, babbles, every))
        with self._core:
            for chunk in track(chunks, "babbling", total=babbles, show=show):
                self._core.learn(self._interface.task, chunk, rule)
                go_on = None if callback is None else callback(self)
                if go_on is not None and not go_on:
                    break
        return self

    def practise(self, trials: int, *, progress_bar: bool = False) -> HebbBabbling:
        """Tries to grasp objects all over the plane, and learns from the results; variant "chain".

        A trial is an episode of region `full` with 500 control steps at most. The agent goes
        straight to the object or around it, in one of 60 ways, and learns by reward which route
        to take. Trial k depends on the seed, on what was babbled, and on the trials before.

        Args:
            trials: How many; a multiple of 50, as 50 are made before all of them are learnt from.
            progress_bar: Show a bar with the time left.

        Returns:
            The agent itself.

        Raises:
            ConfigError: The number is out of bounds, another variant learns from babbles alone, or
                the environment that the agent acts in has another config than it was made with.
            BusyError: Another thread uses the agent.
        """
        trials = check_whole("trials", trials, 0, 100_000_000, "trials")
        show = check_flag("progress_bar", progress_bar)
        rounds = [ROUND] * (trials // ROUND) + [trials % ROUND] * (trials % ROUND > 0)
        with self._core:
            for some in track(rounds, "practising", total=trials, show=show):
                self._core.practise(self._interface.task, some)
        return self

    def _senses(self, observation: Observation) -> NDArray[np.float32]:
        """Flat senses, for "chain" in the goal form with the goal after them."""
        senses = super()._senses(observation)
        goal = observation.get("desired_goal") if isinstance(observation, dict) else None
        if goal is None or self.variant != "chain":
            return senses
        return np.concatenate([senses, _goals(goal, senses.shape[:-1])], axis=-1)

    def decide(self, observation: Observation) -> NDArray[np.float64]:
        """What the maps are read out as for one observation (k,), or for n of them (n, k).

        In reaching, parameters (b1, b2) of a movement. In grasping, shoulder and elbow as shares of
        their ranges, and equilibrium points of thumb and finger as the paper counts them,
        EP = 90° − flexion [deg]; for "chain" first shoulder and elbow before the grasp.

        Args:
            observation: As the environment gives it, of any `obs=`; or the percepts of `babble`.
        """
        senses = self._senses(observation)
        decided = self._core.decide(np.atleast_2d(senses))
        return decided if senses.ndim > 1 else decided[0]

    def recall(self, observation: Observation) -> dict[str, NDArray[np.float32]]:
        """Activities of the output maps (n, n) that one observation calls up, by name.

        In reaching `movement`, whose columns are b1 and rows b2; in grasping `arm`, whose columns
        are the shoulder and rows the elbow, and `hand`, thumb and finger.

        Args:
            observation: As the environment gives it, of any `obs=`.
        """
        return self._core.recall(self._one("recall", observation))

    def perceive(self, observation: Observation) -> dict[str, NDArray[np.float32]]:
        """Activities of the input maps for one observation, by name, in the order of `recall`.

        In reaching `obstacle`, whose columns are the azimuth and rows the elevation; for the
        conjunctive variant `target_obstacle`, with the axes tilt and pan of the target, then
        elevation and azimuth of the obstacle. In grasping `eye`, whose columns are the pan and rows
        the tilt, and `fovea`, the eye's edges row by row from the top.

        Args:
            observation: As the environment gives it, of any `obs=`.
        """
        return self._core.perceive(self._one("perceive", observation))

    def _one(self, name: str, observation: Observation) -> NDArray[np.float32]:
        """Flat senses (m,) of one observation.

        Raises:
            ConfigError: They are those of several.
        """
        senses = self._senses(observation)
        if senses.ndim > 1:
            raise ConfigError(f"{name} takes one observation, got {len(senses)}")
        return senses

    def untaught(self) -> HebbBabbling:
        """A copy that has not babbled yet.

        It learns the same as this one has learnt, unless this one went on in another environment
        (`continue_in`).
        """
        agent = copy(self)
        agent._core = _core.Learner(  # noqa: SLF001 - its own
            self._babbles_in.task,
            json.dumps(self.brain),
            self.seed,
            self._core.babbling(),
            self.shuffled,
            self._threads,
        )
        return agent

    def continue_in(self, env: EnvLike) -> HebbBabbling:
        """A copy that acts and learns on in another environment of the task.

        For a body that changes after learning: the copy knows what this agent knows, and from now
        on babbles in the body (and with the noise) of `env`. Its babbles are numbered on.

        Args:
            env: An id or an environment of the same task, of any config.

        Raises:
            ConfigError: It is not an environment of this agent's task, or the agent cannot act in
                its control.
        """
        interface = interface_of(env)
        if interface.entry.name != self._interface.entry.name:
            raise ConfigError(
                f"{env!r} is not a Babble environment for {self._interface.entry.title}"
            )
        agent = copy(self)
        agent._interface = interface  # noqa: SLF001 - its own
        agent._core = _core.Learner.load(self._core.save(), self._threads)  # noqa: SLF001 - its own
        agent._core.check(interface.task)  # noqa: SLF001 - its own
        agent._core.move_to(interface.task)  # noqa: SLF001 - its own
        return agent

    def to_bytes(self) -> bytes:
        """The bytes of the file that `save` writes."""
        return self._core.save()

    def save(self, path: str | Path) -> None:
        """Writes the agent: weights as safetensors, all else as JSON in its metadata.

        The config is that which the agent babbles with, wherever it acts. A rule of your own is not
        written: pass it to `load`. An earlier file is replaced once the new one is complete.

        Raises:
            OSError: The file cannot be written; an earlier one is whole.
        """
        write_file(path, self.to_bytes())

    @classmethod
    def load(
        cls,
        path: str | Path,
        env: EnvLike | None = None,
        *,
        rule: OwnRule | None = None,
        threads: int | None = None,
    ) -> HebbBabbling:
        """Reads an agent.

        Args:
            path: The file.
            env: Environment to act in; if not given, one of its task with the config that it
                babbled with, in reaching with `pattern` control. With another config it acts;
                `continue_in` lets it learn on there.
            rule: The rule of your own that it learnt by, to learn on.
            threads: As for the class.

        Raises:
            FileNotFoundError: There is no such file.
            AgentFileError: The file is cut short, altered, or not an agent.
            ConfigError: It cannot act in the environment, or learnt by a rule of the core.
        """
        data = read_agent(path)
        try:
            core = _core.Learner.load(data, check_threads(threads))
        except ValueError as error:
            raise AgentFileError(f"{path}: {error}") from error
        _check_own(rule, json.loads(core.brain())["rule"]["name"])
        agent = cls.__new__(cls)
        agent._threads, agent._rule = check_threads(threads), rule  # noqa: SLF001 - its own
        agent._core = core  # noqa: SLF001 - its own
        if env is None:
            agent._interface = _interface_where(core)  # noqa: SLF001 - its own
        else:
            agent._interface = interface_of(env)  # noqa: SLF001 - its own
            if agent._interface.entry.name != core.task():  # noqa: SLF001 - its own
                title = task_entry(core.task()).title
                raise ConfigError(f"{env!r} is not a Babble environment for {title}")
        core.check(agent._interface.task)  # noqa: SLF001 - its own
        return agent

    @property
    def brain(self) -> dict[str, Any]:
        """Numbers of maps and rule."""
        return json.loads(self._core.brain())  # type: ignore[no-any-return]

    @property
    def variant(self) -> str:
        """Which variant this is: "paper", "conjunctive" or "chain"."""
        return str(self.brain.get("variant", "paper"))

    @property
    def shuffled(self) -> bool:
        """Whether it learns from shuffled pairs."""
        return self._core.shuffled()

    @property
    def weights(self) -> dict[str, NDArray[np.float32]]:
        """Copies of the weights and running averages, by name; assign such a dict to set them.

        In reaching `weights` (output neurons, input neurons) is w_ji of Eq. 7, and `a_mean` and
        `g_mean` are the running averages of output and input. In grasping there are `reach.weights`
        (arm neurons, eye neurons), `grasp.weights` (hand neurons, fovea neurons), and so on. Neuron
        j of a map of n × n stands in column j % n (first value) and row j // n (second value).
        """
        return self._core.weights()

    @weights.setter
    def weights(self, weights: Mapping[str, ArrayLike]) -> None:
        known = self.weights
        if not isinstance(weights, Mapping):
            raise ConfigError(f"weights = {shown(weights)} is not a dict")
        unknown = set(weights) - set(known)
        if unknown:
            raise ConfigError(
                f"weights: {sorted(map(str, unknown))} unknown; there are {', '.join(known)}"
            )
        parts = {
            name: shaped(name, weights.get(name, old), old.shape) for name, old in known.items()
        }
        self._core.set(
            [
                (parts[f"{prefix}weights"], parts[f"{prefix}a_mean"], parts[f"{prefix}g_mean"])
                for prefix in self._core.prefixes()
            ]
        )

    @property
    def input_shape(self) -> tuple[int, ...]:
        """Neurons along the axes of the (first) input map."""
        return tuple(self._core.input_shapes()[0])

    @property
    def babbled(self) -> int:
        """Babbles made, whether they could be learnt from or not."""
        return self._core.counts()[1]

    @property
    def learnt(self) -> int:
        """Babbles learnt from: the legal movements, or the objects kept in the hand."""
        return self._core.counts()[2]

    @property
    def learnt_rate(self) -> float:
        """Share of the babbles that could be learnt from; NaN before the first."""
        return self.learnt / self.babbled if self.babbled else float("nan")

    @property
    def seed(self) -> int:
        """Seed of the babbling."""
        return self._core.counts()[0]

    def experiences(self) -> Experiences:
        """What it has learnt from, in its order, made again: it keeps none.

        After `continue_in` all are made in the new environment. Percepts are with their own
        actions, also if it learns from shuffled pairs.
        """
        seed, babbled, _ = self._core.counts()
        options = self._core.babbling()
        made = experiences_of(
            self._babbles_in,
            babbled,
            seed,
            options,
            period_s=self.brain.get("learning_period_s"),
            threads=self._threads,
        )
        return made[made.learnable]

    @property
    def steps_per_babble(self) -> int:
        """Control steps that a babble takes."""
        return self._core.babble_steps(self._babbles_in.task)

    @property
    def practised(self) -> int:
        """Trials that `practise` has learnt from."""
        return self._core.practice()[0]

    @property
    def control_steps(self) -> int:
        """Control steps of all babbles and trials, whether learnt from or not."""
        return self.babbled * self.steps_per_babble + self._core.practice()[1]

    @property
    def _babbles_in(self) -> Interface:
        """What it babbles in: what it acts in, or an environment of the config it was made with."""
        same = self._core.config() == self._interface.task.config()
        return self._interface if same else _interface_where(self._core)

    def __getstate__(self) -> dict[str, Any]:
        return {**super().__getstate__(), "_saved": self._core.save()}

    def __setstate__(self, state: Mapping[str, Any]) -> None:
        super().__setstate__({k: v for k, v in state.items() if k != "_saved"})
        self._core = _core.Learner.load(state["_saved"], self._threads)


def _interface_where(core: _core.Learner) -> Interface:
    """An environment of the config that an agent babbles with."""
    task = core.task()
    config = json.loads(core.config())
    return Interface(task, config=config, render_mode=None, options=ACTS_IN[task])


def _check_own(rule: Any, name: str) -> None:
    """Checks the rule that an agent from a file is given; its own is called `name`.

    Raises:
        ConfigError: It is not a function, or the agent learnt by a rule of the core.
    """
    if rule is None:
        return
    if not is_own(rule):
        raise ConfigError(f"rule = {rule!r} is not a function; the file has the rules of the core")
    if name != "own":
        raise ConfigError(f"rule: the agent learnt by {name!r}, and not by a rule of your own")


def _changes(brain: Any) -> dict[str, Any]:
    """Numbers of a brain that a user changes, as JSON has them.

    Raises:
        ConfigError: It is not a dict, or a number is not finite.
    """
    if brain is None:
        return {}
    if not isinstance(brain, Mapping):
        raise ConfigError(f"brain = {shown(brain)} is not a dict")
    return dict(plain(brain, "brain"))


def _merge(numbers: dict[str, Any], changes: Mapping[str, Any], path: str) -> None:
    """Replaces numbers of a brain.

    Raises:
        ConfigError: A field is unknown.
    """
    for name, value in changes.items():
        if name not in numbers:
            raise ConfigError(f"{path}.{name}: unknown field; there are {', '.join(numbers)}")
        if isinstance(numbers[name], dict) and isinstance(value, dict):
            _merge(numbers[name], value, f"{path}.{name}")
        else:
            numbers[name] = value


def _goals(given: Any, shape: tuple[int, ...]) -> NDArray[np.float32]:
    """Places to carry objects to (2,) or (n, 2) [m].

    Raises:
        ConfigError: They are not finite numbers, or have another shape than the observation.
    """
    try:
        goals = np.asarray(given, np.float32)
    except (OverflowError, TypeError, ValueError) as error:
        raise ConfigError(f"desired_goal = {shown(given)}: {error}") from error
    if goals.shape != (*shape, 2):
        raise ConfigError(f"desired_goal has shape {goals.shape}, expected {(*shape, 2)}")
    return goals
