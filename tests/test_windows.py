"""Windows of `render_mode="human"`: each environment has its own."""

from __future__ import annotations

import gymnasium
import numpy as np
import pytest
from comparing import GRASP_IDS, IDS

pygame = pytest.importorskip("pygame")


@pytest.fixture(autouse=True)
def dummy_screen(monkeypatch):
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    yield
    pygame.quit()


def opened(env_id=IDS[0], edge=64):
    env = gymnasium.make(env_id, render_mode="human", width=edge, height=edge)
    env.reset(seed=0)
    return env


def play(env):
    env.step(np.zeros(env.action_space.shape, np.float32))
    env.render()
    env.reset()


def window_of(env):
    return env.unwrapped._window._window


def pixels(env):
    return pygame.surfarray.array3d(window_of(env).get_surface())


@pytest.mark.parametrize("env_id", [IDS[0], GRASP_IDS[0]])
def test_closing_one_window_leaves_the_others(env_id):
    first, second = opened(edge=64), opened(env_id, edge=96)
    assert window_of(first).size == (64, 64)
    assert window_of(second).size == (96, 96)
    first.close()
    before = window_of(second)
    play(second)
    assert window_of(second) is before
    play(first)  # It opens again.
    second.close()
    second.close()
    play(first)


def test_a_window_shows_its_own_environment():
    one, other = opened(), opened()
    still = pixels(one).copy()
    for _ in range(5):
        other.step(np.ones(other.action_space.shape, np.float32))
    assert (pixels(one) == still).all()
    assert (pixels(other) != still).any()


def test_other_environments_of_pygame_go_on_and_so_do_ours_without_them():
    cart = gymnasium.make("CartPole-v1", render_mode="human")
    cart.reset(seed=0)
    ours = opened()
    cart.step(0)
    ours.close()
    cart.step(0)
    cart.render()
    play(ours)
    cart.close()  # Quits pygame, for the whole process.
    play(ours)
    pygame.display.quit()
    play(ours)
    ours.close()


def test_a_window_closed_by_its_user_stays_closed_and_the_episode_goes_on():
    kept, closed = opened(), opened()
    pygame.event.post(pygame.event.Event(pygame.WINDOWCLOSE, window=window_of(closed)))
    play(kept)  # Another window's event is left to it.
    assert window_of(kept) is not None
    for _ in range(3):
        play(closed)
    assert window_of(closed) is None
    play(kept)
    closed.close()
    play(closed)  # Closed by the program it opens again, as at first.
    assert window_of(closed) is not None


def test_events_are_left_to_the_program():
    env = opened()
    pygame.event.clear()
    pygame.event.post(pygame.event.Event(pygame.KEYDOWN, key=pygame.K_SPACE))
    play(env)
    assert [event.key for event in pygame.event.get(pygame.KEYDOWN)] == [pygame.K_SPACE]
