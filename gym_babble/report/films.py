"""The section of a report with a movement or a grasp, frame by frame."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

from gym_babble.agents.loading import acting_agent
from gym_babble.report.html import figure_html, png_source
from gym_babble.study.comparison import TrainedResult
from gym_babble.viz.episode import play
from gym_babble.viz.video import contact_sheet, png

if TYPE_CHECKING:
    from collections.abc import Callable

    from gym_babble.study.comparison import Comparison
    from gym_babble.study.scenarios import GraspScenario, Scenario
    from gym_babble.viz.episode import Episode

__all__ = ["grasp_section", "movement_section"]


def _filmed(
    comparison: Comparison, worth: Callable[[Any], float], why: str
) -> tuple[str, Episode, bytes] | None:
    """The first trained agent's success that shows most.

    Args:
        comparison: The comparison.
        worth: Rates how much a case shows.
        why: Says in words which case has the highest worth.

    Returns:
        A paragraph on what is shown and how it was chosen, the episode, and the eye's view before;
        None without trained agents.
    """
    played = [result for result in comparison.results if isinstance(result, TrainedResult)]
    if not played:
        return None
    result = played[0]
    trained = result.trained[0]
    test = result.tests[0]
    outcomes = zip(test.cases, test.outcomes, strict=True)
    solved = [case for case, outcome in outcomes if outcome == "success"]
    case: Any = max(solved or test.cases, key=worth)
    loaded = acting_agent(trained.agent, trained.env_id, comparison.settings.config)
    episode = play(loaded, case)
    eye = episode.env.picture("eye", (630, 630), 0)
    tests = f"{len(test.cases):,} tests"
    among = f"{len(solved):,} successes in {tests}" if solved else f"{tests} without a success"
    title, outcome = escape(result.contender.title), episode.outcome.replace("_", " ")
    said = (
        f"<p>{title}, seed 0, on case {case['index']}: {outcome}. Chosen from {among}: {why}.</p>\n"
    )
    return said, episode, png(eye)


def movement_section(comparison: Comparison) -> str:
    """A movement of reaching."""
    filmed = _filmed(comparison, _visibility, "a long way in the middle of the picture")
    if filmed is None:
        return ""
    said, episode, eye = filmed
    near = [
        picture[60:400, 80:420] for picture in episode.pictures(600)
    ]  # The arm stays in the middle.
    return (
        f"<h2>A movement</h2>\n{said}"
        '<div class="photos">'
        + figure_html(
            png_source(eye),
            "The eye's view before the movement: 630 × 630 pixels, 120°, on the target.",
        )
        + figure_html(png_source(png(contact_sheet(near))), "The movement, row by row.")
        + "</div>\n"
    )


def _visibility(case: Scenario) -> float:
    """How much a case of reaching shows: best is a long path near the picture's middle."""
    start, target = np.array(case["start"]), np.array(case["target"])
    middle = 0.5 * (start + target)
    return float(np.linalg.norm(target - start) - np.linalg.norm(middle - (0.0, 0.3)))


def grasp_section(comparison: Comparison) -> str:
    """A grasp."""
    filmed = _filmed(comparison, _size, "the first of the biggest objects")
    if filmed is None:
        return ""
    said, episode, eye = filmed
    return (
        f"<h2>A grasp</h2>\n{said}"
        '<div class="photos">'
        + figure_html(
            png_source(eye),
            "The eye's view before the grasp: 630 × 630 pixels, 120°, on the object.",
        )
        + figure_html(
            png_source(png(contact_sheet(episode.pictures(600)))), "The grasp, row by row."
        )
        + "</div>\n"
    )


def _size(case: GraspScenario) -> float:
    """How much a case of grasping shows: best is a big object."""
    return case["diameter"]
