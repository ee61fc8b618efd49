"""The exercises of the lessons: `check` judges an answer, and `hand_in` writes a file.

>>> from gym_babble import course
>>> course.check("2.1", 0.8).right
True
"""

from gym_babble.course.checks import check
from gym_babble.course.handing_in import hand_in
from gym_babble.course.results import HandedIn, Result

__all__ = ["HandedIn", "Result", "check", "hand_in"]
