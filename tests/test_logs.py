"""Learning curves from stable-baselines3's logs, and errors for files that are none."""

import shutil

import numpy as np
import pytest

from gym_babble.errors import ConfigError, StudyError
from gym_babble.study.logs import read_curve, read_evaluations, read_monitor

HEADER = '#{"t_start": 100.0, "env_id": "BabbleReach-v0"}\n'


def monitor(path, successes, *, start=100.0, length=10):
    """A monitor file whose episodes end every second."""
    rows = [f"1.0,{length},{k + 1}.5,{success}\n" for k, success in enumerate(successes)]
    path.write_text(HEADER.replace("100.0", str(start)) + "r,l,t,is_success\n" + "".join(rows))
    return path


def evaluations(path, **fields):
    np.savez(path, **fields)
    return path


@pytest.fixture(scope="module")
def run_folder(tmp_path_factory):
    """The logs of a short training with stable-baselines3."""
    learning = pytest.importorskip("stable_baselines3")
    from stable_baselines3.common.callbacks import EvalCallback  # noqa: PLC0415
    from stable_baselines3.common.env_util import make_vec_env  # noqa: PLC0415

    folder = tmp_path_factory.mktemp("run")
    options = {"env_kwargs": {"obs": "flat"}, "monitor_kwargs": {"info_keywords": ("is_success",)}}
    env = make_vec_env("BabbleReachPattern-v0", 2, monitor_dir=str(folder), **options)
    test = make_vec_env("BabbleReachPattern-v0", 1, **options)
    callback = EvalCallback(
        test, log_path=str(folder), eval_freq=64, n_eval_episodes=5, verbose=0, warn=False
    )
    model = learning.PPO("MlpPolicy", env, n_steps=64, batch_size=64, n_epochs=1, device="cpu")
    model.learn(256, callback=callback)
    env.close()
    return folder


def test_the_evaluations_of_a_training(run_folder):
    curve = read_evaluations(run_folder / "evaluations.npz", steps_per_action=20)
    with np.load(run_folder / "evaluations.npz") as arrays:
        assert curve.control_steps.tolist() == (20 * arrays["timesteps"]).tolist() == [2560, 5120]
        assert curve.success == pytest.approx(arrays["successes"].mean(axis=1))
    again = read_curve(run_folder, steps_per_action=20)
    assert again.control_steps.tolist() == curve.control_steps.tolist()


def test_the_monitors_of_a_training(run_folder, tmp_path):
    files = sorted(run_folder.glob("*.monitor.csv"))
    assert len(files) == 2
    for file in files:
        shutil.copy(file, tmp_path)
    curve = read_curve(tmp_path)
    # One movement is an episode of one step: 256 movements make 2 points.
    assert curve.control_steps.tolist() == [100, 200]
    results = pytest.importorskip("stable_baselines3.common.monitor")
    pytest.importorskip("pandas")
    theirs = results.load_results(str(tmp_path))
    assert curve.success[0] == pytest.approx(theirs["is_success"][:100].mean())


def test_episodes_of_several_monitors_are_in_the_order_of_time(tmp_path):
    # The second environment begins 100 s later: all of its episodes come after the first's.
    late = monitor(tmp_path / "0.monitor.csv", [True] * 100, start=200.0, length=30)
    early = monitor(tmp_path / "1.monitor.csv", ["False", "1.0"] * 50)
    for files in ((late, early), (early, late)):
        curve = read_monitor(*files, steps_per_action=2)
        assert curve.control_steps.tolist() == [2_000, 8_000]
        assert curve.success.tolist() == [0.5, 1]


def test_the_rest_of_less_than_100_episodes_is_left_out(tmp_path):
    curve = read_curve(monitor(tmp_path / "monitor.csv", [True] * 199))
    assert curve.control_steps.tolist() == [1_000]


HEAD = HEADER + "r,l,t,is_success\n"


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("", "line 1: '' is not the first line of a monitor.csv"),
        ("r,l,t\n1,2,3\n", "line 1: 'r,l,t' is not the first line"),
        ('#{"env_id": "x"}\n', "line 1: "),
        (HEADER + "r,l,t\n1,2,3\n", "line 2: has no column is_success, only r, l, t; ask Monitor"),
        (HEADER, "line 2: has no column t"),
        (HEAD + "1,2,3,True\n1,2.5,3,True\n", "line 4: l = '2.5' is not a whole number"),
        (HEAD + "1,0,3,True\n", "line 3: l = '0' is not a whole number of steps, 1 or more"),
        (HEAD + "1,2,soon,True\n", "line 3: t = 'soon' is not a finite number"),
        (HEAD + "1,2,inf,True\n", "line 3: t = 'inf' is not a finite number"),
        (HEAD + "1,2,3,maybe\n", "line 3: is_success = 'maybe' is neither True nor False"),
        (HEAD + "1,2,3\n", "line 3: is_success = None"),
        (HEAD + "1,2,3,True,1,2,3,True\n", "line 3: has 8 values for 4 columns"),
        (HEAD + "1,2,3,True\n", "1 episodes, a curve needs 100 or more"),
        (HEAD, "0 episodes"),
    ],
)
def test_a_bad_monitor_is_named_with_line_and_field(tmp_path, text, named):
    file = tmp_path / "0.monitor.csv"
    file.write_text(text)
    with pytest.raises(StudyError) as error:
        read_curve(file)
    assert str(error.value).startswith(str(file))
    assert named in str(error.value)


def test_bytes_that_are_no_text_are_named(tmp_path):
    (tmp_path / "monitor.csv").write_bytes(HEAD.encode() + b"1,2,3,\xff\n")
    with pytest.raises(StudyError, match=r"monitor\.csv, line 3: is_success"):
        read_curve(tmp_path)


STEPS, SUCCESSES = np.array([10, 20]), np.array([[True, False], [True, True]])


@pytest.mark.parametrize(
    ("fields", "named"),
    [
        ({"timesteps": STEPS}, "has no field successes; EvalCallback writes it if info has"),
        ({"successes": SUCCESSES}, "has no field timesteps"),
        ({"timesteps": STEPS, "successes": SUCCESSES[0]}, "successes has shape (2,)"),
        ({"timesteps": STEPS[:1], "successes": SUCCESSES}, "control_steps has shape (1,)"),
        ({"timesteps": STEPS[::-1], "successes": SUCCESSES}, "control_steps[1] = 10"),
        ({"timesteps": STEPS, "successes": SUCCESSES * 0.5}, "successes has values other than"),
        ({"timesteps": STEPS, "successes": SUCCESSES.astype(object)}, "not an evaluations.npz"),
        ({"timesteps": np.array(["a", "b"]), "successes": SUCCESSES}, "timesteps has shape (2,)"),
        ({"timesteps": STEPS, "successes": np.zeros((2, 0))}, "successes has shape (2, 0)"),
    ],
)
def test_bad_evaluations_are_named_with_the_field(tmp_path, fields, named):
    file = evaluations(tmp_path / "evaluations.npz", **fields)
    with pytest.raises(StudyError) as error:
        read_curve(file)
    assert str(error.value).startswith(str(file))
    assert named in str(error.value)


@pytest.mark.parametrize("damage", ["no zip", "empty", "cut", "a bit"])
def test_damaged_evaluations_are_refused(tmp_path, damage):
    file = evaluations(tmp_path / "evaluations.npz", timesteps=STEPS, successes=SUCCESSES)
    whole = file.read_bytes()
    at = whole.index(b"NUMPY") + 130  # In the numbers of the first array.
    flipped = whole[:at] + bytes([whole[at] ^ 1]) + whole[at + 1 :]
    file.write_bytes(
        {"no zip": HEAD.encode(), "empty": b"", "cut": whole[:-40]}.get(damage, flipped)
    )
    with pytest.raises(StudyError, match=r"not an evaluations\.npz"):
        read_curve(tmp_path)


def test_paths_without_a_log_are_named(tmp_path):
    with pytest.raises(StudyError, match=r"has neither evaluations\.npz nor \*monitor.csv"):
        read_curve(tmp_path)
    (tmp_path / "log.txt").touch()
    with pytest.raises(StudyError, match=r"log\.txt: is neither"):
        read_curve(tmp_path / "log.txt")
    with pytest.raises(FileNotFoundError):
        read_curve(tmp_path / "evaluations.npz")
    with pytest.raises(ConfigError, match="paths is empty"):
        read_monitor()
    with pytest.raises(ConfigError, match="steps_per_action = 0"):
        read_curve(monitor(tmp_path / "monitor.csv", [1]), steps_per_action=0)
    with pytest.raises(ConfigError, match="path = 3 is not a path"):
        read_curve(3)
