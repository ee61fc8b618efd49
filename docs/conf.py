"""Sphinx's settings for the site; `make docs` builds it into build/site."""

from __future__ import annotations

import sys
from importlib import metadata
from pathlib import Path

DOCS = Path(__file__).resolve().parent
sys.path.insert(0, str(DOCS / "_ext"))

import environment_pages  # noqa: E402 - found by the line above
import lesson_pages  # noqa: E402
import module_pages  # noqa: E402

PACKAGE = metadata.metadata("gym-babble")

project = "gym-babble"
author = "The gym-babble contributors"
copyright = author  # noqa: A001 - Sphinx's name
release = version = PACKAGE["Version"]
repository = dict(url.split(", ") for url in PACKAGE.get_all("Project-URL", ()))["Repository"]

extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_copybutton",
    "docstrings",
    "mathml",
    "repository_links",
]
exclude_patterns = ["_ext", "experiments", "lessons", "studies"]
nitpicky = True
nitpick_ignore_regex = [
    # Classes of other packages: their inventories are on the network, which a build does not need.
    (r"py:.*", r"(?!gym_babble\.).*"),
    # A variable of types.
    (r"py:.*", r"gym_babble\.rllib\.C"),
]

# Pages made from the package and the workspace, which git does not keep.
environment_pages.write(DOCS / "envs")
module_pages.write(DOCS / "api")
lesson_pages.write(DOCS / "course")

# Markdown: what GitHub shows too, but for the fenced containers of the first page.
myst_enable_extensions = ["colon_fence", "dollarmath"]
myst_heading_anchors = 6
nb_execution_mode = "off"  # `make lessons` has executed them.
nb_merge_streams = True

# Docstrings name code between single backticks.
default_role = "code"
add_module_names = False
python_use_unqualified_type_names = True
autodoc_member_order = "bysource"
autodoc_typehints_format = "short"
autodoc_type_aliases = {
    "ConfigLike": "gym_babble.config.ConfigLike",
    "EnvLike": "gym_babble.agents.base.EnvLike",
    "Observation": "gym_babble.agents.base.Observation",
    "RuleLike": "gym_babble.brain.RuleLike",
}
nitpick_ignore = [("py:class", path) for path in autodoc_type_aliases.values()]  # For Sphinx 8.
autodoc_mock_imports = ["ray"]  # In the extra `rllib` alone, which pins its own Gymnasium.
napoleon_numpy_docstring = False
copybutton_exclude = ".linenos, .gp, .go"

html_theme = "pydata_sphinx_theme"
html_title = "gym-babble"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_favicon = "../lab/public/icon.svg"
templates_path = ["_templates"]
html_copy_source = False
html_show_sphinx = False
html_theme_options = {
    "logo": {"text": "gym-babble"},
    "github_url": repository,
    "header_links_before_dropdown": 8,
    "navbar_align": "left",
    "navbar_end": ["lab-link", "theme-switcher", "navbar-icon-links"],
    "secondary_sidebar_items": ["page-toc"],
    "show_toc_level": 2,
    "collapse_navigation": True,
    "navigation_with_keys": False,
    "footer_start": ["copyright"],
    "footer_end": [],
}
html_sidebars: dict[str, list[str]] = {"index": [], "start": []}

# Links into the repository: the build has looked for the files.
linkcheck_ignore = [f"{repository}/(blob|tree)/.*"]
linkcheck_timeout = 20
linkcheck_retries = 2
linkcheck_anchors_ignore_for_url = [r"https://github\.com/.*"]
