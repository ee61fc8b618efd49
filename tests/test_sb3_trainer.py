"""Training with stable-baselines3: the same bits for a seed, every step charged, zips that act."""

import importlib
import sys
from itertools import pairwise

import gymnasium as gym
import numpy as np
import pytest
import torch

from gym_babble import evaluate, scenarios
from gym_babble.agents.loading import named_agent
from gym_babble.errors import ConfigError, DivergedError, MissingExtraError
from gym_babble.study.roster import GENERATORS, IN_HAND, REFLEX, ROSTER, trainer_for
from gym_babble.study.trainers.base import Cost, Order
from gym_babble.study.trainers.sb3 import SB3Trainer, train_tuned

MOVEMENT = 224  # Control steps: (8 + 4 · 40/50) s at 50 ms.
SMALL = {"n_envs": 4, "batch_size": 32, "policy_kwargs": "dict(net_arch=[16])"}
OFF_POLICY = {**SMALL, "learning_starts": 16, "gradient_steps": 2, "buffer_size": 1_000}
AGENTS = {
    "ppo": ("ppo", "BabbleReach-v0", {**SMALL, "n_steps": 16}, 1),
    "ppo-pattern": ("ppo", "BabbleReachPattern-v0", {**SMALL, "n_steps": 8}, MOVEMENT),
    "ppo-grasp": ("ppo", "BabbleGrasp-v0", {**SMALL, "n_steps": 16}, 1),
    "sac": ("sac", "BabbleReachPattern-v0", OFF_POLICY, MOVEMENT),
    "sac-her": ("sac", "BabbleReachGoal-v0", OFF_POLICY, MOVEMENT),
    "td3": ("td3", "BabbleReachPattern-v0", OFF_POLICY, MOVEMENT),
}


def made(agent, seed=3, budget=0, **changed):
    algorithm, env_id, settings, _ = AGENTS[agent]
    task = "grasp" if "Grasp" in env_id else "reach"
    settings = settings | changed.pop("settings", {})
    changed = {"env_id": env_id, **changed}
    return SB3Trainer(
        Order(task=task, seed=seed, budget=budget, settings=settings, **changed), algorithm
    )


def of_roster(name, task):
    row = ROSTER[name]
    place = row.tasks[task]
    order = Order(
        task=task,
        seed=0,
        budget=place.budget,
        env_id=place.env_id,
        options=dict(row.options),
        settings=dict(row.settings),
    )
    return trainer_for(name, order)


def weights(trainer):
    return torch.cat([part.detach().flatten() for part in trainer.agent.policy.parameters()])


def cases_of(trainer, n=20):
    protocol = {"reach": "table1", "grasp": "palm_side"}[trainer.arguments.task]
    return scenarios(protocol, n, split="validation")


@pytest.mark.parametrize("agent", AGENTS)
def test_same_seed_same_bits_whatever_happens_in_pauses(agent):
    rollout = 64 if agent.startswith("ppo") else 32
    steps = 2 * rollout * AGENTS[agent][3]

    def trained(seed, *stops, test=False):
        trainer = made(agent, seed=seed, budget=steps)
        cases = cases_of(trainer, 4)
        for stop in (*stops, steps):
            trainer.train(stop, lambda: test and evaluate(trainer.agent, cases=cases))
        return weights(trainer)

    first = trained(3)
    assert torch.equal(trained(3, steps // 2, test=True), first)
    assert not torch.equal(trained(4), first)


@pytest.mark.parametrize("agent", AGENTS)
def test_each_step_and_episode_is_charged(agent, monkeypatch):
    trainer = made(agent)
    env, per_step = trainer.agent.env, AGENTS[agent][3]
    steps, ends, step = [], [], env.step_wait

    def counted():
        result = step()
        steps.append(env.num_envs * per_step)
        ends.extend(np.flatnonzero(result[2]))
        return result

    monkeypatch.setattr(env, "step_wait", counted)
    costs = []
    trainer.train(100 * per_step, lambda: costs.append(trainer.cost))
    assert trainer.cost == Cost(trials=len(ends), control_steps=sum(steps)) == costs[-1]
    assert 100 * per_step <= sum(steps) < 200 * per_step
    assert all(one.control_steps < two.control_steps for one, two in pairwise(costs))
    trainer.train(100 * per_step, lambda: costs.append(None))
    assert costs[-1] is not None  # Nothing was left to learn.


@pytest.mark.parametrize("agent", AGENTS)
def test_the_zip_says_where_it_acts_and_acts_as_the_model(agent, tmp_path):
    trainer = made(agent)
    trainer.train(64 * AGENTS[agent][3], lambda: None)
    suffix, content = trainer.save()
    path = tmp_path / f"model{suffix}"
    path.write_bytes(content)
    cases = cases_of(trainer)
    expected, found = evaluate(trainer.agent, cases=cases), evaluate(str(path), cases=cases)
    assert found == expected
    assert named_agent(str(path)).arguments == trainer.arguments


def test_a_linear_schedule_ends_with_the_budget():
    trainer = made("ppo", budget=2 * 64, settings={"learning_rate": "lin_1e-2"})
    rates = []
    note = lambda: rates.append(trainer.agent.policy.optimizer.param_groups[0]["lr"])  # noqa: E731
    trainer.train(64, note)
    trainer.train(2 * 64, note)
    assert rates == pytest.approx([0.5e-2, 0.0])


@pytest.mark.parametrize(
    ("name", "task"),
    [
        (name, task)
        for name, row in ROSTER.items()
        if row.trainer[:4] == "sb3:"
        for task in row.tasks
    ],
)
def test_the_rosters_agents_know_what_it_says(name, task):
    place = ROSTER[name].tasks[task]
    trainer = of_roster(name, task)
    arguments, (interface,) = trainer.arguments, trainer.agent.env.get_attr("interface", 0)
    assert arguments.task == task
    assert bool(interface.options.get("in_hand_starts")) == (IN_HAND in place.knows)
    assert not arguments.option("in_hand_starts")
    assert (arguments.option("control") == "pattern") == (GENERATORS in place.knows)
    assert bool(arguments.option("enclosure_reflex")) == (REFLEX in place.knows)


@pytest.mark.parametrize(
    ("name", "senses"),
    [("ppo-obstacle", ["obstacle"]), ("ppo-eye-obstacle", ["eye", "obstacle"])],
)
def test_sees_its_senses_and_no_others(name, senses):
    trainer = of_roster(name, "reach")
    observation, _ = gym.make("BabbleReachPattern-v0").reset(seed=0)
    action = trainer.agent.predict(observation, deterministic=True)[0]
    for sense, value in observation.items():
        changed = {**observation, sense: value + np.float32(0.3)}
        same = np.array_equal(trainer.agent.predict(changed, deterministic=True)[0], action)
        assert same == (sense not in senses)


@pytest.mark.slow
def test_ppo_learns_whole_movements():
    model = train_tuned("ppo", "BabbleReachPattern-v0", seed=3, steps=6_000)
    assert model.num_timesteps == 6_144
    assert evaluate(model, cases=scenarios("table1", 200)).rate("success") > 0.7


def test_sac_learns_whole_movements():
    settings = {"policy_kwargs": "dict(net_arch=[64, 64])"}
    model = train_tuned("sac", "BabbleReachPattern-v0", seed=3, steps=1_000, settings=settings)
    assert evaluate(model, cases=scenarios("table1", 200)).rate("success") > 0.5


def test_a_reflex_of_the_order_holds_in_learning_tests_and_zip():
    trainer = made("ppo-grasp", options={"enclosure_reflex": True})
    (interface,) = trainer.agent.env.get_attr("interface", 0)
    assert interface.options["enclosure_reflex"] is True
    assert trainer.arguments.option("enclosure_reflex") is True


def test_learning_options_hold_while_learning_and_not_in_tests():
    trainer = made("ppo-grasp", settings={"learning_options": {"diameters": [0.05]}})
    (interface,) = trainer.agent.env.get_attr("interface", 0)
    assert interface.options["diameters"] == [0.05]
    assert "diameters" not in trainer.arguments.options


@pytest.mark.parametrize("agent", ["ppo", "sac"])
def test_weights_that_are_nan_are_an_error(agent):
    trainer = made(agent)
    trainer.train(64 * AGENTS[agent][3], lambda: None)

    def spoil():
        with torch.no_grad():
            next(trainer.agent.policy.parameters()).fill_(torch.nan)

    with pytest.raises(DivergedError, match=r"returns NaN after \d+ control steps: .+ is NaN"):
        trainer.train(256 * AGENTS[agent][3], spoil)


def test_a_learning_rate_that_blows_up_is_an_error():
    trainer = made("ppo", settings={"learning_rate": 1e30})
    with pytest.raises(DivergedError, match="learning_rate"):
        trainer.train(10_000, lambda: None)


@pytest.mark.parametrize(
    ("agent", "changed", "named"),
    [
        (
            "ppo",
            {"settings": {"learning_rat": 1e-3}},
            "settings.learning_rat: .+'learning_rate'",
        ),
        ("ppo", {"settings": {"seed": 1}}, "settings.seed"),
        ("ppo", {"settings": {"gradient_steps": 1}}, "settings.gradient_steps"),
        ("ppo", {"settings": {"learning_rate": "fast"}}, "learning_rate = 'fast'"),
        ("ppo", {"settings": {"n_timesteps": 1}}, "settings.n_timesteps"),
        ("ppo", {"settings": {"n_envs": 0}}, "n_envs"),
        ("ppo", {"settings": {"n_steps": 1, "n_envs": 1}}, "settings of ppo"),
        ("ppo", {"settings": {"senses": ["smell"]}}, "senses = 'smell'"),
        ("ppo", {"settings": {"senses": []}}, "senses is empty"),
        ("ppo", {"options": {"control": "pattern"}}, "control = 'pattern'"),
        ("sac", {"options": {"control": "posture"}}, "control = 'posture'"),
        ("ppo", {"settings": {"learning_options": 3}}, "settings.learning_options = 3"),
        ("ppo", {"env_id": None}, "env_id is missing"),
        ("ppo", {"env_id": "BabbleReachSparse-v0"}, "no tuned settings"),
        ("ppo", {"options": {"retina": 3}}, "retina"),
        (
            "ppo",
            {"settings": {"policy_kwargs": "__import__('os').getcwd()"}},
            "policy_kwargs = .+ is not of the form",
        ),
    ],
)
def test_errors_name_what_is_wrong(agent, changed, named):
    with pytest.raises(ConfigError, match=named):
        made(agent, **changed)


def test_hindsight_needs_goals():
    settings = {"replay_buffer_class": "HerReplayBuffer"}
    with pytest.raises(ConfigError, match="BabbleReachGoal-v0"):
        made("sac", settings=settings)


def test_names_the_extra_that_is_missing(monkeypatch):
    monkeypatch.setitem(sys.modules, "yaml", None)
    monkeypatch.delitem(sys.modules, "gym_babble.study.tuned")
    with pytest.raises(MissingExtraError, match=r"PyYAML .+gym-babble\[sb3\]"):
        importlib.import_module("gym_babble.study.tuned")
