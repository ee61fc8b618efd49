"""The ways of the hand that a study stores are those of the tests."""

import numpy as np
import pytest

from gym_babble import evaluate, scenarios
from gym_babble.agents.loading import named_agent
from gym_babble.study.paths import MOST_POINTS, hand_paths


@pytest.mark.parametrize(
    ("env_id", "protocol"),
    [("BabbleReachPattern-v0", "table1"), ("BabbleReach-v0", "table1"), ("BabbleGrasp-v0", "full")],
)
def test_a_path_is_of_the_episode_that_the_test_plays(env_id, protocol):
    loaded, cases = named_agent("scripted", env_id=env_id), scenarios(protocol, 6, 1_000)
    paths = hand_paths(loaded, cases)
    assert tuple(one["outcome"] for one in paths) == evaluate("scripted", env_id, cases).outcomes
    assert all(len(one["path"]) <= MOST_POINTS for one in paths)


def test_a_path_leads_from_start_to_target():
    cases = scenarios("table1", 12, 1_000)
    for case, one in zip(cases, hand_paths(named_agent("scripted"), cases), strict=True):
        path = np.array(one["path"])
        assert np.linalg.norm(path[0] - case["start"]) < 2e-4  # Rounded to 0.1 mm.
        if one["outcome"] == "success":
            gaps = np.linalg.norm(path - case["target"], axis=1)
            assert gaps[-1] < gaps[0]
            assert gaps[-1] < 0.03
