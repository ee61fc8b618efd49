"""Outcome, success facts, reward and end of an episode are of one measure, whatever the options."""

from __future__ import annotations

import itertools
from collections import Counter

import gymnasium
import numpy as np
import pytest
from comparing import CONTROLS_OF, ENVIRONMENTS
from grasping import posture

from gym_babble import _core
from gym_babble.envs import BabbleReachEnv
from gym_babble.envs.interface import outcome_of

FAILURES = {"collision", "joint_limit", "lost"}
# A wide target that random movements often reach, and no time to come to rest there.
EASY = {"reach": {"success_radius_m": 0.08, "settle_time_constants": 0.0}}
# Every movement ends before the arm is at rest.
MOVING = {"reach": {"settled_speed_rad_s": 1e-6, "settle_time_constants": 1.0}}
START, ELBOW_M, POCKET_M = (0.2, 0.8), 0.15, (0.1703, 0.016)


def before_the_palm(diameter):
    """A case of grasping whose object is 6 mm before the palm."""
    shoulder, both = START[0], sum(START)
    x, y = POCKET_M[0], POCKET_M[1] + diameter / 2
    place = (
        ELBOW_M * np.cos(shoulder) + x * np.cos(both) - y * np.sin(both),
        ELBOW_M * np.sin(shoulder) + x * np.sin(both) + y * np.cos(both),
    )
    return {"start": START, "object": place, "diameter": diameter}


def made():
    """Every id with every control, and with every option that decides about success."""
    flags = {"reach": "settled", "grasp": "enclosure_reflex"}
    for row in ENVIRONMENTS:
        settles = row.task == "grasp" or "Goal" not in row.id
        fixed = "control" in row.fixed
        for control in (row.options["control"],) if fixed else CONTROLS_OF[row.task]:
            for flag in (False, True) if settles else (False,):
                yield row.id, row.task, {"control": control, flags[row.task]: flag}


def actions(env, task, seed):
    """Actions of an episode: a steady drift in reaching, a hand that closes in grasping."""
    rng = np.random.default_rng(seed)
    if task == "reach":
        drift = rng.uniform(-1.2, 1.2, 2).astype(np.float32)
        return itertools.repeat(drift)
    if env.unwrapped.interface.options["control"] == "posture":
        reflex = env.unwrapped.interface.quantities["reflex"]
        return itertools.repeat(posture(env, (START[0] + 0.1, START[1] + 0.1), reflex))
    return itertools.repeat(np.array([0.05, 0.05, 0.5, 0.5], np.float32))


def agree(goal, reward, step, ever):
    """Checks one step; whether the episode ended."""
    observation, value, terminated, truncated, info = step
    outcome, success = outcome_of(info), info["is_success"]
    ended = terminated or truncated
    assert info["ever_success"] == (ever or success)
    assert not (success and outcome in FAILURES)
    assert value == pytest.approx(sum(info["reward_terms"].values()))
    if ended:
        assert success == (outcome == "success")
        assert outcome != "running"
    else:
        assert outcome in ({"running", *FAILURES} if goal else {"running"})
        assert goal or not success
    if truncated and not terminated and not goal:
        assert outcome == "timeout"
    if goal:
        assert value == (0 if success else -1)
        assert value == info["again"](observation["achieved_goal"], observation["desired_goal"], {})
        achieved = observation["achieved_goal"]
        relabelled = info["again"](achieved, achieved, {})
        assert relabelled == (-1 if outcome in FAILURES else 0)
    elif reward == "sparse":
        assert value == success
    else:
        assert info["reward_terms"]["success"] == success
        assert info["reward_terms"]["failure"] == -(outcome in FAILURES)
    if "held" in info and not goal:
        assert info["held"] == success
    return ended


def reset_options(task, seed):
    return before_the_palm((0.024, 0.06)[seed % 2]) if task == "grasp" else {}


def played(env, task, seed):
    """The steps of one episode, with the function that hindsight calls."""
    env.reset(seed=seed, options=reset_options(task, seed))
    again = env.unwrapped.compute_reward if env.unwrapped.interface.obs == "goal" else None
    for action in actions(env, task, seed):
        step = env.step(action)
        step[4]["again"] = again
        yield step
        if step[2] or step[3]:
            return


def seeds(task, control):
    if task == "grasp":
        return range(2)
    return range(12 if control == "pattern" else 6)


def test_outcome_facts_reward_and_end_agree_under_every_option():
    # Catches a success by one measure that another denies, and a failure that pays.
    seen = Counter()
    for env_id, task, options in made():
        env = gymnasium.make(env_id, config=EASY, **options).unwrapped
        goal, reward = env.interface.obs == "goal", env.interface.options["reward"]
        for seed in seeds(task, options["control"]):
            ever, ended = False, False
            for k, step in enumerate(played(env, task, seed)):
                ended = agree(goal, reward, step, ever)
                ever = step[4]["ever_success"]
                assert k < env.unwrapped._max_episode_steps
            assert ended
            seen[task, goal, outcome_of(step[4])] += 1
    for goal in (False, True):
        found = {outcome for task, form, outcome in seen if (task, form) == ("reach", goal)}
        assert found == {"success", "timeout", "collision", "joint_limit"}, seen
    assert seen["grasp", False, "success"] > 10
    assert seen["grasp", False, "timeout"] + seen["grasp", False, "lost"] > 2


def test_a_movement_that_ends_at_the_target_but_not_at_rest_is_no_success_when_settled():
    # Catches an outcome by distance alone.
    outcomes = Counter()
    for settled in (False, True):
        env = BabbleReachEnv(control="pattern", settled=settled, config=MOVING)
        for seed in range(40):
            env.reset(seed=seed, options={"obstacle": None})
            info = env.step([0.0, 0.0])[4]
            assert info["is_success"] == info["outcome"]["success"]
            outcomes[settled, outcome_of(info)] += 1
    assert outcomes[False, "success"] > 20
    assert outcomes[True, "success"] == 0
    assert outcomes[True, "timeout"] == outcomes[False, "success"]


def collided_at_the_target(env):
    """An arm whose forearm meets an obstacle while the fingertip is at its target; all steps."""
    target = np.array([0.10, 0.25])
    q = np.array(_core.posture_at(env.unwrapped.interface.task, tuple(target)))
    elbow = ELBOW_M * np.array([np.cos(q[0]), np.sin(q[0])])
    along = target - elbow
    reach = np.linalg.norm(along)
    along /= reach
    way = elbow + 0.6 * reach * along + 0.047 * np.array([-along[1], along[0]])
    first = q[0] - 0.6
    start = ELBOW_M * np.array([np.cos(first), np.sin(first)]) + reach * np.array(
        [np.cos(first + q[1]), np.sin(first + q[1])]
    )
    case = {"start": tuple(start), "target": tuple(target), "obstacle": (*way, 0.035)}
    env.reset(seed=0, options=case)
    if env.unwrapped.interface.options["control"] == "posture":
        low, high = np.radians([-75, 5]), np.radians([180, 130])
        action = 2 * (q + np.array([0.3, 0]) - low) / (high - low) - 1
    else:
        action = np.array([0.5, 0.0])
    steps = []
    while not steps or not steps[-1][3]:
        steps.append(env.step(action.astype(np.float32)))
    return steps


@pytest.mark.parametrize("control", ["delta_posture", "posture", "torque"])
def test_an_arm_that_collided_at_its_target_earns_nothing_more(control):
    # It went on earning 0 until the time limit: hindsight learnt to collide at the target.
    env = BabbleReachEnv(obs="goal", reward="sparse", control=control)
    steps = collided_at_the_target(env)
    outcomes = [outcome_of(step[4]) for step in steps]
    hit = outcomes.index("collision")
    assert len(steps) == 240
    assert set(outcomes[hit:]) == {"collision"}
    still = steps[-1][0]["observation"][:-1]  # All but the time.
    assert np.array_equal(still, steps[hit][0]["observation"][:-1])
    for step in steps[hit:]:
        observation, reward, _, _, info = step
        assert (reward, info["is_success"]) == (-1, False)
        achieved = observation["achieved_goal"]
        assert achieved in env.observation_space["achieved_goal"]
        # No goal that an episode can have, and none that hindsight takes from these steps.
        goals = np.array([observation["desired_goal"], *(s[0]["achieved_goal"] for s in steps)])
        again = env.compute_reward(np.broadcast_to(achieved, goals.shape), goals, {})
        assert (again == -1).all()


def test_batches_say_what_single_environments_say():
    for env_id, obs in (("BabbleReachGoal-v0", "goal"), ("BabbleReach-v0", "senses")):
        envs = gymnasium.make_vec(env_id, num_envs=8, config=EASY, autoreset_mode="SameStep")
        envs.reset(seed=0)
        drift = np.random.default_rng(0).uniform(-1, 1, (8, 2)).astype(np.float32)
        for _ in range(260):
            _, rewards, terminations, truncations, infos = envs.step(drift)
            for i in range(8):
                info = infos["final_info"] if terminations[i] or truncations[i] else infos
                outcome, success = info["outcome"], bool(info["is_success"][i])
                assert not (
                    success and any(outcome[name][i] for name in FAILURES if name in outcome)
                )
                if obs == "goal":
                    assert rewards[i] == (0 if success else -1)
                elif terminations[i]:
                    assert success == outcome["success"][i]
        envs.close()
