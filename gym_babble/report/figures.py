"""The sections of a report with the paper's figures and the learning curves."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING

from gym_babble.agents import HebbBabbling
from gym_babble.paper import fig2, fig4, fig5, fig7, fig8, sight
from gym_babble.report.html import figure_html, svg_source
from gym_babble.study.comparison import TrainedResult
from gym_babble.study.rates import share
from gym_babble.study.scenarios import scenarios
from gym_babble.viz.curves import learning_curves

if TYPE_CHECKING:
    from collections.abc import Callable

    from gym_babble.study.comparison import Comparison

__all__ = [
    "curves_section",
    "generators_section",
    "hands_section",
    "sight_section",
    "trajectories_section",
    "weights_section",
]

FIG7_EVERY = 4
"""Every fourth test of Fig. 7 is played."""


def curves_section(comparison: Comparison) -> str:
    """The learning curves."""
    if not any(trained.curve for result in comparison.results for trained in result.trained):
        return ""
    dotted = " The dotted line is the paper's .67 on its tests." if comparison.task.paper else ""
    return "<h2>Learning curves</h2>\n" + figure_html(
        svg_source(learning_curves(comparison)),
        f"Success on 200 validation cases, which are not test cases.{dotted} A curve starts at its "
        "first measured point.",
    )


def trajectories_section(key: str) -> Callable[[Comparison], str]:
    """The section with a contender's trajectories."""
    return lambda comparison: _trajectories(comparison, key)


def _trajectories(comparison: Comparison, key: str) -> str:
    result = comparison.result(key)
    if not isinstance(result, TrainedResult):
        return ""
    config, agent = comparison.settings.config, result.trained[0].agent
    cases = scenarios("fig4", config=config)
    halfway = fig4.trajectories(agent, cases, config)
    exchanged = fig4.trajectories(agent, [fig4.switched(case) for case in cases], config)
    return f"<h2>Trajectories of {escape(result.contender.title)} (Fig. 4)</h2>\n" + figure_html(
        svg_source(fig4.draw(halfway, exchanged)),
        "Four targets (circles) and 36 starts around each (dots), obstacles not drawn. Bold: "
        "success; dotted: failure, up to a red cross. Blue curves left, orange right. On the "
        "right, obstacle and start are exchanged: the obstacle stands behind the hand, and a "
        "straight movement reaches the target too.",
    )


def weights_section(comparison: Comparison) -> str:
    """The weights of the paper's agent of reaching."""
    result = comparison.result("hebb-paper")
    agent = result.trained[0].agent if isinstance(result, TrainedResult) else None
    if not isinstance(agent, HebbBabbling):
        return ""
    sets = fig5.weight_sets(agent)
    return "<h2>Weights (Fig. 5)</h2>\n" + figure_html(
        svg_source(fig5.draw(sets)),
        "Weights from input neurons to the output map. The neurons form two compact sets: with one "
        "the movement curves left, with the other right. Of each, the neuron most like its set's "
        "mean, and the mean. The mean of one set correlates "
        f"{share(sets.mirror_correlation)} with the mirrored mean of the other.",
    )


def generators_section(_: Comparison) -> str:
    """Paths of the pattern generators."""
    return "<h2>Pattern generators (Fig. 2)</h2>\n" + figure_html(
        svg_source(fig2.draw()),
        "Left: the path of a movement for several b1, with b2 = 1 − b1. Right: the same from hand "
        "to target. With b1 above ½ the path curves left.",
    )


def hands_section(comparison: Comparison) -> str:
    """Trajectories, activation and weights of seed 0's Hebb agent of grasping."""
    result = comparison.result("hebb-paper")
    agent = result.trained[0].agent if isinstance(result, TrainedResult) else None
    if not isinstance(agent, HebbBabbling):
        return ""
    config = comparison.settings.config
    cases = scenarios("fig7", config=config)[::FIG7_EVERY]
    return (
        "<h2>Trajectories of the hand (Fig. 7)</h2>\n"
        + figure_html(
            svg_source(fig7.draw(fig7.trajectories(agent, cases))),
            "Final portions of the palm's trajectories to 12 places of each object, all around the "
            "arm, in a quarter of the figure's tests. Thin: touched; bold: grasped; dotted grey: "
            "missed. Circles are the objects, to scale.",
        )
        + "<h2>Activation and weights (Fig. 8)</h2>\n"
        + figure_html(
            svg_source(fig8.draw(agent)),
            "Top: the arm's map when the eye looks at an object, and the weights from one neuron "
            "of the eye's map. Bottom: weights from the fovea to the neurons of the hands for the "
            "small and the big object.",
        )
    )


def sight_section(comparison: Comparison) -> str:
    """What the eye sees of the objects."""
    return "<h2>What the eye sees</h2>\n" + figure_html(
        svg_source(sight.draw(sight.eye_views(comparison.settings.config))),
        "Objects of each size: the eye's view, the fovea in its middle, and the edges in the "
        "fovea, from which the hand learns the size.",
    )
