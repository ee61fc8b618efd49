"""Films: agents side by side on one case, the eye's view, and the maps of Hebb agents."""

from __future__ import annotations

import sys
from io import BytesIO

import gymnasium
import numpy as np
import pytest
from comparing import assert_same
from PIL import Image

from gym_babble import HebbBabbling, Oracle, Scripted, evaluate, scenarios
from gym_babble.agents.loading import acting_agent
from gym_babble.envs import BabbleGraspEnv, BabbleReachEnv
from gym_babble.errors import ActionError, ConfigError, ScenarioError
from gym_babble.viz import scenes
from gym_babble.viz.episode import play
from gym_babble.viz.film import GAP, HOLD_S, Film, Scene, panel_width
from gym_babble.viz.maps import ACTIVITY, AgentMaps, MapPicture, colour_map
from gym_babble.viz.panel import Panel, PanelSize
from gym_babble.viz.scenes import check_same_task, find_cases, play_scene, stages
from gym_babble.viz.video import film_bytes

CHAIN = ("pregrasp", "contact", "hand")


@pytest.fixture(scope="module", params=["paper", "conjunctive", "grasp", "chain"])
def learnt(request):
    """A small agent of each network; tests do not change it."""
    if request.param == "grasp":
        return HebbBabbling("BabbleGrasp-v0", seed=1).learn(20)
    if request.param == "chain":
        return HebbBabbling("BabbleGrasp-v0", variant="chain", seed=1).learn(20)
    return HebbBabbling(variant=request.param, seed=1, quasi_static=True).learn(250)


@pytest.fixture(scope="module")
def reaching_file(tmp_path_factory):
    path = tmp_path_factory.mktemp("agents") / "hebb"
    HebbBabbling(seed=0, quasi_static=True).learn(250).save(path)
    return path


def first_observation(agent):
    env = gymnasium.make("BabbleGrasp-v0" if len(agent.weights) > 3 else "BabbleReachPattern-v0")
    return env.reset(seed=5)[0]


def test_what_is_seen_recalls_what_is_recalled(learnt):
    # Eq. 4, from input maps, weights and output maps as the film shows them.
    observation = first_observation(learnt)
    weights = [w for name, w in learnt.weights.items() if name.endswith("weights")]
    seen, recalled = learnt.perceive(observation), learnt.recall(observation)
    if learnt.variant == "chain":  # The routes' weights are no maps of what is seen.
        weights = weights[:3]
    assert len(seen) == len(recalled) == len(weights)
    assert next(iter(seen.values())).shape == learnt.input_shape
    for g, a, w in zip(seen.values(), recalled.values(), weights, strict=True):
        expected = np.tanh(np.maximum(w @ g.ravel(), 0.0)).reshape(a.shape)
        assert a == pytest.approx(expected, abs=1e-5)
    with pytest.raises(ConfigError, match="perceive takes one observation, got 2"):
        learnt.perceive(np.zeros((2, 460 if len(weights) > 1 else 11), np.float32))


def test_an_untaught_agent_learns_the_same_again(learnt):
    again = learnt.untaught()
    assert (again.learnt, again.babbled, again.seed) == (0, 0, learnt.seed)
    assert not any(array.any() for array in again.weights.values())
    again.learn(learnt.learnt)
    assert again.to_bytes() == learnt.to_bytes()


@pytest.mark.parametrize("env", [BabbleReachEnv, BabbleGraspEnv])
def test_a_picture_of_a_moment_is_the_frame_of_that_moment(env):
    listed = env("rgb_array_list", width=64, height=48)
    listed.reset(seed=3)
    assert listed.moments == 1
    for _ in range(4):
        listed.step(listed.action_space.sample())
    assert listed.moments == 5
    assert_same([listed.picture("third_person", (64, 48), k) for k in range(5)], listed.render())
    silent = env(record=True)
    silent.reset(seed=3)
    assert_same(silent.picture("eye", (32, 32), 0), listed.picture("eye", (32, 32), 0))
    for moment in (5, -1, 1.5):
        with pytest.raises(ConfigError, match=r"moment = \S+ is not a whole number in \[0, 4\]"):
            listed.picture("eye", (32, 32), moment)
    with pytest.raises(ConfigError, match="camera"):
        listed.picture("nose", (32, 32), 0)


@pytest.mark.parametrize(
    ("env_id", "options"),
    [
        ("BabbleReachPattern-v0", {}),
        ("BabbleReach-v0", {"obs": "flat"}),
        ("BabbleGrasp-v0", {}),
    ],
)
def test_an_episode_of_a_film_ends_as_in_the_evaluation(env_id, options):
    agent = Scripted(gymnasium.make(env_id, **options))
    cases = find_cases([acting_agent(agent)], [0, 3, 7])
    result = evaluate(agent, cases=cases)
    episodes = [play(acting_agent(agent), case) for case in cases]
    assert [episode.outcome for episode in episodes] == list(result.outcomes)
    for episode, steps in zip(episodes, result.steps, strict=True):
        assert episode.moments == episode.env.moments
        if env_id == "BabbleReachPattern-v0":
            # One step, chosen for what the first moment shows.
            assert len({id(one) for one in episode.observations[:-1]}) == 1
        else:
            assert episode.moments == steps + 1


def scene_of(*agents):
    case = scenarios("table1", 1)[0]
    return Scene(
        [Panel(f"agent {k}", "", play(acting_agent(a), case)) for k, a in enumerate(agents)]
    )


def test_a_film_takes_simulated_time_and_stands_still_at_the_end():
    scene = scene_of(Scripted("BabbleReachPattern-v0"), Scripted("BabbleReach-v0"))
    seconds = [panel.episode.seconds for panel in scene.panels]
    for fps, speed in ((20, 1.0), (10, 2.0), (7.5, 1.0)):
        film = Film([scene, scene], 160, fps, speed)
        still = round(HOLD_S * fps)
        one = np.ceil(round(max(seconds) / speed * fps, 6)) + still
        assert len(film) == 2 * one
        assert_same(film.frame(int(one) - 1), film.frame(int(one) - still))
        assert (film.frame(int(one) - still) != film.frame(int(one) - still - 1)).any()
        assert_same(film.frame(int(one)), film.frame(0))
        assert all(length % 2 == 0 for length in film.frame(0).shape[:2])
    with pytest.raises(IndexError):
        film.frame(len(film))
    # In real time each frame has the picture of its control step, and all agents the same time.
    film, size = Film([scene], 320, 20), PanelSize(320, 0)
    view = slice(size.header + size.width // 2, size.header + size.width * 3 // 4)
    for k in (0, 5, 40):
        frame = film.frame(k)
        for i, panel in enumerate(scene.panels):
            left = i * (size.width + GAP)
            picture = panel.episode.env.picture("third_person", (320, 320), k)
            assert_same(frame[view, left : left + 320], picture[160:240])


def test_the_eyes_view_is_inset():
    scene = scene_of(Scripted())
    size = PanelSize(320, 0)
    eye = scene.panels[0].episode.env.picture("eye", (size.eye, size.eye), 10)
    panel = scene.panels[0].draw(10, size)
    left, top = 320 - size.margin - size.eye, size.header + size.margin
    below_its_name = slice(top + size.eye // 2, top + size.eye)
    assert_same(panel[below_its_name, left : left + size.eye], eye[size.eye // 2 :])


def test_a_panel_says_what_happens_at_each_moment():
    episode = play(acting_agent(Scripted()), scenarios("table1", 1)[0])
    said = ["first"] * 5 + ["then"] * (episode.moments - 5)
    size = PanelSize(160, 0)
    changing = Panel("x", said, episode)
    for moment, text in ((0, "first"), (4, "first"), (5, "then"), (10**6, "then"), (0, "first")):
        still = Panel("x", text, episode)
        assert_same(changing.draw(moment, size), still.draw(moment, size))


def test_a_map_shows_its_neurons_in_their_places(learnt):
    pictures = AgentMaps(learnt).pictures(first_observation(learnt))
    sizes = learnt.brain.get("sizes", 0)
    for sees, weights, recalls in pictures:
        assert (sees.title, recalls.title) in {
            ("obstacle", "movement"),
            ("target, obstacle", "movement"),
            ("eye", "arm"),
            ("fovea", "hand"),
            *((f"eye, size {k + 1} of {sizes}", name) for k in range(sizes) for name in CHAIN),
        }
        assert weights.title == ("weights in" if sees.title == "fovea" else "weights out")
        for picture in (sees, weights, recalls):
            side = len(picture.values)
            coloured = colour_map(picture, 5 * side)
            assert coloured.shape == (5 * side, 5 * side, 3)
            # The strongest neuron has the last colour of a map of activities.
            row, column = np.unravel_index(picture.values.argmax(), picture.values.shape)
            if picture.colours == ACTIVITY and picture.high > 0:
                assert tuple(coloured[5 * row + 2, 5 * column + 2]) == ACTIVITY[-1]
    one = np.zeros((3, 3), np.float32)
    one[0, 2] = 1.0
    coloured = colour_map(MapPicture("", one, 0.0, 1.0, ACTIVITY), 30)
    assert tuple(coloured[5, 25]) == ACTIVITY[-1]
    assert (
        np.delete(coloured.reshape(3, 10, 3, 10, 3)[:, 5, :, 5].reshape(9, 3), 2, 0) == 255
    ).all()


def test_the_chains_maps_are_marked_within_their_margins():
    # Of the arm's maps two neurons on each side lie beyond the joint limits; the hand's have none.
    agent = HebbBabbling("BabbleGrasp-v0", variant="chain")
    row, column = 4, 15
    weights = {f"{name}.weights": agent.weights[f"{name}.weights"] for name in CHAIN}
    for array in weights.values():
        array[row * 21 + column] = 0.2
    agent.weights = weights
    pictures = AgentMaps(agent).pictures(first_observation(agent))
    assert tuple(recalls.title for _, _, recalls in pictures) == CHAIN
    for _, _, recalls in pictures:
        assert recalls.mark == pytest.approx((column / 20, (20 - row) / 20), abs=1e-6)


@pytest.mark.parametrize("name", ["movement", "arm"])
def test_the_mark_is_where_the_map_is_read_out(name):
    # One output neuron recalled alone: Eq. 4 reads out its place.
    env_id = "BabbleReachPattern-v0" if name == "movement" else "BabbleGrasp-v0"
    agent = HebbBabbling(env_id)
    key = "weights" if name == "movement" else "reach.weights"
    weights = agent.weights
    row, column = 4, 15
    weights[key][row * 21 + column] = 0.2
    agent.weights = {key: weights[key]}
    _, _, recalls = AgentMaps(agent).pictures(first_observation(agent))[0]
    assert np.unravel_index(recalls.values.argmax(), (21, 21)) == (20 - row, column)
    assert recalls.mark == pytest.approx((column / 20, (20 - row) / 20), abs=1e-6)


def test_nothing_is_marked_before_learning():
    agent = HebbBabbling()
    assert [m.mark for m in AgentMaps(agent).pictures(first_observation(agent))[0]] == [None] * 3


def test_the_maps_are_live():
    agent = HebbBabbling("BabbleGrasp-v0", seed=1).learn(10)
    case = scenarios("palm_side", 1)[0]
    panel = Panel("hebb", "", play(acting_agent(agent), case))
    maps = slice(PanelSize(160, 2).header + 160, None)
    first, last = (panel.draw(k, PanelSize(160, 2))[maps] for k in (0, panel.episode.moments - 1))
    assert (first != last).any()
    assert_same(panel.draw(0, PanelSize(160, 2))[maps], first)
    alone = play_scene({"a": acting_agent(Scripted("BabbleGrasp-v0"))}, case)
    # Without an agent that has maps there is no room for them.
    assert Film([alone], 160, 20).frame(0).shape[0] == PanelSize(160, 0).height


def test_stages_are_the_agent_as_it_learnt():
    agent = HebbBabbling(seed=2, quasi_static=True).learn(60)
    found = stages(acting_agent(agent), [0, 30, 60])
    assert list(found) == ["after 0 babbles", "after 30 babbles", "after 60 babbles"]
    learnt = [one.agent.learnt for one in found.values()]
    assert learnt == [0, 30, 60]
    assert found["after 60 babbles"].agent.to_bytes() == agent.to_bytes()
    for wrong in ([], [30, 10], [5, 5], [-1, 3]):
        with pytest.raises(ConfigError, match=r"learning = .* ascending"):
            stages(acting_agent(agent), wrong)
    with pytest.raises(ConfigError, match="does not learn by babbling"):
        stages(acting_agent(Oracle()), [1])


def test_cases_are_those_of_the_protocol_with_goals_where_one_needs_them():
    goal = acting_agent(Scripted("BabbleGraspGoal-v0"))
    plain = acting_agent(Scripted("BabbleGrasp-v0"))
    expected = scenarios("palm_side", 5, 1_000, goal=True)
    assert find_cases([plain, goal], [4, 1], seed=1_000) == [expected[4], expected[1]]
    scene = play_scene({"plain": plain, "goal": goal}, expected[0])
    assert len(scene.panels) == 2
    # Some of the cases of Table II cannot be played: those that remain keep their numbers.
    (case,) = find_cases([plain], [143], "table2")
    assert case["index"] == 143
    with pytest.raises(ConfigError, match="case = 999999: 'table2' has no such case"):
        find_cases([plain], [999_999], "table2")


def test_an_agent_that_cannot_play_is_named():
    paper, icub = (acting_agent(Scripted(BabbleReachEnv(config=c))) for c in ("paper", "icub"))
    grasp = acting_agent(Scripted("BabbleGrasp-v0"))
    (case,) = find_cases([paper], [0])
    with pytest.raises(ScenarioError, match=r"^the other: .*config 'paper'"):
        play_scene({"the one": paper, "the other": icub}, case)
    with pytest.raises(ConfigError, match="the one acts in reaching, and the other in grasping"):
        check_same_task({"the one": paper, "the other": grasp})

    class Lost:
        env = "BabbleReach-v0"

        def predict(self, observation):
            del observation
            return np.full(2, np.nan)

    with pytest.raises(ActionError, match=r"^lost: "):
        play_scene({"lost": acting_agent(Lost())}, case)


@pytest.mark.parametrize("panels", range(1, 9))
def test_panels_fit_a_page(panels):
    columns, width = min(panels, 4), panel_width(panels)
    assert width % 2 == 0
    assert width == 480 or 1270 <= columns * width + (columns - 1) * GAP <= 1280


def test_files_have_the_films_size_and_time(tmp_path):
    moviepy = pytest.importorskip("moviepy")
    film = Film([scene_of(Scripted())], 160, 7.5, 4.0)
    height, width, _ = film.frame(0).shape
    with Image.open(BytesIO(film_bytes(film, ".gif"))) as gif:
        assert gif.size == (width, height)
        shown = 0
        for k in range(gif.n_frames):
            gif.seek(k)
            shown += gif.info["duration"]
            assert gif.info["duration"] % 10 == 0
        assert shown == pytest.approx(1000 * len(film) / 7.5, abs=10)
        # Colours are few, and the same in all frames; the background is white.
        last = np.asarray(gif.convert("RGB"))
        assert tuple(last[0, -1]) == (255, 255, 255)
        assert np.abs(last.astype(int) - film.frame(len(film) - 1)).mean() < 5
    path = tmp_path / "film.mp4"
    path.write_bytes(film_bytes(film, ".mp4"))
    with moviepy.VideoFileClip(str(path)) as clip:
        assert tuple(clip.size) == (width, height)
        assert clip.fps == 7.5
        assert clip.duration == pytest.approx(len(film) / 7.5, abs=0.2)
        assert np.abs(clip.get_frame(0).astype(int) - film.frame(0)).mean() < 5
    with Image.open(BytesIO(film_bytes(film, ".png"))) as sheet:
        assert sheet.width == 3 * width + 12


def test_record_films_agents_by_name_and_file_where_the_file_acts(run, tmp_path, reaching_file):
    words = ("--case", 1, "--case", 2, "--size", 160, "--fps", 1, "--title", "Hebb", "--title", "?")
    for ending, begins in ((".gif", b"GIF8"), (".mp4", b"\x00\x00\x00"), (".png", b"\x89PNG")):
        path = tmp_path / f"film{ending}"
        code, out, told = run("record", reaching_file, "random", *words, "--out", path)
        assert (code, out) == (0, "")
        assert path.read_bytes().startswith(begins)
        assert told.count("Hebb: ") == told.count("?: ") == 2
    code, _, told = run(
        *("record", reaching_file, "--learning", "0,20", "--size", 160, "--fps", 1),
        *("--out", tmp_path / "learning.gif"),
    )
    assert code == 0
    assert "after 20 babbles: " in told


def test_agents_by_name_act_where_the_file_acts(run, tmp_path, learnt):
    learnt.save(tmp_path / "agent")
    words = ("--size", 160, "--fps", 1, "--protocol")
    protocol = "palm_side" if len(learnt.weights) > 3 else "table1"
    names = ("oracle", tmp_path / "agent", "oracle")
    code, _, told = run("record", *names, *words, protocol, "--out", tmp_path / "film.png")
    assert code == 0
    assert "oracle: " in told
    assert "oracle (2): " in told
    code, _, told = run(
        *("record", "random", tmp_path / "agent", "--config", "icub", "--out", tmp_path / "x.png")
    )
    assert code == 2
    assert told.startswith(f"error: {tmp_path / 'agent'}: ")
    # The other task's cases are refused before anything is drawn.
    other = "table1" if protocol == "palm_side" else "palm_side"
    code, _, told = run("record", *names, *words, other, "--out", tmp_path / "other.png")
    assert code == 2
    assert "oracle" in told
    assert not (tmp_path / "other.png").exists()


@pytest.mark.parametrize(
    ("ending", "module", "extra"),
    [(".mp4", "moviepy", "video"), (".mp4", "PIL", "figures"), (".gif", "PIL", "figures")],
)
def test_a_missing_extra_is_found_before_playing(  # noqa: PLR0917 - fixtures
    run, monkeypatch, tmp_path, ending, module, extra
):
    def refuse(*_):
        raise AssertionError("played before the extras were checked")

    monkeypatch.setattr(scenes, "play", refuse)
    for name in [name for name in sys.modules if name.partition(".")[0] == module]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, module, None)
    code, _, told = run("record", "random", "--out", tmp_path / f"film{ending}")
    assert code == 1
    assert f"gym-babble[{extra}]" in told


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["random", "--out", "film.avi"], "film.avi: the name of a film must end with one of .mp4"),
        (["random", "--out", "film"], "must end with"),
        (["random", "--out", "no/film.gif"], "no/film.gif"),
        (["--out", "film.gif"], "agents"),
        (["nobody", "--out", "film.gif"], "nobody"),
        (["random", "--protocol", "table3", "--out", "film.gif"], "table3"),
        (["random", "--protocol", "fig4", "--case", "500", "--out", "film.gif"], "case = 500"),
        (["random", "--case", "-1", "--out", "film.gif"], "--case"),
        (["random", "--title", "a", "--title", "b", "--out", "film.gif"], "2 titles for 1 agents"),
        (["random", "--learning", "10", "--out", "film.gif"], "does not learn by babbling"),
        (["random", "--learning", "ten", "--out", "film.gif"], "'ten' is not a list"),
        (["random", "oracle", "--learning", "1", "--out", "film.gif"], "takes one agent"),
        (["random", "--fps", "60", "--out", "film.gif"], "--fps"),
        (["random", "--speed", "0", "--out", "film.gif"], "--speed"),
        (["random", "--camera", "nose", "--out", "film.gif"], "--camera"),
        (["random", "--size", "100", "--out", "film.gif"], "--size"),
        (["random", "--vec-normalize", "no.pkl", "--out", "film.gif"], "not a zip"),
    ],
)
def test_bad_input_is_one_line_and_no_file(run, monkeypatch, tmp_path, words, said):
    monkeypatch.chdir(tmp_path)
    code, printed, told = run("record", *words)
    assert (code, printed) == (2, "")
    assert told.startswith("error: ")
    assert told.count("\n") == 1
    assert said in told
    assert not list(tmp_path.iterdir())
