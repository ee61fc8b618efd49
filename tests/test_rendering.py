"""Pictures: no display, no graphics card, the right number of them, and they show what happens."""

from __future__ import annotations

import gymnasium
import numpy as np
import pytest
from comparing import BATCHES, GRASP_IDS, IDS, TASKS
from grasping import to_object
from gymnasium.error import ResetNeeded
from gymnasium.utils.save_video import save_video
from gymnasium.wrappers import RecordVideo

from gym_babble.envs import BabbleGraspEnv

each_task = pytest.mark.parametrize("task", TASKS)

SMALL = {"width": 96, "height": 64}
FREE = {"start": (0.25, 0.18), "target": (0.05, 0.33), "obstacle": None}
GRASP = {"start": (-0.7, 0.9), "object": (0.0, 0.2), "diameter": 0.06, "obstacle": None}
CASES = {"reach": FREE, "grasp": GRASP}


def reds(frame):
    """How many pixels are the target's or object's red."""
    red, green, blue = frame.astype(int).transpose(2, 0, 1)
    return ((red > 110) & (green < red / 2) & (blue < red / 2)).sum()


@pytest.mark.parametrize("camera", ["third_person", "eye"])
@each_task
def test_a_frame_has_the_size_asked_for_and_shows_the_arm_moving(task, camera):
    env_id = f"Babble{task.title()}-v0"
    env = gymnasium.make(env_id, render_mode="rgb_array", camera=camera, **SMALL)
    env.reset(seed=0, options=CASES[task])
    frames = [env.render()]
    for _ in range(10):
        env.step(np.ones(env.action_space.shape, np.float32))
        frames.append(env.render())
    for frame in frames:
        assert frame.shape == (64, 96, 3)
        assert frame.dtype == np.uint8
        assert len(np.unique(frame.reshape(-1, 3), axis=0)) > 20
        assert camera == "eye" or reds(frame) > 0
    assert len({frame.tobytes() for frame in frames}) > 5


@each_task
def test_the_cameras_differ_and_the_default_size_is_480(task):
    frames = []
    for camera in ("third_person", "eye"):
        env = TASKS[task](render_mode="rgb_array", camera=camera)
        env.reset(seed=0)
        frames.append(env.render())
        assert frames[-1].shape == (480, 480, 3)
    assert (frames[0] != frames[1]).any(axis=2).mean() > 0.2


@pytest.mark.parametrize(("task", "place"), [("reach", (0.16, 0.27)), ("grasp", (-0.2, 0.2))])
def test_the_obstacle_is_seen(task, place):
    env = TASKS[task](render_mode="rgb_array", **SMALL)
    env.reset(seed=0, options={**CASES[task], "obstacle": place})
    with_it = env.render()
    env.reset(seed=0, options=CASES[task])
    assert (with_it != env.render()).any(axis=2).sum() > 30


@pytest.mark.parametrize("camera", ["third_person", "eye"])
def test_a_larger_object_has_more_red_and_the_hand_can_be_seen_to_close(camera):
    env = BabbleGraspEnv(render_mode="rgb_array", camera=camera, width=240, height=240)
    red = {}
    for diameter in (0.024, 0.06):
        env.reset(seed=0, options={**GRASP, "diameter": diameter})
        red[diameter] = reds(env.render())
    assert red[0.06] > 3 * red[0.024] > 0
    open_hand = env.render()
    for _ in range(20):
        env.step([0, 0, 1, 1])
    assert (env.render() != open_hand).any(axis=2).sum() > 30


def test_the_fovea_is_the_middle_of_what_the_eye_sees_and_its_edges_are_what_is_sensed():
    # Catches rows for columns, and a picture of another gaze than the observation's.
    fovea, edges = (
        BabbleGraspEnv(render_mode="rgb_array", camera=camera, width=63, height=63)
        for camera in ("fovea", "edges")
    )
    eye = BabbleGraspEnv(obs="retina", retina_size=630, render_mode="rgb_array")
    actions = [[1, 0.5, 0, 0.5]] * 12
    for env in (fovea, edges, eye):
        observation, _ = env.reset(seed=0, options=GRASP)
    for action in actions:
        picture = edges.render()
        assert (picture == picture[..., :1]).all()
        blocks = picture[..., 0].reshape(21, 3, 21, 3).mean(axis=(1, 3)) / 255
        assert blocks.ravel() == pytest.approx(observation["fovea"], abs=0.01)
        assert blocks.max() > 0.2
        middle = observation["retina"][284:347, 284:347]
        near = np.abs(fovea.render().astype(int) - middle).max(axis=2) < 60
        assert near.mean() > 0.9
        for env in (fovea, edges, eye):
            observation = env.step(action)[0]


@each_task
def test_every_camera_has_the_size_asked_for(task):
    frames = {}
    for camera in ("third_person", "eye", "fovea", "edges"):
        env = TASKS[task](render_mode="rgb_array", camera=camera, width=100, height=70)
        env.reset(seed=0, options=CASES[task])
        frames[camera] = env.render()
        assert (frames[camera].shape, frames[camera].dtype) == ((70, 100, 3), np.uint8)
    assert len({frame.tobytes() for frame in frames.values()}) == 4
    # The fovea is the eye's view from near.
    assert reds(frames["fovea"]) > 20 * reds(frames["eye"])


def test_arm_and_hand_can_hide_the_object():
    # Unlike reaching's target, which shows through.
    env = BabbleGraspEnv(render_mode="rgb_array", camera="eye", width=400, height=400)
    red = []
    for start in ((-1.2, 0.2), (0.5, 1.0)):
        env.reset(options={"start": start, "object": (0.16, 0.34), "diameter": 0.024})
        red.append(reds(env.render()))
    assert 0 < red[1] < 0.8 * red[0]


@pytest.mark.parametrize(("size", "tint"), [(36, 1), (84, 20), (200, 60)])
@each_task
def test_the_eye_has_the_target_in_its_middle(task, size, tint):
    env = TASKS[task](obs="retina", retina_size=size)
    for seed in range(30):
        retina = env.reset(seed=seed)[0]["retina"].astype(int)
        redness = retina[..., 0] - retina[..., 1:].max(axis=2)
        edge = size // 2 - 1 - size // 50
        assert redness[edge : size - edge, edge : size - edge].max() >= tint


def test_pattern_control_shows_the_movement_in_50_ms_frames():
    env = gymnasium.make(IDS[3], render_mode="rgb_array_list", **SMALL)
    for _ in range(2):
        env.reset(seed=0, options=FREE)
        assert len(env.render()) == 1
        env.step(np.zeros(2, np.float32))
        frames = env.render()
        assert len(frames) == 224
        assert len({frame.tobytes() for frame in frames}) > 50
        assert env.render() == []
    env.reset(seed=0)
    env.step(np.zeros(2, np.float32))
    assert 2 <= len(env.render()) <= 225


@each_task
def test_a_list_has_the_frames_since_the_last_call(task):
    env = TASKS[task](render_mode="rgb_array_list", **SMALL)
    still = np.zeros(env.action_space.shape)
    env.reset(seed=0, options=CASES[task])
    for _ in range(3):
        env.step(still)
    assert len(env.render()) == 4
    env.step(still)
    assert len(env.render()) == 1
    env.reset()
    assert len(env.render()) == 1
    assert env.trajectory.shape == (1, 2)
    assert task == "grasp" or env.trajectory[0] == pytest.approx(FREE["start"])


def test_each_frame_of_a_list_is_the_picture_of_its_moment():
    # Catches the present hand or object in pictures of the past.
    listed, pictured = (
        BabbleGraspEnv(render_mode=mode, control="posture", **SMALL)
        for mode in ("rgb_array_list", "rgb_array")
    )
    info = pictured.reset(seed=0, options=GRASP)[1]
    listed.reset(seed=0, options=GRASP)
    shown, ended = [pictured.render()], False
    while not ended:
        action = to_object(pictured, info)
        _, _, ended, _, info = pictured.step(action)
        listed.step(action)
        shown.append(pictured.render())
    frames = listed.render()
    assert len(frames) == len(shown) == len(listed.trajectory)
    assert all((a == b).all() for a, b in zip(frames, shown, strict=True))


@pytest.mark.parametrize("mode", ["rgb_array", "rgb_array_list", "human"])
@each_task
def test_rendering_needs_a_reset_first(task, mode):
    with pytest.raises(ResetNeeded):
        TASKS[task](render_mode=mode).render()
    if mode != "human":
        with pytest.raises(ResetNeeded):
            BATCHES[task](2, render_mode=mode).render()


@each_task
def test_rendering_without_a_mode_says_so(task):
    env = TASKS[task]()
    env.reset(seed=0)
    with pytest.warns(UserWarning, match="render_mode"):
        assert env.render() is None
    envs = BATCHES[task](2)
    envs.reset(seed=0)
    with pytest.warns(UserWarning, match="render_mode"):
        assert envs.render() == (None, None)


@each_task
def test_frames_per_second_are_the_control_periods(task):
    assert gymnasium.make(f"Babble{task.title()}-v0").metadata["render_fps"] == 20
    assert TASKS[task].metadata["render_modes"] == ["human", "rgb_array", "rgb_array_list"]


@each_task
def test_rendering_changes_no_episode(task):
    hashes = []
    action = [0.5, -0.5] if task == "reach" else [0.5, -0.5, 1, 1]
    for mode in ("rgb_array", "rgb_array_list"):
        env = TASKS[task](render_mode=mode, **SMALL)
        env.reset(seed=3)
        for _ in range(5):
            env.step(action)
            if mode == "rgb_array":
                env.render()
        hashes.append(env.state_hash())
    assert hashes[0] == hashes[1]
    silent = TASKS[task]()
    silent.reset(seed=3)
    for _ in range(5):
        seen = silent.step(action)
    assert env.step(action)[1] == silent.step(action)[1]
    assert seen is not None


@pytest.mark.parametrize("env_id", [IDS[0], GRASP_IDS[0]])
def test_a_window_shows_the_episode(env_id, monkeypatch):
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    env = gymnasium.make(env_id, render_mode="human", **SMALL)
    env.reset(seed=0)
    for _ in range(3):
        env.step(np.zeros(env.action_space.shape, np.float32))
    assert env.render() is None
    env.close()
    env.close()
    env.reset(seed=1)
    env.close()


def clip_of(video):
    """Frames a second, size and seconds of a video."""
    moviepy = pytest.importorskip("moviepy")
    with moviepy.VideoFileClip(str(video)) as clip:
        return clip.fps, clip.size, clip.duration


@pytest.mark.parametrize("env_id", [IDS[0], GRASP_IDS[0]])
def test_videos_of_the_second_episode_too(env_id, tmp_path):
    env = gymnasium.make(env_id, render_mode="rgb_array", **SMALL)
    env = RecordVideo(env, str(tmp_path / "new"), episode_trigger=lambda _: True)
    for episode in range(2):
        env.reset(seed=episode)
        for _ in range(12):
            env.step(np.zeros(env.action_space.shape, np.float32))
    env.close()
    videos = sorted(tmp_path.glob("new/*.mp4"))
    assert len(videos) == 2
    for video in videos:
        assert clip_of(video) == (20, [96, 64], pytest.approx(13 / 20, abs=0.06))


def test_a_video_of_a_movement_in_pattern_control(tmp_path):
    env = gymnasium.make(IDS[3], render_mode="rgb_array_list", **SMALL)
    env.reset(seed=0, options=FREE)
    env.step(np.zeros(2, np.float32))
    save_video(env.render(), str(tmp_path), episode_trigger=lambda _: True, fps=20)
    (video,) = tmp_path.glob("*.mp4")
    assert clip_of(video) == (20, [96, 64], pytest.approx(225 / 20, abs=0.06))
