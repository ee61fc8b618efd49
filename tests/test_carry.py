"""The chain of babbles in the goal form of grasping: it carries what it holds."""

import gymnasium as gym
import numpy as np
import pytest

from gym_babble import HebbBabbling, evaluate, load_agent, scenarios
from gym_babble.errors import ConfigError

CARRY = "BabbleGraspGoal-v0"
SMALL = {"eye_neurons": 11, "neurons": 9}


@pytest.fixture(scope="module")
def agent():
    return HebbBabbling(CARRY, variant="chain", seed=0).learn(200)


def at_end(agent, cases):
    """Whether each object is held at the end, and how far from its goal [m]."""
    envs = gym.make_vec(CARRY, num_envs=len(cases), autoreset_mode="Disabled")
    observation, _ = envs.reset(options={"scenario": cases})
    state, truncated = None, np.zeros(1, bool)
    while not truncated.all():
        actions, state = agent.predict(observation, state)
        observation, _, _, truncated, info = envs.step(actions)
    off = np.linalg.norm(observation["achieved_goal"] - observation["desired_goal"], axis=1)
    return info["held"] & ~info["outcome"]["lost"], off


def test_it_holds_objects_at_their_goals(agent):
    # A hand that pushes the object does not hold it; one that stays where it grasped is 5 cm off.
    held, off = at_end(agent, list(scenarios("palm_side", 30, 1_000, goal=True)))
    assert held.mean() >= 0.7
    assert (held & (off <= 0.02)).mean() >= 0.7
    assert np.median(off[held]) < 0.015


def test_the_same_weights_grasp_and_carry(tmp_path, agent):
    grasping = HebbBabbling("BabbleGrasp-v0", variant="chain", seed=0, brain=SMALL).learn(4)
    carrying = HebbBabbling(CARRY, variant="chain", seed=0, brain=SMALL).learn(4)
    assert grasping.to_bytes() == carrying.to_bytes()
    agent.save(tmp_path / "agent")
    cases = scenarios("palm_side", 4, 1_000, goal=True)
    plain = [{name: case[name] for name in ("start", "object", "diameter")} for case in cases]
    assert evaluate(load_agent(tmp_path / "agent"), cases=plain).rate("held") > 0
    acting = load_agent(tmp_path / "agent", gym.make(CARRY))
    played = [evaluate(acting, cases=cases, threads=n) for n in (1, 2)]
    assert played[0].facts == played[1].facts == evaluate(agent, cases=cases).facts


@pytest.mark.parametrize("options", [{"arm_touch": True}, {"control": "posture"}])
def test_it_carries_with_other_senses_and_controls(options):
    env = gym.make(CARRY, **options)
    acting = HebbBabbling(env, variant="chain", brain=SMALL).learn(2)
    observation, _ = env.reset(seed=1)
    action, _ = acting.predict(observation)
    assert env.action_space.contains(action)
    np.testing.assert_array_equal(
        acting.decide(observation), acting.decide(observation["observation"])
    )


def test_it_needs_a_goal(agent):
    env = gym.make(CARRY)
    observation, _ = env.reset(seed=0)
    with pytest.raises(ConfigError, match=r"\[1, 455\].*\(n, 457\)"):
        agent.predict(observation["observation"])
    with pytest.raises(ConfigError, match=r"desired_goal has shape \(3,\), expected \(2,\)"):
        agent.predict({**observation, "desired_goal": np.zeros(3)})
    with pytest.raises(ConfigError, match="number 455 is NaN"):
        agent.predict({**observation, "desired_goal": np.full(2, np.nan)})
