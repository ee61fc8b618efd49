"""Pictures: no display, no graphics card, the right number of them, and they show what happens."""

from __future__ import annotations

import gymnasium
import numpy as np
import pytest
from comparing import IDS
from gymnasium.error import ResetNeeded
from gymnasium.utils.save_video import save_video
from gymnasium.wrappers import RecordVideo

from gym_babble.envs import BabbleReachEnv, BabbleReachVectorEnv

SMALL = {"width": 96, "height": 64}
FREE = {"start": (0.25, 0.18), "target": (0.05, 0.33), "obstacle": None}


def reds(frame):
    """How many pixels are the target's red."""
    red, green, blue = frame.astype(int).transpose(2, 0, 1)
    return ((red > 110) & (green < red / 2) & (blue < red / 2)).sum()


@pytest.mark.parametrize("camera", ["third_person", "eye"])
def test_a_frame_has_the_size_asked_for_and_shows_the_arm_moving(camera):
    env = gymnasium.make(IDS[0], render_mode="rgb_array", camera=camera, **SMALL)
    env.reset(seed=0, options=FREE)
    frames = [env.render()]
    for _ in range(10):
        env.step(np.array([1, 1], np.float32))
        frames.append(env.render())
    for frame in frames:
        assert frame.shape == (64, 96, 3)
        assert frame.dtype == np.uint8
        assert len(np.unique(frame.reshape(-1, 3), axis=0)) > 20
        assert camera == "eye" or reds(frame) > 0
    assert len({frame.tobytes() for frame in frames}) > 5


def test_the_cameras_differ_and_the_default_size_is_480():
    frames = []
    for camera in ("third_person", "eye"):
        env = BabbleReachEnv(render_mode="rgb_array", camera=camera)
        env.reset(seed=0)
        frames.append(env.render())
        assert frames[-1].shape == (480, 480, 3)
    assert (frames[0] != frames[1]).any(axis=2).mean() > 0.2


def test_the_obstacle_is_seen():
    env = BabbleReachEnv(render_mode="rgb_array", **SMALL)
    env.reset(seed=0, options={**FREE, "obstacle": (0.16, 0.27)})
    with_it = env.render()
    env.reset(seed=0, options=FREE)
    assert (with_it != env.render()).any(axis=2).sum() > 30


@pytest.mark.parametrize(("size", "tint"), [(36, 1), (84, 20), (200, 60)])
def test_the_eye_has_the_target_in_its_middle(size, tint):
    env = BabbleReachEnv(obs="retina", retina_size=size)
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


def test_a_list_has_the_frames_since_the_last_call():
    env = BabbleReachEnv(render_mode="rgb_array_list", **SMALL)
    env.reset(seed=0, options=FREE)
    for _ in range(3):
        env.step([0, 0])
    assert len(env.render()) == 4
    env.step([0, 0])
    assert len(env.render()) == 1
    env.reset()
    assert len(env.render()) == 1
    assert env.trajectory.shape == (1, 2)
    assert env.trajectory[0] == pytest.approx(FREE["start"])


@pytest.mark.parametrize("mode", ["rgb_array", "rgb_array_list", "human"])
def test_rendering_needs_a_reset_first(mode):
    with pytest.raises(ResetNeeded):
        BabbleReachEnv(render_mode=mode).render()
    if mode != "human":
        with pytest.raises(ResetNeeded):
            BabbleReachVectorEnv(2, render_mode=mode).render()


def test_rendering_without_a_mode_says_so():
    env = BabbleReachEnv()
    env.reset(seed=0)
    with pytest.warns(UserWarning, match="render_mode"):
        assert env.render() is None
    envs = BabbleReachVectorEnv(2)
    envs.reset(seed=0)
    with pytest.warns(UserWarning, match="render_mode"):
        assert envs.render() == (None, None)


def test_frames_per_second_are_the_control_periods():
    assert BabbleReachEnv.metadata["render_fps"] == 20
    assert gymnasium.make(IDS[0]).metadata["render_fps"] == 20
    assert BabbleReachEnv.metadata["render_modes"] == ["human", "rgb_array", "rgb_array_list"]


def test_rendering_changes_no_episode():
    hashes = []
    for mode in ("rgb_array", "rgb_array_list"):
        env = BabbleReachEnv(render_mode=mode, **SMALL)
        env.reset(seed=3)
        for _ in range(5):
            env.step([0.5, -0.5])
            if mode == "rgb_array":
                env.render()
        hashes.append(env.state_hash())
    assert hashes[0] == hashes[1]
    silent = BabbleReachEnv()
    silent.reset(seed=3)
    for _ in range(5):
        seen = silent.step([0.5, -0.5])
    assert env.step([0, 0])[1] == silent.step([0, 0])[1]
    assert seen is not None


def test_a_window_shows_the_episode(monkeypatch):
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    env = gymnasium.make(IDS[0], render_mode="human", **SMALL)
    env.reset(seed=0)
    for _ in range(3):
        env.step(np.zeros(2, np.float32))
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


def test_videos_of_the_second_episode_too(tmp_path):
    env = gymnasium.make(IDS[0], render_mode="rgb_array", **SMALL)
    env = RecordVideo(env, str(tmp_path / "new"), episode_trigger=lambda _: True)
    for episode in range(2):
        env.reset(seed=episode)
        for _ in range(12):
            env.step(np.zeros(2, np.float32))
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
