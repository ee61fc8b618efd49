"""How to cite the paper and this software."""

from __future__ import annotations

from gym_babble._core import __version__

__all__ = ["bibtex"]

BIBTEX = """\
@misc{caligiore2008,
  author  = {Caligiore, Daniele and Ferrauto, Tomassino and Parisi, Domenico and Accornero, Neri and
             Capozza, Marco and Baldassarre, Gianluca},
  title   = {Using motor babbling and {Hebb} rules for modeling the development of reaching with
             obstacles and grasping},
  year    = {2008}
}

@software{gymbabble,
  author  = {{The gym-babble contributors}},
  title   = {gym-babble: Gymnasium environments and agents for reaching and grasping learned by
             motor babbling},
  version = {VERSION},
  year    = {2026},
  url     = {https://github.com/gym-babble/gym-babble}
}
"""


def bibtex() -> str:
    """BibTeX of the paper and of this version of the software, as in README."""
    return BIBTEX.replace("VERSION", __version__)
