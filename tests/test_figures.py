"""The figures, and the numbers behind them."""

import gymnasium
import numpy as np
import pytest
from matplotlib.image import imread

from gym_babble import HebbBabbling, Scripted, scenarios
from gym_babble.errors import ConfigError
from gym_babble.paper import fig2, fig4, fig5
from gym_babble.paper.fig4 import reached, switched, trajectories
from gym_babble.paper.fig5 import weight_sets
from gym_babble.study.rates import share
from gym_babble.viz import style
from gym_babble.viz.video import GAP, contact_sheet


@pytest.fixture(scope="module")
def hebb():
    return HebbBabbling(seed=0).learn(2_000)


@pytest.fixture(scope="module")
def found(hebb):
    return trajectories(hebb, scenarios("fig4"))


def lines_of(axes, style):
    """Lines with more than a point, in a style."""
    return [line for line in axes.lines if line.get_ls() == style and len(line.get_xdata()) > 1]


def test_fig2_has_a_curve_for_each_b1_from_hand_to_target():
    left, right = fig2.draw((0.3, 0.5, 0.7)).axes
    for line in left.lines:
        points = line.get_xydata()
        assert points[0] == pytest.approx([0, 0], abs=1e-6)
        assert points[-1] == pytest.approx([1, 1], abs=1e-3)
    assert len(left.lines) == 3
    straight = left.lines[1].get_xydata()
    assert straight[:, 0] == pytest.approx(straight[:, 1], abs=1e-9)
    paths = lines_of(right, "-")[:3]
    end = 20 * np.array([np.cos(np.radians(100)), np.sin(np.radians(100))])
    for path in paths:
        assert path.get_xydata()[-1] == pytest.approx(end, abs=0.05)
    # b1 above one half passes on the left of the way from hand to target.
    middle = paths[2].get_xydata()[100]
    assert np.cross([*end, 0], [*middle, 0])[2] > 0


def test_fig4_draws_each_trajectory_once_bold_where_it_reaches(found):
    left, right = fig4.draw(found, found[:3]).axes
    reaching = [one for one in found if one.outcome == "success"]
    assert 0 < len(reaching) < len(found)
    assert len(lines_of(left, "-")) == len(reaching)
    assert len(lines_of(left, ":")) == len(found) - len(reaching)
    assert len(lines_of(right, "-")) + len(lines_of(right, ":")) == 3
    assert lines_of(left, "-")[0].get_lw() > 1.5


def test_trajectories_lead_from_start_to_target(found):
    for one in found:
        assert one.fingertip[0] == pytest.approx(one.case["start"], abs=1e-6)
        if one.outcome == "success":
            assert np.linalg.norm(one.fingertip[-1] - one.case["target"]) < 0.02


def test_trajectories_curve_as_b1_says():
    one = trajectories(Scripted(), scenarios("fig4")[:1])[0]
    start, target = np.array(one.case["start"]), np.array(one.case["target"])
    middle = one.fingertip[len(one.fingertip) // 3]
    turn = np.cross([*(target - start), 0], [*(middle - start), 0])[2]
    assert (turn > 0) == (one.b1 > 0.5)


def test_switched_exchanges_start_and_obstacle():
    case = scenarios("fig4")[0]
    other = switched(case)
    assert other["start"] == case["obstacle"][:2]
    assert other["obstacle"] == (*case["start"], case["obstacle"][2])
    assert switched(other) == case


@pytest.mark.parametrize("config", ["paper", "icub"])
def test_every_start_of_fig4_is_played_on_both_sides(config):
    """Otherwise the figure shows the starts that suit it. The right side needs no curve."""
    cases = scenarios("fig4", config=config)
    assert len({case["start"] for case in cases}) == 4 * 36
    env = gymnasium.make("BabbleReachPattern-v0", config=config)
    counts = reached(Scripted(env), config=config)
    assert counts["cases"] == 4 * 36
    found = counts["reached"]
    assert found["agent"] == found["scripted"]
    assert found["straight"]["halfway"] == 0
    assert found["straight"]["switched"] > 0.9 * 144
    assert found["random"]["halfway"] < 0.6 * found["scripted"]["halfway"]


def test_fig5_sets_are_mirrored(hebb):
    sets = weight_sets(hebb)
    assert not (sets.left & sets.right).any()
    assert min(sets.left.sum(), sets.right.sum()) > 20
    assert sets.mirror_correlation > 0.95
    # Weights of the left set are highest where b1 is above one half.
    b2, b1 = np.unravel_index(sets.mean(sets.left).argmax(), (21, 21))
    assert b1 > 10 > b2
    assert sets.left[sets.typical(sets.left)]


def test_fig5_has_four_patterns_and_the_map(hebb):
    figure = fig5.draw(weight_sets(hebb))
    pictures = [axes.images[0].get_array() for axes in figure.axes if axes.images]
    assert [picture.shape for picture in pictures[:5]] == [(21, 21)] * 5


def test_fig5_shows_a_gaze_of_the_conjunctive_map_and_rules_without_a_bound():
    agent = HebbBabbling(variant="conjunctive", seed=0).learn(4_000)
    sets = weight_sets(agent, gaze=fig5.strongest_gaze(agent))
    assert sets.patterns.shape == (11, 11, 21, 21)
    assert sets.field_deg == 30.0
    oja = weight_sets(HebbBabbling(rule="oja", seed=0).learn(1_000))
    assert oja.w_max == pytest.approx(np.abs(oja.patterns).max())


def test_fig5_needs_the_papers_map_and_some_learning():
    with pytest.raises(ConfigError, match="paper"):
        weight_sets(HebbBabbling(variant="conjunctive"))
    with pytest.raises(ConfigError, match="more movements"):
        weight_sets(HebbBabbling())


def test_the_same_figure_is_the_same_svg():
    assert style.svg(fig2.draw((0.3,))) == style.svg(fig2.draw((0.3,)))


def test_saved_figures_are_pictures_with_ink(tmp_path, hebb):
    style.save(fig5.draw(weight_sets(hebb)), tmp_path / "fig5.png")
    picture = imread(tmp_path / "fig5.png")
    assert picture.shape[0] > 300
    assert picture[..., :3].std() > 0.05


def test_a_contact_sheet_begins_and_ends_with_the_film():
    frames = [np.full((4, 4, 3), i, np.uint8) for i in range(30)]
    sheet = contact_sheet(frames)
    assert sheet.shape == (2 * 4 + GAP, 3 * 4 + 2 * GAP, 3)
    assert (sheet[4 : 4 + GAP] == 255).all()
    assert sheet[0, 0, 0] == 0
    assert sheet[-1, -1, 0] == 29


def test_share_has_four_characters():
    assert [share(x) for x in (0.0, 0.67, 1.0)] == [".000", ".670", "1.00"]
