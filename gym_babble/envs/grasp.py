"""BabbleGrasp: reach for an object and grasp it."""

from __future__ import annotations

from gym_babble.envs.single import BabbleEnv
from gym_babble.envs.vector import BabbleVectorEnv

__all__ = ["BabbleGraspEnv", "BabbleGraspVectorEnv"]


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
    support is then taken away and the hand has to hold it for another second. In both seconds a
    contact counts only while neither obstacle, upper arm nor forearm touches the object: an open
    hand can pin it against each of them, and a pinned object does not follow the hand.

    With `support_stays=True` the support carries the object in both seconds and is never taken
    away. A hold then lasts while the hand encloses the object and ends no episode, so the hand can
    grasp and release over and over.

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
    | `arm` | 2 | 0 | 1 | shoulder and elbow, share of range |
    | `eye` | 2 | 0 | 1 | pan and tilt, share of range |
    | `fovea` | 441 | 0 | 1 | edges (Sobel) in the image's middle 63 × 63, in 21 × 21 blocks |
    | `hand` | 2 | 0 | 1 | flexion of thumb and virtual finger, share of range |
    | `stretch` | 4 | −range | range | equilibrium point minus angle [rad]; in torque ±1 |
    | `time` | 1 | 0 | 1 | share of the episode |
    | `touch` | 3 | 0 | 1 | normal force of palm, thumb, fingers on the object over 20 N |

    `"flat"` is the same in one Box(455,), in this order, which is that of Gymnasium's
    `FlattenObservation`. `arm_touch=True` adds `touch_arm` (3): upper arm, forearm and the back of
    the hand, as `touch` but at the end of the control step. `"goal"` is a Dict of `observation`
    (flat), `achieved_goal` (the object's centre) and `desired_goal` (where it is to be carried),
    (x, y) [m]. `"retina"` is the senses and the eye's image, `retina_size` × `retina_size` × 3,
    uint8.

    ## Rewards

    - `progress` (terms progress + enclosure + success + failure): decrease of the distance between
      the object and the hollow of the hand over 10 cm; increase of the share of the last second
      with a finger's contact plus that with the thumb's or the palm's, halved (contacts that
      count); +1 for success; −1 for a lost object or a collision.
    - `sparse`: 1 for success, else 0.
    - with `obs="goal"`: 0 with the object's centre within 2 cm of the goal, else −1, and −1 after a
      failure; `compute_reward` gives the same.

    ## Starting state

    The hand is open, the arm at rest and at least 5 mm from the object; the object's diameter is
    one of `diameters`. `region="palm_side"`: distance of the object from the shoulder uniform in
    15–29 cm, direction in 40–160°, shoulder in −75…−15°, elbow in 5–90° (body `icub`: direction
    90–160°, shoulder −10…10°, elbow 15–90°). `"full"`: 13–29 cm, −20…160°, all postures. In both
    some posture brings the palm to the object. The goal is drawn as the object is, 5 cm from it
    or more.

    ## Episode end

    - `success` (terminated): the hand has held the object without support for a second. With
      `support_stays=True`, at the time limit: the hand holds the object then.
    - `lost` (terminated): the hand has not held it, or the object is out of the arm's reach, or,
      with `obs="goal"`, was dropped after it had been held.
    - `collision` (terminated): arm or hand touches the obstacle, if one was asked for.
    - `timeout`: truncated after 240 steps (12 s), 500 in region `full`.

    With `obs="goal"` nothing terminates: after `lost` or `collision` everything stays as it is
    until the time limit, and `achieved_goal` is a corner of its space, for which `compute_reward`
    is −1 whatever the goal: an object dropped at its goal earns nothing. Otherwise the outcome at
    the time limit is `success` if the object is at the goal then.

    ## Info

    `is_success` (now), `ever_success` (in this episode), `reach` (any part of arm or hand has
    touched the object), `palm_reach` (the palm has), `held` (the hand has held it without support;
    on a support that stays: it holds it now), `in_sight` (the eye sees some of the object),
    `outcome` (running, success, collision, timeout, lost): a dict of booleans, one of them True;
    `reward_terms`: a dict of numbers; `object`: the centre of the object (3,), x, y, z from the
    shoulder [m]. All are booleans and numbers, so wrappers can make tensors of them.

    ## Arguments

    The options are listed below; each is a keyword of `gymnasium.make` and `make_vec` too, but for
    `region`: region `full` has an id of its own, `BabbleGraspFull-v0`.

    `reset(options=...)` takes `scenario` (see `gym_babble.scenarios`), or any of `start` (shoulder,
    elbow) [rad], `object` (x, y), `diameter`, with `obs="goal"` `goal` (x, y), `obstacle`
    (x, y), (x, y, radius) or None [m], and `in_hand`. Unspecified values are sampled, and there is
    no obstacle. With `in_hand` True the object lies 1 mm before the palm of the open hand, wherever
    `object` says; with False it does not, whatever `in_hand_starts` says.
    Options hold for the following resets until replaced; pass `{}` to clear them.

    ## Version history

    - v0: first.
    """

    task_name = "grasp"


class BabbleGraspVectorEnv(BabbleVectorEnv):
    """A batch of `BabbleGraspEnv`, what `gymnasium.make_vec` makes by default.

    Seeds, autoresets and options: see `BabbleVectorEnv`.
    """

    task_name = "grasp"
