"""BabbleReach: reach a target around an obstacle."""

from __future__ import annotations

from gym_babble.envs.single import BabbleEnv
from gym_babble.envs.vector import BabbleVectorEnv

__all__ = ["BabbleReachEnv", "BabbleReachVectorEnv"]


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
    | `arm` | 2 | 0 | 1 | shoulder and elbow, share of range |
    | `eye` | 2 | 0 | 1 | pan and tilt, share of range |
    | `hand` | 2 | −π, −π/2 | π, π/2 | azimuth, elevation of the fingertip [rad] |
    | `obstacle` | 2 | −π, −π/2 | π, π/2 | azimuth, elevation to the eye [rad]; lowest if none |
    | `stretch` | 2 | −range | range | shoulder and elbow: equilibrium point minus angle [rad] |
    | `time` | 1 | 0 | 1 | share of the episode |

    `"flat"` is the same in one Box(11,), in this order, which is that of Gymnasium's
    `FlattenObservation`. `"goal"` is a Dict of `observation` (flat), `achieved_goal` (fingertip)
    and `desired_goal` (target), (x, y) [m]. `"retina"` is the senses and the eye's image,
    `retina_size` × `retina_size` × 3, uint8.

    ## Rewards

    - `progress` (terms progress + success + failure): decrease of the distance to the target over
      10 cm, +1 for success, −1 for a collision or a joint limit. A return lies in (−8, 4).
    - `sparse`: 1 for success, else 0.
    - with `obs="goal"`: 0 within 2 cm of the target, else −1, and −1 after a failure;
      `compute_reward` gives the same.

    ## Starting state

    The arm rests at the start of a babbled movement that was legal: target uniform in joint space,
    start 8–25 cm from it in a uniform direction, b1 uniform in (.01, .99), drawn again while the
    movement touches the obstacle or leaves the joint ranges. Body `icub`: 10–20 cm. In `pattern`
    control the movement is simulated with the muscles' lag, as for Table I's cases, so that some
    action solves the case; in the other controls without it.

    ## Episode end

    - `success` (terminated): first step with the fingertip within 2 cm of the target; with
      `settled=True` also joint speeds below .05 rad/s. In `pattern` control only the end of the
      movement counts, by the same measure.
    - `collision` (terminated): arm or hand touches the obstacle, at any moment within a step. With
      `obs="goal"` the arm stands still until the time limit instead, or colliding would pay
      (−1 a step), and `achieved_goal` is a corner of its space, for which `compute_reward` is −1
      whatever the goal.
    - `joint_limit` (terminated): in `pattern` control, the path asks for a posture outside of the
      joint ranges.
    - `timeout`: truncated after 240 steps (12 s). In `pattern` control every step terminates;
      the `TimeLimit` of `BabbleReachPattern-v0`, one step, truncates it as well.

    ## Info

    `is_success` (now), `ever_success` (in this episode), `outcome` (running, success, collision,
    joint_limit, timeout): a dict of booleans, one of them True; `reward_terms`: a dict of numbers.
    All are booleans and numbers, so wrappers can make tensors of them.

    ## Arguments

    The options are listed below; each is a keyword of `gymnasium.make` and `make_vec` too.
    `max_episode_steps` has no effect in `pattern` control. `BabbleReachPattern-v0` takes no other
    `control`, because its time limit is one step.

    `reset(options=...)` takes `scenario` (see `gym_babble.scenarios`), or any of `start` (x, y),
    `target` (x, y) and `obstacle` (x, y), (x, y, radius) or None [m]; unspecified
    values are sampled.
    Options hold for the following resets until replaced; pass `{}` to clear them.

    ## Version history

    - v0: first.
    """

    task_name = "reach"


class BabbleReachVectorEnv(BabbleVectorEnv):
    """A batch of `BabbleReachEnv`, what `gymnasium.make_vec` makes by default.

    Seeds, autoresets and options: see `BabbleVectorEnv`.
    """

    task_name = "reach"
