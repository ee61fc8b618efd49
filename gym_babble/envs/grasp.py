"""BabbleGrasp: reach for an object and grasp it."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from gymnasium.vector import AutoresetMode

from gym_babble import _core
from gym_babble.config import ConfigLike, config_json
from gym_babble.envs.choices import Choices, check_flags, check_names, check_whole, numbers
from gym_babble.envs.single import BabbleEnv
from gym_babble.envs.vector import BabbleVectorEnv
from gym_babble.errors import ConfigError, ScenarioError

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["BabbleGraspEnv", "BabbleGraspVectorEnv", "GraspChoices", "grasp_config"]


def grasp_config(
    config: ConfigLike, diameters: Sequence[float] | None, *, any_diameter_between: bool
) -> str:
    """The config of `config` as JSON, with the diameters of the objects replaced if given [m].

    Raises:
        ConfigError: A name, field or value is not one there is.
    """
    text = config_json(config)
    if diameters is None and not any_diameter_between:
        return text
    document = json.loads(text)
    if diameters is not None:
        document["grasp"]["diameters_m"] = _diameters(diameters)
    if any_diameter_between:
        document["grasp"]["any_diameter_between"] = True
    return config_json(document)


def _diameters(given: Sequence[float]) -> list[float]:
    try:
        found = [float(d) for d in given]
    except (TypeError, ValueError) as error:
        raise ConfigError(f"diameters = {given!r} is not a list of numbers [m]") from error
    if not all(map(math.isfinite, found)):
        raise ConfigError(f"diameters = {given!r}: they must be finite and in [0.005, 0.2] m")
    return found


class GraspChoices(Choices):
    """The keyword arguments of a grasping environment, checked, and what follows from them."""

    task_name = "grasping"
    case_options = ("start", "object", "diameter", "goal", "obstacle")
    envs_per_thread = 4
    task: _core.GraspTask

    def __init__(
        self,
        *,
        obs: str,
        control: str,
        reward: str,
        config: ConfigLike,
        region: str,
        diameters: Sequence[float] | None,
        any_diameter_between: bool,
        enclosure_reflex: bool,
        max_episode_steps: int | None,
        render_mode: str | None,
        **pictures: Any,
    ) -> None:
        check_names(control=control, reward=reward, region=region)
        check_flags(any_diameter_between=any_diameter_between, enclosure_reflex=enclosure_reflex)
        if max_episode_steps is not None:
            check_whole("max_episode_steps", max_episode_steps, 1, 1_000_000, "control steps")
        task = _core.GraspTask(
            grasp_config(config, diameters, any_diameter_between=any_diameter_between),
            control=control,
            reward=reward,
            goal=obs == "goal",
            region=region,
            enclosure_reflex=bool(enclosure_reflex),
            max_episode_steps=max_episode_steps,
            record=render_mode is not None,
        )
        super().__init__(task, obs=obs, render_mode=render_mode, **pictures)
        self.control, self.region = control, region

    def part_of_case(self, name: str, value: Any) -> Any:
        """Two numbers, a diameter, or the obstacle (x, y, radius); of (x, y) it is the config's."""
        if name == "diameter":
            if value is None:
                return None
            try:
                return float(value)
            except (TypeError, ValueError) as error:
                raise ScenarioError(f"diameter = {value!r} is not a number [m]") from error
        if name != "obstacle":
            return numbers(name, value, 2, "rad" if name == "start" else "m")
        if isinstance(value, Sequence | np.ndarray) and len(value) == 2:
            value = (*value, self.task.obstacle_radius)
        return numbers(name, value, 3)

    @property
    def ranges(self) -> NDArray[np.float64]:
        """Lowest and highest equilibrium points of the four joint groups (4, 2) [rad]."""
        return np.array(self.task.ranges)

    @property
    def reflex(self) -> NDArray[np.float64]:
        """Flexions that the enclosure reflex asks of thumb and fingers (2,) [rad]."""
        return np.array(self.task.reflex)

    @property
    def delta_posture(self) -> float:
        """Change of an equilibrium point by an action of 1 [rad]."""
        return self.task.delta_posture


class BabbleGraspEnv(BabbleEnv):
    """Reach for an object and grasp it with a simulated eye-arm-hand.

    ## Description

    The second model of Caligiore et al. (2008). Arm and hand of iCub's size move in a horizontal
    plane: upper arm 15 cm, forearm 13 cm, a hand of 11.6 cm on edge with a thumb and four fingers
    that flex as one ("virtual finger"). Muscles (Eq. 2) pull all joints towards equilibrium points
    with a time constant of 1 s. A red sphere rests on a support that touches nothing else; the palm
    faces counter-clockwise. An eye above follows the sphere by a reflex (Eq. 1, from pixels, one
    step a control step, after it has found it at the start); arm and hand can hide it, and while
    they hide all of it the eye stays. Contacts and friction are simulated.

    A grasp counts when finger and thumb, or finger and palm, enclose the object for a second; the
    support is then taken away and the hand has to hold it for another second. Contact alone, or
    nearness alone, would be fooled by a ball that is wedged between hand and support.

    ## Action space

    `Box(-1, 1, (4,), float32)`; its meaning depends on `control`:

    | control | 0 | 1 | 2 | 3 | meaning |
    | --- | --- | --- | --- | --- | --- |
    | `delta_posture` | shoulder | elbow | thumb | finger | ±1 = ±5° on the equilibrium points |
    | `posture` | shoulder | elbow | thumb | finger | equilibrium points, −1…1 over the ranges |
    | `torque` | shoulder | elbow | thumb | finger | T = action · 200 (hand .5) N·m − K_D q̇ |

    Thumb and finger are flexions of each of their joints, 0 (open) to 90°. Actions outside of
    [−1, 1] are clipped; NaN and infinity raise `ActionError`.

    ## Observation space

    `obs="senses"` is a Dict of:

    | sense | size | low | high | unit |
    | --- | --- | --- | --- | --- |
    | `eye` | 2 | 0 | 1 | pan and tilt, share of range |
    | `fovea` | 441 | 0 | 1 | edges (Sobel) in the image's middle 63 × 63, in 21 × 21 blocks |
    | `arm` | 2 | 0 | 1 | shoulder and elbow, share of range |
    | `hand` | 2 | 0 | 1 | flexion of thumb and virtual finger, share of range |
    | `stretch` | 4 | −range | range | equilibrium point minus angle [rad]; in torque ±1 |
    | `touch` | 3 | 0 | 1 | normal force of palm, thumb, fingers on the object over 20 N |
    | `time` | 1 | 0 | 1 | share of the episode |

    `"flat"` is the same in one Box(455,), in this order. `"goal"` is a Dict of `observation`
    (flat), `achieved_goal` (the object's centre) and `desired_goal` (where it is to be carried),
    (x, y) [m]. `"retina"` is the senses and the eye's image, `retina_size` × `retina_size` × 3,
    uint8.

    ## Rewards

    - `progress` (terms progress + enclosure + success + failure): decrease of the distance between
      the object and the hollow of the hand over 10 cm; increase of the share of the last second
      with a finger's contact plus that with the thumb's or the palm's, halved; +1 for success; −1
      for a lost object or a collision.
    - `sparse`: 1 for success, else 0.
    - with `obs="goal"`: 0 with the object's centre within 2 cm of the goal, else −1;
      `compute_reward` gives the same.

    ## Starting state

    The hand is open, the arm at rest and at least 5 mm from the object; the object's diameter is
    one of `diameters`. `region="palm_side"`: distance of the object from the shoulder uniform in
    15–29 cm, direction in 40–160°, shoulder in −75…−15°, elbow in 5–90° (body `icub`: direction
    90–160°, shoulder −10…10°, elbow 15–90°). `"full"`: 13–29 cm, −20…160°, all postures. In both
    some posture brings the palm to the object. The goal is drawn as the object is, 5 cm from it
    or more.

    ## Episode end

    - `success` (terminated): the hand has held the object without support for a second.
    - `lost` (terminated): the hand has not held it, or the object is out of the arm's reach, or,
      with `obs="goal"`, was dropped after it had been held.
    - `collision` (terminated): arm or hand touches the obstacle, if one was asked for.
    - `timeout`: truncated after 240 steps (12 s), 500 in region `full`.

    With `obs="goal"` nothing terminates: after `lost` or `collision` everything stays as it is
    until the time limit, and `achieved_goal` is beyond all goals, so that an object dropped at its
    goal earns nothing; else the outcome is `success` if the object is at the goal then.

    ## Info

    `is_success` (now), `ever_success` (in this episode), `reach` (any part of arm or hand has
    touched the object), `palm_reach` (the palm has), `held` (the hand has held it without support),
    `outcome` (running, success, collision, timeout, lost), `reward_terms`.

    ## Arguments

    Those of `__init__` below; each is a keyword of `gymnasium.make` too, but for
    `max_episode_steps`: `gymnasium.make(id, max_episode_steps=n)` keeps it for its TimeLimit
    wrapper, which truncates after n steps with the outcome still `running`.
    `gymnasium.make_vec(id, max_episode_steps=n)` and `BabbleGraspEnv(max_episode_steps=n)` set the
    time limit itself.

    `reset(options=...)` takes `scenario` (see `gym_babble.scenarios`), or any of `start` (shoulder,
    elbow) [rad], `object` (x, y), `diameter`, with `obs="goal"` `goal` (x, y), and `obstacle`
    (x, y), (x, y, radius) or None [m]; what is not given is drawn, and there is no obstacle.
    Options hold for the resets that follow, until a reset that names others; `{}` names none.

    ## Version history

    - v0: first.
    """

    metadata: dict[str, Any] = {**BabbleEnv.metadata, "render_fps": 20}  # noqa: RUF012 - Gymnasium's
    choices_type = GraspChoices

    def __init__(
        self,
        render_mode: str | None = None,
        *,
        obs: str = "senses",
        control: str = "delta_posture",
        reward: str = "progress",
        config: ConfigLike = "paper",
        region: str = "palm_side",
        diameters: Sequence[float] | None = None,
        any_diameter_between: bool = False,
        enclosure_reflex: bool = False,
        max_episode_steps: int | None = None,
        camera: str = "third_person",
        width: int = 480,
        height: int = 480,
        retina_size: int = 84,
    ) -> None:
        """Makes the environment.

        Args:
            render_mode: "rgb_array", "rgb_array_list", "human" (needs the extra `human`), or None.
            obs: "senses", "flat", "goal" or "retina".
            control: "delta_posture", "posture" or "torque".
            reward: "progress" or "sparse"; "sparse" with obs="goal".
            config: A profile ("paper", "icub"), the path of a TOML or JSON file, a dict of what
                differs from a profile, or a `gym_babble.Config`.
            region: "palm_side" or "full": where objects lie and arms start.
            diameters: Of the objects [m], to draw from; the config's 2.4 and 6 cm if not given.
            any_diameter_between: Draw from all diameters between the smallest and the largest, as
                a config can say too.
            enclosure_reflex: Whether the hand closes by reflex from the first touch of the palm on,
                whatever the action.
            max_episode_steps: Time limit in control steps; 240, or 500 in region "full", if not
                given.
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
            region=region,
            diameters=diameters,
            any_diameter_between=any_diameter_between,
            enclosure_reflex=enclosure_reflex,
            max_episode_steps=max_episode_steps,
            camera=camera,
            width=width,
            height=height,
            retina_size=retina_size,
        )


class BabbleGraspVectorEnv(BabbleVectorEnv):
    """A batch of `BabbleGraspEnv`, what `gymnasium.make_vec` makes by default.

    Seeds, autoresets and options: see `BabbleVectorEnv`.

    Args:
        num_envs: How many environments.
        render_mode: "rgb_array", "rgb_array_list" or None.
        autoreset_mode: When an ended episode begins anew.
        threads: Threads that step the batch; one for each 4 environments, up to the number of
            processors, if not given. Results do not depend on it.
        obs, control, reward, config, region, diameters, any_diameter_between, enclosure_reflex,
        max_episode_steps, camera, width, height, retina_size: As for `BabbleGraspEnv`.

    Raises:
        ConfigError: An argument or a config field is not one there is.
    """

    metadata: dict[str, Any] = {**BabbleVectorEnv.metadata, "render_fps": 20}  # noqa: RUF012 - Gymnasium's
    choices_type = GraspChoices

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
        region: str = "palm_side",
        diameters: Sequence[float] | None = None,
        any_diameter_between: bool = False,
        enclosure_reflex: bool = False,
        max_episode_steps: int | None = None,
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
            region=region,
            diameters=diameters,
            any_diameter_between=any_diameter_between,
            enclosure_reflex=enclosure_reflex,
            max_episode_steps=max_episode_steps,
            camera=camera,
            width=width,
            height=height,
            retina_size=retina_size,
        )
