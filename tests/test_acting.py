"""A test is played where the agent acts: found from the agent, and never silently elsewhere."""

from __future__ import annotations

import gymnasium as gym
import numpy as np
import pytest
from stable_baselines3 import PPO
from stable_baselines3.common.env_util import make_vec_env
from stable_baselines3.common.vec_env import SubprocVecEnv, VecFrameStack, VecNormalize

from gym_babble import HebbBabbling, Oracle, Random, Scripted, evaluate, scenarios
from gym_babble.agents.loading import named_agent
from gym_babble.envs import BabbleGraspEnv, BabbleReachEnv
from gym_babble.errors import AgentFileError, ConfigError, ScenarioError
from gym_babble.sb3 import BabbleVecEnv
from gym_babble.study.trainers.sb3 import train_tuned

PATTERN = "BabbleReachPattern-v0"
STRAIGHT_ELBOW = {"body": {"joints": {"elbow": {"upper_deg": 90}}}}


def tiny_ppo(env, steps=128, policy="MultiInputPolicy"):
    model = PPO(policy, env, n_steps=16, batch_size=32, n_epochs=1, seed=0, device="cpu")
    return model.learn(steps)


@pytest.mark.parametrize("control", ["delta_posture", "posture", "pattern"])
def test_the_environment_comes_from_the_agent(control):
    # An agent of delta_posture scored .08 in pattern control, which was the default.
    cases = scenarios("table1", 40)
    agent = Scripted(BabbleReachEnv(control=control))
    env_id = PATTERN if control == "pattern" else "BabbleReach-v0"
    found = evaluate(agent, cases=cases)
    assert found.outcomes == evaluate(agent, env_id, cases, control=control).outcomes
    assert found.rate("success") > 0.8
    sparse = evaluate(agent, "BabbleReachSparse-v0", cases, control=control)
    assert sparse.outcomes == found.outcomes
    assert set(sparse.returns) <= {0.0, 1.0}


def test_the_config_comes_from_the_agent():
    # An agent that babbled on the body icub scored .71 for .97 on the body paper.
    for config in ("icub", STRAIGHT_ELBOW):
        env = gym.make(PATTERN, config=config)
        agent = HebbBabbling(env, "conjunctive", seed=0, quasi_static=True).learn(400)
        cases = scenarios("table1", 60, config=config)
        found = evaluate(agent, cases=cases)
        assert found == evaluate(agent, PATTERN, cases, config=config)
        assert found.cases == tuple(cases)
    by_default = evaluate(agent).cases
    assert len(by_default) == 1000
    assert by_default[:60] == found.cases


@pytest.mark.parametrize("env_id", ["BabbleReach-v0", PATTERN])
def test_the_autoreset_mode_does_not_matter(env_id):
    # In SameStep the outcome of the new episode was counted: no success at all.
    cases = scenarios("table1", 30)
    agent = Oracle(env_id)
    found = [
        evaluate(agent, cases=cases, autoreset_mode=mode)
        for mode in ("NextStep", "SameStep", "Disabled")
    ]
    assert found[0].rate("success") > 0.9
    assert found[1] == found[2] == found[0]
    with pytest.raises(ConfigError, match="autoreset_mode"):
        evaluate(agent, cases=cases, autoreset_mode="Never")


@pytest.mark.parametrize(
    ("agent", "arguments", "match"),
    [
        (lambda: Scripted(PATTERN), ("BabbleReach-v0",), r"'pattern'.*'delta_posture'"),
        (lambda: Scripted("BabbleReach-v0"), (PATTERN,), r"'delta_posture'.*'pattern'"),
        (lambda: Scripted(PATTERN), ("BabbleGrasp-v0",), r"BabbleReach.*BabbleGrasp.*another task"),
        (lambda: HebbBabbling("BabbleGrasp-v0"), (PATTERN,), r"BabbleGrasp.*BabbleReachPattern"),
        (lambda: Scripted("BabbleReach-v9"), (), "BabbleReach"),
    ],
)
def test_an_environment_that_contradicts_the_agent_is_an_error(agent, arguments, match):
    with pytest.raises((ConfigError, gym.error.Error), match=match):
        evaluate(agent(), *arguments)


def test_options_and_configs_that_contradict_the_agent_are_errors():
    agent = Scripted(gym.make(PATTERN, config="icub"))
    with pytest.raises(ConfigError, match=r"config\..* = .*the test's config has"):
        evaluate(agent, config="paper")
    with pytest.raises(ConfigError, match=r"'pattern'.*'posture'"):
        evaluate(agent, control="posture")
    with pytest.raises(ConfigError, match=r"enclosure_reflex False.*enclosure_reflex True"):
        evaluate(Scripted("BabbleGrasp-v0"), enclosure_reflex=True)
    with pytest.raises(ConfigError, match="speed"):
        evaluate(agent, speed=3)
    cases = scenarios("table1", 5, config="icub")
    assert evaluate(agent, cases=cases, config="icub") == evaluate(agent, cases=cases)


def test_cases_of_another_config_or_task_are_errors():
    # The same cases on another body gave another number, and no error.
    agent = Scripted(PATTERN)
    with pytest.raises(ScenarioError, match=r"config 'icub'.*'paper'"):
        evaluate(agent, cases=scenarios("table1", 3, config="icub"))
    with pytest.raises(ScenarioError, match=r"'paper, changed \([0-9a-f]{8}\)'.*'paper'"):
        evaluate(agent, cases=scenarios("table1", 3, config=STRAIGHT_ELBOW))
    with pytest.raises(ScenarioError, match=r"'palm_side' is one of grasping.*for reaching"):
        evaluate(agent, cases=scenarios("palm_side", 3))
    env = BabbleReachEnv()
    for case in (scenarios("table1", 1, config="icub")[0], scenarios("full", 1)[0]):
        with pytest.raises(ScenarioError):
            env.reset(options={"scenario": case})
    # A case of your own has no labels, and a changed one keeps them.
    (case,) = scenarios("table1", 1)
    own = {name: case[name] for name in ("start", "target", "obstacle")}
    assert evaluate(agent, cases=[own]).outcomes == evaluate(agent, cases=[case]).outcomes
    assert len(evaluate(agent, cases=[{**case, "obstacle": None}])) == 1


def test_cases_of_a_region_bring_it_with_its_time_limit():
    # Cases of "full" in the default environment had 240 steps instead of 500.
    cases = [*scenarios("full", 6), *scenarios("palm_side", 2)]
    idle = type(
        "Idle", (), {"env": "BabbleGrasp-v0", "predict": lambda _, seen: 0 * seen["stretch"]}
    )()
    found = evaluate(idle, cases=cases)
    assert found.steps == (500,) * 6 + (240,) * 2
    assert found.cases == tuple(cases)
    assert evaluate(idle, cases=cases[:2], max_episode_steps=30).steps == (30, 30)
    named = r"'full' is for BabbleGraspFull-v0 .*region='full'.*region='palm_side'"
    for env_id in ("BabbleGrasp-v0", "BabbleGraspSparse-v0"):
        with pytest.raises(ScenarioError, match=named):
            gym.make(env_id).reset(options={"scenario": cases[0]})
    gym.make("BabbleGraspFull-v0").reset(options={"scenario": cases[0]})
    assert evaluate(idle, "BabbleGraspFull-v0", cases[:2]).steps == (500, 500)
    everywhere = Random(BabbleGraspEnv(region="full"), seed=0)
    played = evaluate(everywhere, max_episode_steps=1)
    assert {case["protocol"] for case in played.cases} == {"full"}


def test_cases_of_the_goal_form_of_grasping_store_their_goals():
    # The environment sampled other goals for other batches.
    cases = scenarios("palm_side", 8, seed=3, goal=True)
    agent = Scripted("BabbleGraspGoal-v0")
    found = evaluate(agent, cases=cases)
    parts = [evaluate(agent, cases=cases[i:]) for i in range(3)]
    for i, part in enumerate(parts):
        assert part.outcomes == found.outcomes[i:]
        assert part.returns == found.returns[i:]
    env = BabbleGraspEnv(obs="goal", reward="sparse")
    for case in cases[:3]:
        observation, _ = env.reset(seed=9, options={"scenario": case})
        assert observation["desired_goal"] == pytest.approx(case["goal"], abs=1e-6)
    assert all("goal" in case for case in evaluate(agent, max_episode_steps=1).cases)
    with pytest.raises(ConfigError, match=r"goal=True"):
        evaluate(agent, cases=scenarios("palm_side", 2))
    with pytest.raises(ConfigError, match="goal = True"):
        scenarios("table1", 2, goal=True)


class Still:
    """Does nothing, and says nothing of where."""

    def predict(self, observation):
        return 0 * observation["eye"]


def test_an_agent_of_your_own_says_where_it_acts_or_you_do():
    cases = scenarios("table1", 5)
    still = Still()
    with pytest.raises(ConfigError, match="does not say where it acts"):
        evaluate(still, cases=cases)
    found = evaluate(still, "BabbleReach-v0", cases)
    assert evaluate(still, PATTERN, cases).steps == (1,) * 5
    still.env = "BabbleReach-v0"
    assert evaluate(still, cases=cases) == found
    still.env = gym.make("BabbleReach-v0")
    assert evaluate(still, cases=cases) == found
    still.env = gym.make_vec("BabbleReach-v0", num_envs=2)
    assert evaluate(still, cases=cases) == found
    with pytest.raises(ConfigError, match=r"'delta_posture'.*'pattern'"):
        evaluate(still, PATTERN, cases)
    low, high = np.float32(-2), np.float32(2)
    still.env = gym.wrappers.RescaleAction(gym.make("BabbleReach-v0"), low, high)
    with pytest.raises(ConfigError, match="wrapper"):
        evaluate(still, cases=cases)


@pytest.fixture(scope="module")
def zips(tmp_path_factory):
    """A zip of each control, made by train_tuned; and one that it did not make."""
    folder = tmp_path_factory.mktemp("zips")
    for name, env_id in (("pattern", PATTERN), ("delta_posture", "BabbleReach-v0")):
        train_tuned("ppo", env_id, steps=1).save(folder / name)
    train_tuned("ppo", PATTERN, config="icub", steps=1).save(folder / "icub")
    tiny_ppo(BabbleVecEnv("BabbleReach-v0", 8, control="posture", max_episode_steps=10)).save(
        folder / "foreign"
    )
    return folder


def test_a_zip_of_ours_says_where_it_learnt(zips):
    cases = scenarios("table1", 5)
    for name, env_id in (("pattern", PATTERN), ("delta_posture", "BabbleReach-v0")):
        path = f"{zips / name}.zip"
        found = evaluate(path, cases=cases)
        assert named_agent(path).arguments.title == env_id
        assert found == evaluate(path, env_id, cases)
        assert found == evaluate(PPO.load(path, device="cpu"), cases=cases)
        other = {PATTERN: "BabbleReach-v0", "BabbleReach-v0": PATTERN}[env_id]
        with pytest.raises(ConfigError, match=r"'pattern'.*'delta_posture'|'delta_.*'pattern'"):
            evaluate(path, other, cases)
    assert evaluate(f"{zips / 'icub'}.zip").cases[0]["config"] == "icub"
    with pytest.raises(ConfigError, match="the test's config has"):
        evaluate(f"{zips / 'icub'}.zip", config="paper")


def test_a_zip_of_ours_that_has_learnt_on_is_as_any_other(zips):
    model = PPO.load(zips / "delta_posture", device="cpu", n_steps=16)
    model.set_env(BabbleVecEnv("BabbleReach-v0", 128, control="posture"))
    assert named_agent_of(model) == "posture"  # Its environment counts.
    model.learn(128 * 16)
    model.env = None  # As after saving and loading.
    with pytest.raises(ConfigError, match="does not say where it learnt"):
        evaluate(model)
    for broken in (None, 3, {}, {**model.gym_babble_env, "config": "paper"}):
        model.gym_babble_env = broken
        model._n_updates = 5
        with pytest.raises(ConfigError, match="does not say where it learnt"):
            evaluate(model)


def named_agent_of(model):
    from gym_babble.agents.acting import carried  # noqa: PLC0415 - one helper needs it

    return carried(model).option("control")


def test_a_zip_of_others_needs_its_environment_and_control(zips):
    path, cases = f"{zips / 'foreign'}.zip", scenarios("table1", 3)
    for arguments, options in (((), {}), (("BabbleReach-v0",), {}), ((), {"control": "posture"})):
        with pytest.raises(ConfigError, match=r"--env-id and --control"):
            evaluate(path, *arguments, cases=cases, **options)
    found = evaluate(path, "BabbleReach-v0", cases, control="posture")
    model = PPO.load(path, BabbleVecEnv("BabbleReach-v0", 8, control="posture"), device="cpu")
    assert evaluate(model, cases=cases) == found
    # What its last episodes tell: an action was no whole movement.
    with pytest.raises(ConfigError, match=r"up to 10 steps.*another control than `pattern`"):
        evaluate(path, PATTERN, cases, control="pattern")
    # What its spaces tell.
    with pytest.raises(ConfigError, match=r"bounds.*another body"):
        evaluate(path, "BabbleReach-v0", control="posture", config="icub")
    with pytest.raises(ConfigError, match=r"learnt from observations: .*fovea"):
        evaluate(path, "BabbleGrasp-v0", control="posture")


@pytest.mark.parametrize("env_id", ["BabbleReach-v0", "BabbleGrasp-v0"])
def test_a_live_model_acts_in_its_own_environment(env_id):
    options = {"control": "posture", "max_episode_steps": 12}
    model = tiny_ppo(BabbleVecEnv(env_id, 8, **options))
    protocol = "table1" if "Reach" in env_id else "palm_side"
    cases = scenarios(protocol, 4)
    found = evaluate(model, cases=cases)
    assert found == evaluate(model, env_id, cases, **options)
    assert max(found.steps) <= 12
    with pytest.raises(ConfigError, match=r"'posture'.*'delta_posture'"):
        evaluate(model, env_id, cases, control="delta_posture")
    singles = make_vec_env(env_id, 2, env_kwargs={"control": "posture"})
    assert len(evaluate(tiny_ppo(singles), cases=cases)) == 4


def test_a_model_whose_environments_are_other_processes_acts_there_too():
    # Asked for something that cannot be pickled, the processes ended.
    workers = make_vec_env(
        "gym_babble:BabbleReach-v0", 2, env_kwargs={"control": "posture"}, vec_env_cls=SubprocVecEnv
    )
    model = tiny_ppo(workers)
    cases = scenarios("table1", 3)
    assert evaluate(model, cases=cases) == evaluate(
        model, "BabbleReach-v0", cases, control="posture"
    )
    workers.reset()
    workers.close()


def test_a_model_of_flat_observations_sees_them_again():
    cases = scenarios("table1", 4)
    flat = BabbleVecEnv("BabbleReach-v0", 8, obs="flat")
    model = tiny_ppo(flat, policy="MlpPolicy")
    found = evaluate(model, cases=cases)
    wrapped = make_vec_env("BabbleReach-v0", 2, wrapper_class=gym.wrappers.FlattenObservation)
    model.env = wrapped  # Gymnasium's flattening is the same.
    assert evaluate(model, cases=cases) == found
    with pytest.raises(ConfigError, match=r"Box\(11,\).*Dict\(arm"):
        evaluate(model, cases=cases, obs="senses")
    stacked = VecFrameStack(BabbleVecEnv("BabbleReach-v0", 8, obs="flat"), 3)
    with pytest.raises(ConfigError, match=r"Box\(33,\).*Box\(11,\)"):
        evaluate(tiny_ppo(stacked, policy="MlpPolicy"), cases=cases)


@pytest.fixture(scope="module")
def normalized(tmp_path_factory):
    folder = tmp_path_factory.mktemp("normalized")
    env = VecNormalize(BabbleVecEnv("BabbleReach-v0", 8))
    model = tiny_ppo(env, 512)
    model.save(folder / "model")
    env.save(str(folder / "statistics.pkl"))
    return model, folder / "model.zip", folder / "statistics.pkl"


def test_a_normalized_model_is_tested_with_its_own_statistics(normalized):
    model, path, statistics = normalized
    cases = scenarios("table1", 5)
    found = evaluate(model, cases=cases)
    env = BabbleVecEnv("BabbleReach-v0", 8)
    loaded = PPO.load(path, VecNormalize.load(str(statistics), env), device="cpu")
    assert evaluate(loaded, cases=cases) == found
    model.env, kept = env, model.env
    model._vec_normalize_env, wrapper = None, model._vec_normalize_env
    try:
        with pytest.raises(ConfigError, match="statistics are missing"):
            evaluate(model, cases=cases)
    finally:
        model.env, model._vec_normalize_env = kept, wrapper


def test_a_zip_of_a_normalized_model_needs_their_file(normalized, tmp_path):
    model, path, statistics = normalized
    cases = scenarios("table1", 5)
    asked = {"env_id": "BabbleReach-v0", "options": {"control": "delta_posture"}}
    with pytest.raises(ConfigError, match="--vec-normalize FILE"):
        named_agent(str(path), **asked)
    loaded = named_agent(str(path), vec_normalize=statistics, **asked)
    observation, _ = loaded.arguments.single().reset(seed=0)
    seen = model.get_vec_normalize_env().normalize_obs(observation)
    expected = model.predict(seen, deterministic=True)[0]
    np.testing.assert_array_equal(
        loaded.agent.predict(observation, deterministic=True)[0], expected
    )
    with pytest.raises(FileNotFoundError, match="missing"):
        named_agent(str(path), vec_normalize=tmp_path / "missing.pkl", **asked)
    other = tmp_path / "other.pkl"
    other.write_bytes(b"no statistics")
    with pytest.raises(AgentFileError, match=r"other\.pkl"):
        named_agent(str(path), vec_normalize=other, **asked)
    with pytest.raises(ConfigError, match="not a zip"):
        named_agent("scripted", vec_normalize=statistics)
    assert len(evaluate(model, cases=cases)) == 5


def test_a_model_of_normalized_rewards_needs_no_statistics(tmp_path):
    env = VecNormalize(BabbleVecEnv("BabbleReach-v0", 8), norm_obs=False)
    tiny_ppo(env).save(tmp_path / "model")
    asked = {"env_id": "BabbleReach-v0", "options": {"control": "delta_posture"}}
    named_agent(str(tmp_path / "model.zip"), **asked)
