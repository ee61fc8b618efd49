"""BabbleReach: reach a target around an obstacle."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from gymnasium.vector import AutoresetMode

from gym_babble import _core
from gym_babble.config import ConfigLike, config_json
from gym_babble.envs.choices import Choices, check_flags, check_names, check_whole, numbers
from gym_babble.envs.single import BabbleEnv
from gym_babble.envs.vector import BabbleVectorEnv

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["BabbleReachEnv", "BabbleReachVectorEnv", "ReachChoices"]


class ReachChoices(Choices):
    """The keyword arguments of a reaching environment, checked, and what follows from them."""

    task_name = "reaching"
    case_options = ("start", "target", "obstacle")
    envs_per_thread = 64
    task: _core.ReachTask

    def __init__(
        self,
        *,
        obs: str,
        control: str,
        reward: str,
        config: ConfigLike,
        settled: bool,
        max_episode_steps: int,
        render_mode: str | None,
        **pictures: Any,
    ) -> None:
        check_names(control=control, reward=reward)
        check_flags(settled=settled)
        check_whole("max_episode_steps", max_episode_steps, 1, 1_000_000, "control steps")
        task = _core.ReachTask(
            config_json(config),
            control=control,
            reward=reward,
            goal=obs == "goal",
            settled=bool(settled),
            # A movement is an episode, whatever limit was registered for other controls.
            max_episode_steps=1 if control == "pattern" else max_episode_steps,
            record=render_mode is not None,
        )
        super().__init__(task, obs=obs, render_mode=render_mode, **pictures)
        self.control = control

    def part_of_case(self, name: str, value: Any) -> list[float] | None:
        """A position (x, y), or the obstacle (x, y, radius) [m]; of (x, y) it has the config's."""
        if name != "obstacle":
            return numbers(name, value, 2)
        if isinstance(value, Sequence | np.ndarray) and len(value) == 2:
            value = (*value, self.task.obstacle_radius)
        return numbers(name, value, 3)

    @property
    def joint_range(self) -> NDArray[np.float64]:
        """Widths of the joint ranges (2,) [rad]."""
        return np.array(self.task.joint_range)

    @property
    def delta_posture(self) -> float:
        """Change of an equilibrium point by an action of 1 [rad]."""
        return self.task.delta_posture

    @property
    def b_range(self) -> tuple[float, float]:
        """Lowest and highest b1 and b2."""
        low, high = self.task.b_range
        return low, high


class BabbleReachEnv(BabbleEnv):
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

    metadata: dict[str, Any] = {**BabbleEnv.metadata, "render_fps": 20}  # noqa: RUF012 - Gymnasium's
    choices_type = ReachChoices

    def __init__(
        self,
        render_mode: str | None = None,
        *,
        obs: str = "senses",
        control: str = "delta_posture",
        reward: str = "progress",
        config: ConfigLike = "paper",
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
            config: A profile ("paper", "icub"), the path of a TOML or JSON file, a dict of what
                differs from a profile, or a `gym_babble.Config`.
            settled: Whether success also needs the arm to have come to rest.
            max_episode_steps: Time limit in control steps; none is needed in `pattern` control.
            camera: "third_person", "eye", "fovea" (the middle 63 × 63 pixels of the eye's image) or
                "edges" (in the fovea).
            width: Width of a picture [pixel].
            height: Height of a picture [pixel].
            retina_size: Edge of the eye's image in obs="retina" [pixel]; 630 is the paper's.

        Raises:
            ConfigError: An argument or a config field is not one there is.
        """
        super().__init__(
            render_mode=render_mode,
            obs=obs,
            control=control,
            reward=reward,
            config=config,
            settled=settled,
            max_episode_steps=max_episode_steps,
            camera=camera,
            width=width,
            height=height,
            retina_size=retina_size,
        )


class BabbleReachVectorEnv(BabbleVectorEnv):
    """A batch of `BabbleReachEnv`, what `gymnasium.make_vec` makes by default.

    Seeds, autoresets and options: see `BabbleVectorEnv`.

    Args:
        num_envs: How many environments.
        render_mode: "rgb_array", "rgb_array_list" or None.
        autoreset_mode: When an ended episode begins anew.
        threads: Threads that step the batch; one for each 64 environments, up to the number of
            processors, if not given. Results do not depend on it.
        obs, control, reward, config, settled, max_episode_steps, camera, width, height,
            retina_size: As for `BabbleReachEnv`.

    Raises:
        ConfigError: An argument or a config field is not one there is.
    """

    metadata: dict[str, Any] = {**BabbleVectorEnv.metadata, "render_fps": 20}  # noqa: RUF012 - Gymnasium's
    choices_type = ReachChoices

    def __init__(
        self,
        num_envs: int = 1,
        render_mode: str | None = None,
        *,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        threads: int | None = None,
        obs: str = "senses",
        control: str = "delta_posture",
        reward: str = "progress",
        config: ConfigLike = "paper",
        settled: bool = False,
        max_episode_steps: int = 240,
        camera: str = "third_person",
        width: int = 480,
        height: int = 480,
        retina_size: int = 84,
    ) -> None:
        super().__init__(
            num_envs,
            autoreset_mode=autoreset_mode,
            threads=threads,
            render_mode=render_mode,
            obs=obs,
            control=control,
            reward=reward,
            config=config,
            settled=settled,
            max_episode_steps=max_episode_steps,
            camera=camera,
            width=width,
            height=height,
            retina_size=retina_size,
        )
