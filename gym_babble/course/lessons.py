"""The exercises of all lessons by their ids."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from gym_babble.checks import check_choice, shown
from gym_babble.course import (
    lesson1,
    lesson2,
    lesson3,
    lesson4,
    lesson5,
    lesson6,
    lesson7,
    lesson8,
)
from gym_babble.errors import ConfigError

if TYPE_CHECKING:
    from gym_babble.course.exercise import Exercise

__all__ = ["EXERCISES", "LESSONS", "exercise_named", "exercises_of"]

LESSONS: dict[str, tuple[Exercise, ...]] = {
    str(number): lesson.EXERCISES
    for number, lesson in enumerate(
        (lesson1, lesson2, lesson3, lesson4, lesson5, lesson6, lesson7, lesson8), start=1
    )
}
"""The exercises of each lesson by its number as a text."""

EXERCISES = {exercise.id: exercise for lesson in LESSONS.values() for exercise in lesson}
"""All exercises by their ids."""


def exercise_named(exercise: Any) -> Exercise:
    """The exercise of an id such as "2.1".

    Raises:
        ConfigError: There is none.
    """
    if isinstance(exercise, float):
        raise ConfigError(f'exercise = {exercise} is not a text: write check("{exercise}", ...)')
    if not isinstance(exercise, str) or exercise not in EXERCISES:
        raise ConfigError(f"exercise = {shown(exercise)} is not one of {', '.join(EXERCISES)}")
    return EXERCISES[exercise]


def exercises_of(lesson: Any) -> tuple[Exercise, ...]:
    """The exercises of a lesson's number, as a text or a whole number.

    Raises:
        ConfigError: There is no such lesson.
    """
    number = str(lesson) if isinstance(lesson, int) else lesson
    return LESSONS[check_choice("lesson", number, LESSONS)]
