"""Exercises of lesson 3: eye, foveation and population codes."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from gym_babble.brain import PopulationMap
from gym_babble.config import Config
from gym_babble.course.answers import Function, Number
from gym_babble.course.exercise import Exercise, Finding, right, wrong
from gym_babble.course.mistakes import usual_mistake
from gym_babble.envs import BabbleReachEnv

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

__all__ = ["EXERCISES"]

FAINT, STRONG = "#9aa5b1", "#1f6fb2"
SHIFTS = ((0, 0), (10, 0), (0, -20), (-25, 13))
"""How far the images are shifted to the right and down [pixel]."""


@cache
def _images() -> tuple[NDArray[np.uint8], ...]:
    """What the eye sees of a case, shifted: else the target would always be in the middle."""
    env = BabbleReachEnv(obs="retina", retina_size=168)
    observation, _ = env.reset(seed=0)
    retina = observation["retina"]
    return tuple(np.roll(retina, (down, along), axis=(0, 1)) for along, down in SHIFTS)


def _is_red(image: NDArray[np.uint8]) -> NDArray[np.bool_]:
    r, g, b = np.moveaxis(image.astype(float), -1, 0)
    red: NDArray[np.bool_] = (r > 2 * g) & (r > 2 * b)
    return red


def _judge_centroid(centroids: NDArray[np.float64]) -> Finding:
    found = [np.nonzero(_is_red(image)) for image in _images()]
    rows = np.array([row.mean() for row, _ in found])
    columns = np.array([column.mean() for _, column in found])
    if np.allclose(centroids, np.transpose([columns, rows]), atol=0.01):
        return right("You found the target in all four images.")
    middle = (len(_images()[0]) - 1) / 2
    mistakes = (
        (
            np.transpose([rows, columns]),
            "Row and column are exchanged.",
            "`np.nonzero` gives rows first. Return the column, then the row.",
        ),
        (
            np.full((4, 2), middle),
            "This is the middle of the image.",
            "The centroid is the mean place of the red pixels alone.",
        ),
        (
            np.transpose([columns, rows]) - middle,
            "You subtracted the middle already.",
            "Return the place in the image, counted from its upper left pixel.",
        ),
    )
    return usual_mistake(centroids, mistakes, within=0.6) or wrong(
        f"In the first image you find {centroids[0].round(1).tolist()}.",
        "A pixel is red if its red value is more than twice its green and more than twice its "
        "blue value. The values are uint8: convert them to float before you double them.",
    )


def _draw_centroid(centroids: NDArray[np.float64], axes: Axes) -> None:
    axes.imshow(np.hstack(_images()), aspect="equal")
    size = len(_images()[0])
    columns = np.clip(centroids[:, 0], 0, size - 1) + size * np.arange(len(centroids))
    axes.plot(columns, np.clip(centroids[:, 1], 0, size - 1), "c+", markersize=14)
    axes.axis("off")


EYE = Config().body.eye
FOCAL_PX = EYE.pixels / 2 / np.tan(np.radians(EYE.field_deg / 2))
"""Distance of the image plane [pixel]."""
PER_PIXEL_DEG = EYE.field_deg / EYE.pixels
FROM_DEG, TO_DEG = 20.0, 0.1


def _steps() -> list[float]:
    """The error after each step of the reflex [deg], until it is small."""
    errors = [FROM_DEG]
    while errors[-1] >= TO_DEG:
        pixels = FOCAL_PX * np.tan(np.radians(errors[-1]))
        errors.append(float(errors[-1] - PER_PIXEL_DEG * pixels))
    return errors


def _judge_steps(steps: float) -> Finding:
    needed = len(_steps()) - 1
    if steps == needed:
        return right(f"The error is {', '.join(f'{error:.2f}' for error in _steps())}°.")
    if steps == 1:
        return wrong(
            "One step would do if each pixel spanned the same angle.",
            "A pixel in the middle of a flat image spans 0.315°, and Eq. 1 assumes 120°/630.",
        )
    if abs(steps - needed) == 1:
        return wrong("Off by one.", "Count the steps after which the error is below 0.1°.")
    return wrong(
        f"{steps:g} steps are not what Eq. 1 needs.",
        "In each step: the angle gives pixels by f · tan, and Eq. 1 turns 120°/630 for each.",
    )


def _draw_steps(steps: float, axes: Axes) -> None:
    errors = _steps()
    axes.semilogy(errors, ".-", color=FAINT, label="error")
    axes.axhline(TO_DEG, color="k", lw=0.5)
    axes.axvline(np.clip(steps, 0, 2 * len(errors)), color=STRONG, label="yours")
    axes.set(xlabel="steps of the reflex", ylabel="error [°]")
    axes.legend()


TARGETS = ((0.0, 0.1), (0.2, 0.2), (-0.25, 0.15), (0.1, 0.35), (-0.1, -0.2))
"""Targets (x, y) [m]."""


def _gaze(targets: NDArray[np.float64], *, fick: bool = False) -> NDArray[np.float64]:
    """Pan and tilt (n, 2) [deg] of an eye that looks at targets."""
    x, y = np.transpose(targets - np.array(EYE.position_m)[:2])
    z = -EYE.position_m[2]
    if fick:
        return np.degrees([np.arctan2(x, y), np.arctan2(z, np.hypot(x, y))]).T
    return np.degrees([np.arctan2(x, np.hypot(y, z)), np.arctan2(y, -z)]).T


def _judge_gaze(gazes: NDArray[np.float64]) -> Finding:
    targets = np.array(TARGETS)
    there = _gaze(targets)
    if np.allclose(gazes, there, atol=0.3):
        return right("Your gaze is that of the environment's eye, for five targets.")
    eye = np.array(EYE.position_m)
    offset = targets - eye[:2]
    mistakes = (
        (np.radians(there), "This is in radians.", "Return degrees."),
        (there[:, ::-1], "Pan and tilt are exchanged.", "Pan turns to the right, tilt forward."),
        (there * [1, -1], "Tilt has the wrong sign.", "It is positive for targets ahead."),
        (
            _gaze(targets, fick=True),
            "This is the frame of Fick.",
            "Here the eye tilts first, and pan counts from the plane that it has tilted to.",
        ),
        (
            _gaze(targets + eye[:2]),
            "Your eye sits above the shoulder.",
            "It is at (0, 10, 25) cm: subtract its place from the target.",
        ),
        (
            np.degrees(np.arctan2(offset, eye[2])),
            "Tilt is right, pan is not.",
            "Once the eye has tilted, the target is √(y² + z²) ahead, not z.",
        ),
    )
    return usual_mistake(gazes, mistakes, within=0.3) or wrong(
        f"For a target at {TARGETS[1]} m you return {gazes[1].round(1).tolist()}°.",
        "Subtract the eye's place first. tan(tilt) = y/h, tan(pan) = x/√(y² + h²), with the "
        "height h.",
    )


def _draw_gaze(gazes: NDArray[np.float64], axes: Axes) -> None:
    axes.plot(*_gaze(np.array(TARGETS)).T, "o", color=FAINT, ms=10, label="the environment's eye")
    axes.plot(*np.clip(gazes, -180, 180).T, "x", color=STRONG, label="yours")
    axes.set(xlabel="pan [°]", ylabel="tilt [°]")
    axes.legend()


PREFERRED = np.arange(-3.0, 4.0)
CODES = ((0.0, 1.0), (0.4, 1.0), (-2.0, 0.5), (2.7, 2.0), (1.0, 0.7))
"""Values and widths sigma, in spacings of neurons."""


def _activities() -> NDArray[np.float64]:
    values, sigmas = np.transpose(CODES)[..., None]
    activities: NDArray[np.float64] = np.exp(-((PREFERRED - values) ** 2) / (2 * sigmas**2))
    return activities


def _judge_encode(activities: NDArray[np.float64]) -> Finding:
    values, sigmas = np.transpose(CODES)[..., None]
    away, there = np.abs(PREFERRED - values), _activities()
    if np.allclose(activities, there, atol=1e-4):
        return right("These are the activities of Eq. 3.")
    mistakes = (
        (
            np.exp(-away / (2 * sigmas**2)),
            "The distance is not squared.",
            "Equation 3 as printed has no square, and the package squares it. So do we.",
        ),
        (np.exp(-(away**2) / sigmas**2), "A factor 2 is missing.", "Divide by 2σ²."),
        (np.exp(-(away**2) / (2 * sigmas)), "σ is not squared.", "Divide by 2σ²."),
        (
            np.exp(-(away**2) / 2 * sigmas**2),
            "You multiply by σ².",
            "Python computes from left to right: put 2 * sigma**2 into brackets.",
        ),
        (
            there / there.sum(axis=1, keepdims=True),
            "Your activities sum to one.",
            "Eq. 3 has no such norm: the most active neuron is near 1.",
        ),
    )
    return usual_mistake(activities, mistakes, within=1e-4) or wrong(
        f"For x = {CODES[1][0]} and σ = {CODES[1][1]} your middle neuron has "
        f"{activities[1, 3]:.3g}.",
        f"It should have exp(−0.4²/2) = {there[1, 3]:.3f}.",
    )


def _draw_encode(activities: NDArray[np.float64], axes: Axes) -> None:
    for k in (1, 3):
        axes.plot(PREFERRED, _activities()[k], "o", color=FAINT, ms=9)
        axes.plot(PREFERRED, np.clip(activities[k], -1, 3), "x-", label=f"x, σ = {CODES[k]}")
    axes.set(xlabel="preferred value", ylabel="activity", title="grey: Eq. 3")
    axes.legend()


def _patterns() -> list[tuple[NDArray[np.float64], NDArray[np.float64]]]:
    """Activities, and the neurons' preferred values."""
    two = np.array([0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0])
    return [(a.copy(), PREFERRED.copy()) for a in (*_activities(), two)]


def _judge_decode(values: NDArray[np.float64]) -> Finding:
    there = np.array([a @ x / a.sum() for a, x in _patterns()])
    if np.allclose(values, there, atol=1e-4):
        return right("Your read-out is Eq. 4. For two equal peaks it lies between them.")
    mistakes = (
        (
            np.array([x[a.argmax()] for a, x in _patterns()]),
            "This is the value of the strongest neuron.",
            "Eq. 4 takes all neurons, each with its activity as a weight.",
        ),
        (
            np.array([a @ x for a, x in _patterns()]),
            "You do not divide.",
            "A weighted mean divides by the sum of its weights.",
        ),
        (
            np.array([(a @ x) / len(a) for a, x in _patterns()]),
            "You divide by the number of neurons.",
            "Divide by the sum of the activities.",
        ),
    )
    return usual_mistake(values, mistakes, within=1e-4) or wrong(
        f"For the second pattern you read {values[1]:.3g}.", f"Eq. 4 reads {there[1]:.3f}."
    )


NOISE = 0.02
SIGMAS = (0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.2, 1.4, 1.7, 2.0, 2.5, 3.0)


def _error_deg(sigma: float) -> float:
    """Root of the mean squared error of the peak's read-out of noisy activities."""
    rng = np.random.default_rng(5)
    code = PopulationMap(21, low=[-60, -60], high=[60, 60], sigma=sigma)
    values = rng.uniform(-48, 48, (300, 2))
    activities = code.encode(values)
    noisy = np.clip(activities + NOISE * rng.standard_normal(activities.shape), 0, None)
    return float(np.sqrt(np.mean((code.read_out_peak(noisy) - values) ** 2)))


@cache
def _errors() -> NDArray[np.float64]:
    return np.array([_error_deg(sigma) for sigma in SIGMAS])


def _judge_sigma(sigma: float) -> Finding:
    error, least = _error_deg(sigma), _errors().min()
    said = f"With σ = {sigma:.3g} the error is {error:.2f}°"
    if error <= 1.5 * least:
        return right(f"{said}, and none of those in the picture has less than {least:.2f}°.")
    if sigma < 0.7:
        return wrong(
            f"{said}: between two neurons hardly any neuron is active.", "Try wider tuning curves."
        )
    return wrong(
        f"{said}: the five neurons around the peak are almost equally active.",
        "Try narrower tuning curves.",
    )


def _draw_sigma(sigma: float, axes: Axes) -> None:
    axes.semilogy(SIGMAS, _errors(), color=FAINT, label="all σ")
    axes.plot([sigma], [_error_deg(sigma)], "o", color=STRONG, label="yours")
    axes.set(xlabel="σ [spacings of neurons]", ylabel="error [°]", title=f"noise {NOISE}")
    axes.legend()


EXERCISES = (
    Exercise(
        id="3.1",
        asks="a function of an image that returns (column, row) of the red pixels' centroid",
        answer=Function(inputs=lambda: [(image,) for image in _images()], shape=(2,)),
        judge=_judge_centroid,
        draw=_draw_centroid,
    ),
    Exercise(
        id="3.2",
        asks="the steps of Eq. 1 after which an error of 20° is below 0.1°",
        answer=Number(),
        judge=_judge_steps,
        draw=_draw_steps,
    ),
    Exercise(
        id="3.3",
        asks="a function of a target's x and y [m] that returns pan and tilt [°]",
        answer=Function(inputs=lambda: list(TARGETS), shape=(2,)),
        judge=_judge_gaze,
        draw=_draw_gaze,
    ),
    Exercise(
        id="3.4",
        asks="a function of x, sigma and preferred values that returns the activities of Eq. 3",
        answer=Function(
            inputs=lambda: [(*code, PREFERRED.copy()) for code in CODES], shape=(len(PREFERRED),)
        ),
        judge=_judge_encode,
        draw=_draw_encode,
    ),
    Exercise(
        id="3.5",
        asks="a function of activities and preferred values that returns the read-out of Eq. 4",
        answer=Function(inputs=_patterns),
        judge=_judge_decode,
    ),
    Exercise(
        id="3.6",
        asks="the σ with the smallest error [spacings of neurons]",
        answer=Number(low=0.05, high=10),
        judge=_judge_sigma,
        draw=_draw_sigma,
    ),
)
