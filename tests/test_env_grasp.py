"""BabbleGrasp as its docstring has it, seen through `gymnasium.make`."""

from __future__ import annotations

import math
from itertools import pairwise

import gymnasium
import numpy as np
import pytest
from comparing import CONTROLS_OF, GRASP_IDS, REGIONS, assert_same, drawn_actions, rollout
from grasping import OPEN, at, grasp, posture, to_object

from gym_babble import _core
from gym_babble.config import Config
from gym_babble.envs import BabbleGraspEnv, BabbleGraspVectorEnv, BabbleReachEnv
from gym_babble.envs.interface import outcome_of
from gym_babble.errors import ScenarioError

CONTROLS = CONTROLS_OF["grasp"]
CASE = {"start": (-0.7, 0.9), "object": (0.0, 0.2), "diameter": 0.06, "obstacle": None}
STAY = np.zeros(4, np.float32)
SPREAD = np.array([0.0, 0.0, -1.0, -1.0], np.float32)
CONFIGS = {
    "paper": "paper",
    "icub": "icub",
    "four fingers": {"body": {"grip": {"fingers": "independent"}}},
}
SLIPPERY = {"body": {"object": {"support_friction": 0, "linear_damping": 0}}}


def terms(seen, name):
    """A reward term at each step."""
    return [step[4]["reward_terms"][name] for step in seen[1:]]


# What a grasp gives.


@pytest.mark.parametrize("config", CONFIGS.values(), ids=CONFIGS.keys())
@pytest.mark.parametrize("diameter", [0.024, 0.04, 0.06])
def test_a_hand_that_closes_around_the_object_succeeds(config, diameter):
    env = BabbleGraspEnv(control="posture", config=config)
    seen = grasp(env, seed=0, options={**CASE, "start": (-0.15, 1.2), "diameter": diameter})
    _, reward, terminated, truncated, info = seen[-1]
    assert (terminated, truncated, outcome_of(info)) == (True, False, "success")
    assert all(info[fact] for fact in env.interface.spec.facts)
    assert info["reward_terms"]["success"] == 1
    assert reward > 0.9
    for step in seen[1:]:
        assert step[0] in env.observation_space
        assert step[1] == pytest.approx(sum(step[4]["reward_terms"].values()))


def test_reached_then_enclosed_for_a_second_then_held_for_another():
    # Catches a success by contact alone, and facts that are forgotten.
    env = BabbleGraspEnv(control="posture")
    for seed in range(5):
        seen = grasp(env, seed=seed)
        facts = [[result[-1][name] for result in seen] for name in ("reach", "palm_reach", "held")]
        for fact in facts:
            assert fact == sorted(fact)
        reach, palm_reach, held = (fact.index(True) for fact in facts)
        assert 0 < reach <= palm_reach
        assert held == len(seen) - 1
        share = np.cumsum(terms(seen, "enclosure"))
        enclosed = 1 + int(np.argmax(share > 0.999))
        assert enclosed >= reach + 20 - 1
        assert held - enclosed >= 20 - 1


def test_the_enclosure_term_pays_each_episode_at_most_once():
    # A hand that closes and opens again and again would live on it otherwise.
    env = BabbleGraspEnv(control="posture")
    assert sum(terms(grasp(env, seed=0), "enclosure")) == pytest.approx(1)
    env.reset(seed=0, options=CASE)
    arm = at(env, CASE["object"], CASE["diameter"])
    given, highest = [], 0.0
    for k in range(240):
        hand = env.interface.quantities["reflex"] if k % 50 > 30 else OPEN
        _, _, terminated, truncated, info = env.step(posture(env, arm, hand))
        given.append(info["reward_terms"]["enclosure"])
        highest = max(highest, sum(given))
        if terminated or truncated:
            break
    assert min(given) < 0
    assert 0.1 < highest <= 1.000001


def test_a_hand_that_stays_gets_nothing_and_one_that_nears_the_object_is_paid_by_the_way():
    env = BabbleGraspEnv()
    env.reset(seed=0, options=CASE)
    assert sum(abs(env.step(STAY)[1]) for _ in range(30)) < 1e-3
    seen = grasp(BabbleGraspEnv(control="posture"), options=CASE)
    assert sum(terms(seen, "progress")) > 2


@pytest.mark.parametrize("control", CONTROLS)
def test_rewards_and_returns_keep_their_bounds(control):
    for reward, lowest, highest in (("progress", -8, 10), ("sparse", 0, 1)):
        env = BabbleGraspEnv(control=control, reward=reward, max_episode_steps=120)
        env.action_space.seed(3)
        for seed in range(6):
            env.reset(seed=seed)
            total, ended = 0.0, False
            drift = env.action_space.sample() * 1.5
            while not ended:
                _, value, terminated, truncated, info = env.step(drift)
                assert value == pytest.approx(sum(info["reward_terms"].values()))
                total += value
                ended = terminated or truncated
            assert lowest <= total <= highest


def test_sparse_is_one_for_success_and_else_zero():
    seen = grasp(gymnasium.make(GRASP_IDS[1], control="posture"), seed=0)
    assert [step[1] for step in seen[1:]] == [0] * (len(seen) - 2) + [1]


# What is sensed.


def test_what_is_touched_is_felt_and_what_is_not_is_not():
    env = BabbleGraspEnv(control="posture")
    felt = []
    for seed in range(4):
        seen = grasp(env, seed=seed)
        for result in seen:
            touch, info = result[0]["touch"], result[-1]
            assert info["reach"] or not touch.any()
            assert info["palm_reach"] or not touch[0]
            felt.append(touch)
        assert touch[2] > 0
    assert (np.array(felt) > 0).any(axis=0).all()


def test_the_fovea_tells_sizes_apart_and_the_eye_places():
    env = BabbleGraspEnv()

    def seen(**changed):
        return env.reset(options={**CASE, **changed})[0]

    small, large = seen(diameter=0.024), seen(diameter=0.06)
    assert np.abs(small["fovea"] - large["fovea"]).sum() > 10
    assert small["eye"] == pytest.approx(large["eye"], abs=0.02)
    right, left = seen(object=(0.1, 0.2))["eye"], seen(object=(-0.1, 0.2))["eye"]
    assert abs(right[0] - left[0]) > 0.1
    again = seen(diameter=0.06)
    assert_same(again, large)


def test_hand_and_arm_show_the_posture_and_stretch_what_is_asked():
    env = BabbleGraspEnv()
    low, high = env.interface.quantities["ranges"].T
    observation, _ = env.reset(options=CASE)
    shares = (np.array(CASE["start"]) - low[:2]) / (high - low)[:2]
    assert observation["arm"] == pytest.approx(shares, abs=1e-5)
    assert observation["hand"] == pytest.approx([0, 0], abs=1e-5)
    assert observation["stretch"] == pytest.approx([0] * 4, abs=1e-5)
    after = env.step([0, 0, 1, 1])[0]
    assert after["stretch"][2:] + after["hand"] * (high - low)[2:] == pytest.approx(
        [env.interface.quantities["delta_posture"]] * 2, abs=1e-5
    )
    assert (after["hand"] > 0).all()


# How episodes end.


def play(env, action, options):
    """The last step of an episode of one action."""
    env.reset(seed=0, options=options)
    while True:
        result = env.step(action)
        if result[2] or result[3]:
            return result


def enclosed(env):
    """Plays on until the support is taken away."""
    _, info = env.reset(seed=0, options=CASE)
    share = 0.0
    while share < 0.999:
        info = env.step(to_object(env, info))[4]
        share += info["reward_terms"]["enclosure"]
    assert outcome_of(info) == "running"


def test_letting_go_when_the_support_is_gone_loses_the_object():
    env = BabbleGraspEnv(control="posture")
    enclosed(env)
    arm = at(env, CASE["object"], CASE["diameter"])
    ended = False
    while not ended:
        _, reward, ended, truncated, info = env.step(posture(env, arm, OPEN))
        assert not truncated
    assert outcome_of(info) == "lost"
    assert info["reward_terms"]["failure"] == -1
    assert reward < 0
    assert info["palm_reach"]
    assert not info["held"]
    assert not info["ever_success"]


def test_an_object_that_is_struck_out_of_reach_is_lost():
    env = BabbleGraspEnv(control="torque", config=SLIPPERY, region="full")
    case = {"start": (0.2, 0.3), "object": (0.15, 0.27), "diameter": 0.06}
    _, _, terminated, truncated, info = play(env, [1, 0, 0, 0], case)
    assert (terminated, truncated, outcome_of(info)) == (True, False, "lost")
    assert info["reach"]
    assert info["reward_terms"]["failure"] == -1


BLOCKED = {**CASE, "start": (-0.7, 0.4), "obstacle": (0.26, 0.1, 0.02)}


@pytest.mark.parametrize("control", CONTROLS)
def test_touching_an_obstacle_terminates(control):
    env = BabbleGraspEnv(control=control)
    action = to_object(env, env.reset(options=BLOCKED)[1]) if control == "posture" else [1, 0, 0, 0]
    _, reward, terminated, truncated, info = play(env, action, BLOCKED)
    assert (terminated, truncated, outcome_of(info)) == (True, False, "collision")
    assert info["reward_terms"]["failure"] == -1
    assert reward < 0
    assert not info["reach"]


def test_the_enclosure_reflex_closes_the_hand_whatever_the_action():
    lasts = {}
    for reflex in (False, True):
        env = BabbleGraspEnv(control="posture", enclosure_reflex=reflex)
        env.reset(options=CASE)
        action = posture(env, at(env, CASE["object"], CASE["diameter"]), OPEN)
        while True:
            before = env.step(action)
            if before[2] or before[3]:
                break
        lasts[reflex] = before
    assert outcome_of(lasts[True][4]) == "success"
    assert lasts[True][0]["hand"].min() > 0.2
    assert outcome_of(lasts[False][4]) == "timeout"
    assert lasts[False][4]["palm_reach"]
    assert lasts[False][0]["hand"].max() < 0.2
    # Not before the palm is touched.
    env = BabbleGraspEnv(enclosure_reflex=True)
    env.reset(options=CASE)
    assert all(env.step(STAY)[0]["hand"].max() < 1e-3 for _ in range(20))


# Where objects lie and arms start.


def polar(point):
    return math.hypot(*point), math.degrees(math.atan2(point[1], point[0]))


@pytest.mark.parametrize("config", ["paper", "icub"])
@pytest.mark.parametrize("region", REGIONS)
def test_cases_lie_in_their_region_and_can_be_grasped(config, region):
    env = BabbleGraspEnv(config=config, region=region)
    numbers = getattr(Config.profile_named(config).grasp, region)
    lower, upper = np.degrees(env.interface.quantities["ranges"][:2].T)
    starts = np.clip([numbers.shoulder_deg, numbers.elbow_deg], lower[:, None], upper[:, None])
    env.reset(seed=0)
    cases = []
    for _ in range(60):
        env.reset()
        cases.append(env.scenario)
    for case in cases:
        distance, direction = polar(case["object"])
        assert numbers.radius_m[0] <= distance <= numbers.radius_m[1]
        assert numbers.polar_deg[0] <= direction <= numbers.polar_deg[1]
        for (low, high), angle in zip(starts, np.degrees(case["start"]), strict=True):
            assert low - 1e-9 <= angle <= high + 1e-9
        assert (
            _core.grasp_posture(env.interface.task, case["object"], case["diameter"] / 2)
            is not None
        )
        assert case["obstacle"] is None
    # Not always the same corner.
    assert np.ptp([polar(case["object"])[1] for case in cases]) > 30
    assert np.ptp([case["start"] for case in cases], axis=0).min() > 0.2


def drawn_diameters(n=60, **arguments):
    env = BabbleGraspEnv(**arguments)
    env.reset(seed=0)
    found = []
    for _ in range(n):
        env.reset()
        found.append(env.scenario["diameter"])
    return np.array(found)


def test_diameters_are_drawn_from_the_list_or_from_all_between():
    assert set(drawn_diameters()) == {0.024, 0.06}
    assert set(drawn_diameters(diameters=[0.03, 0.05, 0.04])) == {0.03, 0.04, 0.05}
    assert set(drawn_diameters(diameters=(0.035,))) == {0.035}
    between = drawn_diameters(diameters=np.array([0.06, 0.02]), any_diameter_between=True)
    assert len(set(between)) == 60
    assert 0.02 <= between.min() < 0.03
    assert 0.05 < between.max() <= 0.06
    config = {"grasp": {"diameters_m": [0.06, 0.02], "any_diameter_between": True}}
    assert_same(drawn_diameters(config=config), between)
    # The list alone replaces the config's list, not how it is drawn from.
    config["grasp"]["diameters_m"] = [0.1]
    assert_same(drawn_diameters(config=config, diameters=[0.06, 0.02]), between)


def test_what_is_given_of_a_case_is_played_and_the_rest_is_drawn():
    env = BabbleGraspEnv(obs="goal", reward="sparse")
    whole = {**CASE, "goal": (-0.1, 0.2), "obstacle": (-0.25, -0.2, 0.03)}
    env.reset(seed=0, options=whole)
    assert env.scenario == whole
    assert env.reset()[0]["desired_goal"] == pytest.approx(whole["goal"])
    assert env.reset()[0]["achieved_goal"] == pytest.approx(whole["object"])
    for name, value in whole.items():
        env.reset(options={name: value})
        cases = []
        for _ in range(12):  # There are but two diameters.
            env.reset()
            cases.append(env.scenario)
        for other in whole:
            values = [case[other] for case in cases]
            if other == name:
                assert values == [value] * 12
            elif other == "obstacle":
                assert values == [None] * 12
            else:
                assert len(set(values)) > 1, other
    env.reset(options={"obstacle": (-0.25, -0.2)})
    assert env.scenario["obstacle"] == (-0.25, -0.2, Config().body.obstacle.radius_m)
    env.reset(options=dict.fromkeys(whole))
    assert all(env.scenario[name] != whole[name] for name in whole if name != "diameter")


def test_a_scenario_is_the_options_that_play_it_again():
    env, other = BabbleGraspEnv(), BabbleGraspEnv()
    actions = drawn_actions(env.action_space, 30, 0)
    for seed in range(5):
        first, _ = env.reset(seed=seed)
        again, _ = other.reset(seed=99, options={"scenario": env.scenario})
        assert_same(first, again)
        assert_same([env.step(a) for a in actions], [other.step(a) for a in actions])


def test_options_hold_until_a_reset_that_names_others():
    env = gymnasium.make(GRASP_IDS[0]).unwrapped
    env.reset(seed=0, options={"object": CASE["object"], "diameter": 0.03})
    starts = set()
    for _ in range(5):
        env.reset()
        assert (env.scenario["object"], env.scenario["diameter"]) == (CASE["object"], 0.03)
        starts.add(env.scenario["start"])
    assert len(starts) == 5
    env.reset(seed=3)
    assert env.scenario["diameter"] == 0.03
    env.reset(options={"start": CASE["start"]})
    env.reset()
    assert env.scenario["start"] == CASE["start"]
    assert env.scenario["object"] != CASE["object"]
    env.reset(options={})
    env.reset()
    assert env.scenario["start"] != CASE["start"]


def test_a_diameter_is_drawn_that_fits_between_start_and_object():
    # With both places given a large object may stand in the arm: resets must not fail by chance.
    env = BabbleGraspEnv()

    def plays(place, diameter):
        try:
            env.reset(options={"start": CASE["start"], "object": place, "diameter": diameter})
        except ScenarioError:
            return False
        return True

    places = [(0.2, y) for y in np.arange(-0.06, 0.05, 0.005)]
    (place, *_) = [p for p in places if plays(p, 0.024) and not plays(p, 0.06)]
    env.reset(seed=0, options={"start": CASE["start"], "object": place})
    for _ in range(20):
        env.reset()
        assert env.scenario["diameter"] == 0.024
    with pytest.raises(ScenarioError, match="object: the arm at the start is"):
        env.reset(options={"start": CASE["start"], "object": (0.2, -0.08)})


# Goals.


def carried(env, goal, seed=0):
    """An episode in which the hand takes the object and brings it to `goal`, the reset first."""
    seen = [env.reset(seed=seed, options={**CASE, "goal": goal})]
    held, ended = 0, False
    while not ended:
        action = to_object(env, seen[-1][-1])
        if held > 10:
            arm = at(env, goal, CASE["diameter"])
            action = posture(env, arm, env.unwrapped.interface.quantities["reflex"])
        seen.append(env.step(action))
        held += seen[-1][-1]["held"]
        ended = seen[-1][2] or seen[-1][3]
    return seen


def test_compute_reward_is_the_reward_of_carrying():
    env = gymnasium.make(GRASP_IDS[2], control="posture")
    unwrapped = env.unwrapped
    seen = carried(env, (-0.15, 0.15))
    assert len(seen) == 241
    achieved = np.array([step[0]["achieved_goal"] for step in seen[1:]])
    desired = np.array([step[0]["desired_goal"] for step in seen[1:]])
    rewards = np.array([step[1] for step in seen[1:]])
    for (observation, reward, terminated, _, info), k in zip(seen[1:], range(240), strict=True):
        assert not terminated
        assert observation in env.observation_space
        assert type(reward) is float
        assert reward == unwrapped.compute_reward(achieved[k], desired[k], info)
        assert info["is_success"] == (reward == 0)
    assert set(rewards) == {-1.0, 0.0}
    info = seen[-1][4]
    assert (outcome_of(info), info["ever_success"], info["held"]) == ("success", True, True)
    together = unwrapped.compute_reward(achieved, desired, [{}] * 240)
    assert_same(rewards, together)
    # Relabelled as HER does: with places where the object came later in the episode.
    later = np.array([*achieved[20:], *[achieved[-1]] * 20])
    relabelled = unwrapped.compute_reward(achieved, later, {})
    distances = np.linalg.norm((achieved - later).astype(np.float64), axis=1)
    assert ((relabelled == 0) == (distances <= 0.02)).all()
    assert set(relabelled) == {-1.0, 0.0}
    assert_same(unwrapped.compute_reward(achieved, desired[0], {}), together)


def test_a_relabelled_episode_has_the_rewards_of_the_environment():
    # The goal changes nothing but reward, success and what is desired.
    env = BabbleGraspEnv(obs="goal", reward="sparse", control="posture")
    first = carried(env, (-0.15, 0.15))
    goal = first[200][0]["achieved_goal"].astype(np.float64)
    assert np.hypot(*(goal - CASE["object"])) > 0.03
    other = BabbleGraspEnv(obs="goal", reward="sparse", control="delta_posture")
    actions = drawn_actions(other.action_space, 60, 1)
    played = []
    for wanted in ((-0.15, 0.15), goal):
        other.reset(options={**CASE, "goal": wanted})
        played.append([other.step(action) for action in actions])
    for a, b in zip(*played, strict=True):
        assert_same(a[0]["achieved_goal"], b[0]["achieved_goal"])
        assert_same(a[0]["observation"], b[0]["observation"])
        assert b[1] == env.compute_reward(b[0]["achieved_goal"], goal, {})


def test_drawn_goals_lie_in_the_region_and_away_from_the_object():
    env = gymnasium.make(GRASP_IDS[2]).unwrapped
    numbers = Config().grasp.palm_side
    env.reset(seed=0)
    for _ in range(60):
        _, info = env.reset()
        case = env.scenario
        assert math.dist(case["goal"], case["object"]) >= 0.05
        distance, direction = polar(case["goal"])
        assert numbers.radius_m[0] <= distance <= numbers.radius_m[1]
        assert numbers.polar_deg[0] <= direction <= numbers.polar_deg[1]
        assert not info["is_success"]


@pytest.mark.parametrize("control", CONTROLS)
def test_a_collision_in_the_goal_form_holds_everything_until_the_time_limit(control):
    # Ending early would pay.
    env = gymnasium.make(GRASP_IDS[2], control=control)
    _, info = env.reset(seed=0, options=BLOCKED)
    action = to_object(env, info) if control == "posture" else np.array([1, 0, 0, 0], np.float32)
    clock = dict(env.unwrapped.interface.spec.slices)["time"]
    still = []
    for k in range(240):
        observation, reward, terminated, truncated, info = env.step(action)
        assert reward == -1
        assert not terminated
        assert truncated == (k == 239)
        if outcome_of(info) == "collision":
            senses = np.delete(observation["observation"], clock.start)
            still.append((observation["achieved_goal"], senses))
    assert outcome_of(info) == "collision"
    assert len(still) > 100
    for later in still:
        assert_same(later, still[0])


def test_a_lost_object_in_the_goal_form_stays_lost():
    env = gymnasium.make(GRASP_IDS[2], control="posture")
    _, info = env.reset(seed=0, options={**CASE, "goal": (-0.15, 0.15)})
    arm, reflex = (
        at(env, CASE["object"], CASE["diameter"]),
        env.unwrapped.interface.quantities["reflex"],
    )
    places = []
    for k in range(240):
        closing = info["reach"] and k < 110  # By then the support has gone.
        observation, reward, terminated, truncated, info = env.step(
            posture(env, arm, reflex if closing else OPEN)
        )
        assert (reward, terminated, truncated) == (-1, False, k == 239)
        if outcome_of(info) == "lost":
            places.append(observation["achieved_goal"])
    assert outcome_of(info) == "lost"
    assert len(places) > 100
    assert all((place == places[0]).all() for place in places)


def test_failing_with_the_object_at_its_goal_is_no_success_and_earns_nothing():
    env = gymnasium.make(GRASP_IDS[2])
    env.reset(seed=0, options={**BLOCKED, "goal": BLOCKED["object"]})
    rewards = []
    for _ in range(240):
        _, reward, _, truncated, info = env.step(np.array([1, 0, 0, 0], np.float32))
        rewards.append(reward)
    assert truncated
    assert rewards[0] == 0.0
    first = rewards.index(-1.0)
    assert set(rewards[first:]) == {-1.0}
    assert (outcome_of(info), info["is_success"], info["ever_success"]) == (
        "collision",
        False,
        True,
    )


# States and configs.


def test_a_state_continues_to_the_bit_from_any_phase_of_a_grasp():
    # Contacts, the missing support and the count of enclosing steps are state as well.
    env, other = (BabbleGraspEnv(control="posture") for _ in range(2))
    seen = [env.reset(seed=0, options=CASE)]
    states, actions, hashes = [env.get_state()], [], [env.state_hash()]
    while len(seen[-1]) == 2 or not seen[-1][2]:
        actions.append(to_object(env, seen[-1][-1]))
        seen.append(env.step(actions[-1]))
        states.append(env.get_state())
        hashes.append(env.state_hash())
    assert outcome_of(seen[-1][4]) == "success"
    assert len(set(hashes)) == len(hashes)
    for moment in range(0, len(actions), 9):
        other.set_state(states[moment])
        assert other.state_hash() == hashes[moment]
        assert_same(seen[moment + 1 :], [other.step(action) for action in actions[moment:]])
        assert other.state_hash() == hashes[-1]


def test_states_of_other_tasks_and_choices_are_refused():
    reach = gymnasium.make("BabbleReach-v0").unwrapped
    reach.reset(seed=0)
    env = BabbleGraspEnv()
    env.reset(seed=0)
    before = env.state_hash()
    foreign = [reach.get_state()]
    for other in ({"region": "full"}, {"enclosure_reflex": True}, {"in_hand_starts": 1}):
        made = BabbleGraspEnv(**other)
        made.reset(seed=0)
        foreign.append(made.get_state())
    for state in foreign:
        with pytest.raises(ValueError, match="snapshot"):
            env.set_state(state)
    with pytest.raises(ValueError, match="snapshot"):
        reach.set_state(env.get_state())
    assert env.state_hash() == before


CHANGES = {
    "a grasp counts sooner": ("[grasp]\nhold_steps = 5\n", "success", -25),
    "a stronger arm is there sooner": ("[body.grip.arm_muscles]\nkp = 2000.0\n", "success", -10),
    "a hand without strength": ("[body.grip.hand_muscles]\nkp = 1e-3\nkd = 1e-3\n", "lost", 0),
    "a smooth, heavy object": (
        "[body.object]\nfriction = 0.0\ndensity_kg_m3 = 4000.0\n",
        "lost",
        0,
    ),
}


@pytest.mark.parametrize(("text", "outcome", "sooner"), CHANGES.values(), ids=CHANGES.keys())
def test_a_configs_numbers_reach_the_simulation(tmp_path, text, outcome, sooner):
    plain = grasp(BabbleGraspEnv(control="posture"), options=CASE)
    assert outcome_of(plain[-1][4]) == "success"
    path = tmp_path / "changed.toml"
    path.write_text(text)
    seen = grasp(BabbleGraspEnv(control="posture", config=path), options=CASE)
    assert outcome_of(seen[-1][4]) == outcome
    assert outcome == "lost" or len(seen) - len(plain) <= sooner


def test_a_configs_numbers_reach_choices_rewards_and_spaces():
    numbers = {
        "delta_posture_deg": 9.0,
        "control_period_s": 0.1,
        "success_radius_m": 0.1,
        "touch_max_n": 1.0,
    }
    muscles = {"grip": {"hand_muscles": {"torque_max": 2.0}, "reflex_deg": [10, 20]}}
    config = {"grasp": numbers, "body": muscles}
    env = BabbleGraspEnv(config=config, obs="goal", reward="sparse")
    assert env.interface.quantities["delta_posture"] == pytest.approx(math.radians(9))
    assert env.interface.quantities["reflex"] == pytest.approx(np.radians([10, 20]))
    assert env.metadata["render_fps"] == 10
    assert env.compute_reward(np.zeros(2), np.array([0.09, 0]), {}) == 0
    torque = BabbleGraspEnv(config=config, control="torque").observation_space["stretch"]
    assert torque.high[2:] == pytest.approx([2 / 0.5] * 2)
    soft = BabbleGraspEnv(config={"grasp": {"touch_max_n": 1.0}}, control="posture")
    soft = grasp(soft, options=CASE)
    hard = grasp(BabbleGraspEnv(control="posture"), options=CASE)
    assert soft[-1][0]["touch"][2] == pytest.approx(min(1, 20 * hard[-1][0]["touch"][2]))


def test_single_environments_and_batches_take_the_same_steps_of_a_grasp():
    envs = BabbleGraspVectorEnv(3, control="posture", autoreset_mode="Disabled", threads=2)
    env = BabbleGraspEnv(control="posture")
    seen = grasp(env, seed=0, options=CASE)
    envs.reset(seed=0, options=CASE)
    env.reset(options=CASE)
    for step, before in zip(seen[1:], seen, strict=False):
        action = to_object(env, before[-1])
        observation, rewards, terminated, _, infos = envs.step(np.stack([action] * 3))
        assert rewards.tolist() == [step[1]] * 3
        assert_same(np.array(observation["touch"][2]), step[0]["touch"])
    assert terminated.all()
    assert infos["outcome"]["success"].all()


def test_random_play_keeps_what_has_been_true():
    for control in CONTROLS:
        env = BabbleGraspEnv(control=control, region="full", max_episode_steps=150)
        seen = rollout(env, drawn_actions(env.action_space, 450, 2))
        for a, b in pairwise(seen):
            if len(b) == 5:
                for fact in ("ever_success", "reach", "palm_reach"):
                    assert b[4][fact] or not a[-1][fact]


def test_steps_that_the_solver_did_not_converge_in_are_counted():
    # In Rust a test shows steps that are.
    env = BabbleGraspEnv(control="posture")
    env.reset(seed=0)
    for _ in range(20):
        env.step([0.5, -0.5, 0.9, 0.9])
    assert env.interface.unconverged_steps == 0
    assert BabbleGraspEnv(config={"body": {"engine": "rapier"}}).interface.unconverged_steps is None
    assert BabbleReachEnv().interface.unconverged_steps is None
