"""BabbleReach: reach a target around an obstacle."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import gymnasium

from gym_babble import _core
from gym_babble.envs.one import OneEnv
from gym_babble.envs.task import RENDER_MODES, ReachChoices
from gym_babble.envs.window import Window
from gym_babble.scenarios import read_options
from gym_babble.spaces import as_actions

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy as np
    from numpy.typing import NDArray

    from gym_babble.config import BodyLike

__all__ = ["BabbleReachEnv"]


class BabbleReachEnv(gymnasium.Env[Any, Any]):
    """Reach a target around an obstacle with a simulated eye-arm-hand.

    ## Description

    The first model of Caligiore et al. (2008). An arm moves in a horizontal plane: upper arm 15 cm,
    forearm 13 cm, a stretched hand of 11.6 cm that reaches with its fingertips. Muscles (Eq. 2)
    pull shoulder and elbow towards equilibrium points with a time constant of 0.8 s. A vertical
    cylinder stands halfway between the start and the target. An eye above the arm has turned to
    the red target (Eq. 1, from pixels) and stays on it.

    ## Action space

    `Box(-1, 1, (2,), float32)`; its meaning depends on `control`:

    | control | 0 | 1 | meaning |
    | --- | --- | --- | --- |
    | `delta_posture` | shoulder | elbow | ±1 = ±5° on the equilibrium points, in the joint ranges |
    | `posture` | shoulder | elbow | the equilibrium points, −1…1 over the joint ranges |
    | `torque` | shoulder | elbow | T = action · 50 N·m − K_D q̇ |
    | `pattern` | b1 | b2 | b = ½ + action/2 in [.01, .99]: a whole movement, 11.2 s (Eq. 5, 6) |

    Actions outside of [−1, 1] are clipped; NaN and infinity raise `ActionError`.

    ## Observation space

    `obs="senses"` is a Dict of:

    | sense | size | low | high | unit |
    | --- | --- | --- | --- | --- |
    | `eye` | 2 | 0 | 1 | pan and tilt, share of range |
    | `obstacle` | 2 | −π, −π/2 | π, π/2 | azimuth, elevation to the eye [rad]; lowest if none |
    | `hand` | 2 | −π, −π/2 | π, π/2 | azimuth, elevation of the fingertip [rad] |
    | `arm` | 2 | 0 | 1 | shoulder and elbow, share of range |
    | `stretch` | 2 | −range | range | shoulder and elbow: equilibrium point minus angle [rad] |
    | `time` | 1 | 0 | 1 | share of the episode |

    `"flat"` is the same in one Box(11,), in this order. `"goal"` is a Dict of `observation`
    (flat), `achieved_goal` (fingertip) and `desired_goal` (target), (x, y) [m]. `"retina"` is
    the senses and the eye's image, `retina_size` × `retina_size` × 3, uint8.

    ## Rewards

    - `progress` (terms progress + success + failure): decrease of the distance to the target over
      10 cm, +1 for success, −1 for a collision or a joint limit. A return lies in (−8, 4).
    - `sparse`: 1 for success, else 0.
    - with `obs="goal"`: 0 within 2 cm of the target, else −1; `compute_reward` gives the same.

    ## Starting state

    The arm rests at the start of a babbled movement that was legal: target uniform in joint space,
    start 8–25 cm from it in a uniform direction, b1 uniform in (.01, .99), drawn until the movement
    (quasi-static) neither touches the obstacle nor leaves the joint ranges. Body `icub`: 10–20 cm.

    ## Episode end

    - `success` (terminated): first step with the fingertip within 2 cm of the target; with
      `settled=True` also joint speeds below .05 rad/s. In `pattern` control only the end counts.
    - `collision` (terminated): arm or hand touches the obstacle, at any moment within a step. With
      `obs="goal"` the arm stands still until the time limit instead, since ending early would pay.
    - `joint_limit` (terminated): in `pattern` control, the path asks for a posture outside of the
      joint ranges.
    - `timeout`: truncated after 240 steps (12 s); in `pattern` control terminated, as every step.

    ## Info

    `is_success` (now), `ever_success` (in this episode), `outcome` (running, success, collision,
    joint_limit, timeout), `reward_terms`.

    ## Arguments

    Those of `__init__` below; each is a keyword of `gymnasium.make` too, but for
    `max_episode_steps`: `gymnasium.make(id, max_episode_steps=n)` keeps it for its TimeLimit
    wrapper, which truncates after n < 240 steps with the outcome still `running`.
    `gymnasium.make_vec(id, max_episode_steps=n)` and `BabbleReachEnv(max_episode_steps=n)` set the
    time limit itself: outcome `timeout`, and the sense `time` is a share of n. It has no effect in
    `pattern` control.

    `reset(options=...)` takes `scenario` (see `gym_babble.scenarios`), or any of `start` (x, y),
    `target` (x, y) and `obstacle` (x, y), (x, y, radius) or None [m]; what is not given is drawn.
    Options hold for the resets that follow, until a reset that names others; `{}` names none.

    ## Version history

    - v0: first.
    """

    metadata: dict[str, Any] = {  # noqa: RUF012 - declared by gymnasium.Env
        "render_modes": list(RENDER_MODES),
        "render_fps": 20,
    }

    def __init__(
        self,
        render_mode: str | None = None,
        *,
        obs: str = "senses",
        control: str = "delta_posture",
        reward: str = "progress",
        body: BodyLike = "paper",
        settled: bool = False,
        max_episode_steps: int = 240,
        camera: str = "third_person",
        width: int = 480,
        height: int = 480,
        retina_size: int = 84,
    ) -> None:
        """Makes the environment.

        Args:
            render_mode: "rgb_array", "rgb_array_list" (one frame a control step, also within a
                movement in `pattern` control), "human" (needs the extra `human`), or None.
            obs: "senses", "flat", "goal" or "retina".
            control: "delta_posture", "posture", "torque" or "pattern".
            reward: "progress" or "sparse"; "sparse" with obs="goal".
            body: A profile ("paper", "icub"), the path of a TOML or JSON file, a dict of what
                differs from a profile, or a `gym_babble.Config`.
            settled: Whether success also needs the arm to have come to rest.
            max_episode_steps: Time limit in control steps; none is needed in `pattern` control.
            camera: "third_person" or "eye".
            width: Width of a picture [pixel].
            height: Height of a picture [pixel].
            retina_size: Edge of the eye's image in obs="retina" [pixel]; 630 is the paper's.

        Raises:
            ConfigError: An argument or a config field is not one there is.
        """
        self._arguments: dict[str, Any] = {
            "obs": obs,
            "control": control,
            "reward": reward,
            "body": body,
            "settled": settled,
            "max_episode_steps": max_episode_steps,
            "render_mode": render_mode,
            "camera": camera,
            "width": width,
            "height": height,
            "retina_size": retina_size,
        }
        self.render_mode = render_mode
        self._make_core()
        self.observation_space = self._choices.observation_space
        self.action_space = self._choices.action_space
        self.metadata = {**type(self).metadata, "render_fps": self._choices.render_fps}
        self._seeded = False
        self._window: Window | None = None

    def _make_core(self) -> None:
        self._choices = ReachChoices(**self._arguments)
        self._batch = _core.Batch(self._choices.task, 1)
        self._one = OneEnv(self._choices, self._batch, 0)

    @property
    def choices(self) -> ReachChoices:
        """What this environment was made with."""
        return self._choices

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Begins a new episode.

        Args:
            seed: Starts the stream of cases anew.
            options: See the class.

        Raises:
            ConfigError: An option is unknown.
            ScenarioError: The case asked for cannot be played. The options are forgotten, and the
                episode goes on.
        """
        request = None if options is None else read_options(options, self._choices.task)
        super().reset(seed=seed)
        if seed is not None or not self._seeded:
            self._batch.seed(0, int(self.np_random.integers(2**63)))
            self._seeded = True
        if request is not None:
            self._batch.request(0, *request)
        self._batch.reset()
        self._one.begin()
        observation, _, _, _, info = self._look()
        if self.render_mode == "human":
            self._show()
        return observation, info

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """One control step, or one whole movement in `pattern` control.

        Raises:
            ActionError: The action is NaN, infinite or of a wrong shape or type.
            gymnasium.error.ResetNeeded: The episode has ended, or never began.
        """
        self._batch.step_one(as_actions(action, (2,)))
        result = self._look()
        if self.render_mode == "human":
            self._show()
        return result

    def _look(self) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        choices = self._choices
        senses, reward, terminated, truncated, outcome, success, ever, terms = self._batch.one()
        goals = self._batch.one_goals() if choices.obs == "goal" else []
        retina = self._one.retina() if choices.obs == "retina" else None
        info = {
            "is_success": success,
            "ever_success": ever,
            "outcome": choices.spec.outcomes[outcome],
            "reward_terms": dict(zip(choices.spec.reward_terms, terms, strict=True)),
        }
        return choices.observation(senses, goals, retina), reward, terminated, truncated, info

    @property
    def compute_reward(self) -> Callable[[Any, Any, Any], Any]:
        """Reward for achieved and desired goals (2,) or (..., 2) [m], with obs="goal".

        Raises:
            AttributeError: The observations have no goals; stable-baselines3 goes by this.
        """
        if self._choices.obs != "goal":
            raise AttributeError("compute_reward is there with obs='goal'")
        return self._choices.goal_reward

    def render(self) -> Any:
        """A frame (height, width, 3), or the frames since the last call, one a control step.

        In "human" mode the window shows each step by itself and nothing is returned.

        Raises:
            gymnasium.error.ResetNeeded: There was no reset yet.
        """
        if self.render_mode == "human" and self._one.ready:
            return self._show()
        return self._one.render()

    def _show(self) -> None:
        if self._window is None:
            self._window = Window(self._choices.size, self._choices.render_fps)
        for frame in self._one.new_frames():
            self._window.show(frame)

    def close(self) -> None:
        """Closes the window, if there is one."""
        if self._window is not None:
            self._window.close()
            self._window = None

    def get_state(self) -> bytes:
        """The whole state, from which `set_state` continues bit for bit."""
        return self._one.get_state()

    def set_state(self, state: bytes) -> None:
        """Continues from a state of an environment with the same arguments.

        Raises:
            SnapshotError: The bytes are not such a state; the environment is as it was.
        """
        self._one.set_state(state)
        self._seeded = True

    def state_hash(self) -> int:
        """A number that two states share only if they are the same to the bit."""
        return self._one.state_hash()

    @property
    def scenario(self) -> dict[str, Any]:
        """Start, target and obstacle of the running episode [m], as `reset` options."""
        return self._one.scenario

    @property
    def trajectory(self) -> NDArray[np.float64]:
        """The way of the fingertip since the reset (k, 2) [m]; recorded with a render_mode."""
        return self._one.trajectory

    def __getstate__(self) -> dict[str, Any]:
        hidden = ("_batch", "_choices", "_one", "_window")
        state = {k: v for k, v in self.__dict__.items() if k not in hidden}
        return {"attributes": state, "core": self._one.freeze()}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state["attributes"])
        self._make_core()
        self._one.thaw(state["core"])
        self._window = None
