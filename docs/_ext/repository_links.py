"""Links that lead out of the docs: to files of the repository, to the lab, to cargo's docs.

GitHub shows a link to `../examples/film.py` as the file. On the site it leads to the file in the
repository. The lab and cargo's docs are beside the pages, where Sphinx knows nothing of them.
"""

from __future__ import annotations

import posixpath
import re
from typing import TYPE_CHECKING, Any

from docutils import nodes
from sphinx import addnodes
from sphinx.transforms import SphinxTransform
from sphinx.util import logging

if TYPE_CHECKING:
    from sphinx.application import Sphinx

BESIDE = ("docs/lab/", "docs/rust/")
"""Folders of the site that others than Sphinx make."""
LESSON = re.compile(r"docs/lessons/\d")
"""The source of a lesson."""
NO_PAGES = ("docs/experiments/", "docs/lessons/", "docs/studies/")
"""Folders of docs that are no pages."""
logger = logging.getLogger(__name__)


class RepositoryLinks(SphinxTransform):
    """Gives such links their address."""

    default_priority = 5

    def apply(self, **_: Any) -> None:
        """Replaces the links of a page."""
        for kind in (addnodes.download_reference, addnodes.pending_xref):
            for link in list(self.document.findall(kind)):
                if link.get("reftype") == "myst":
                    self._lead(link)

    def _lead(self, link: nodes.Element) -> None:
        """Replaces a link that leads out of the pages."""
        path, _, anchor = link["reftarget"].partition("#")
        if link.get("refdomain") == "doc":  # Markdown, named from the folder of the pages.
            inside = posixpath.join("docs", f"{path}.md")
            anchor = link["reftargetid"] or ""
            if path.startswith("/"):
                inside = posixpath.relpath(f"{path}.md", self.env.srcdir.parent)
        else:
            folder = posixpath.dirname(self.env.docname)
            inside = posixpath.normpath(posixpath.join("docs", folder, path))
        if inside.startswith(BESIDE):
            self._replace(link, link["reftarget"])
        elif LESSON.match(inside):
            # GitHub shows the source of a lesson, the site the notebook that was executed.
            link["reftarget"] = path.removesuffix(".md").replace("lessons/", "course/", 1)
        elif not inside.startswith("docs/") or inside.startswith(NO_PAGES):
            there = self.env.srcdir.parent / inside
            if not there.exists():
                logger.warning("no file %s in the repository", inside, location=link)
            mark = "#" if anchor else ""
            kind = "tree" if there.is_dir() else "blob"
            self._replace(link, f"{self.config.repository}/{kind}/main/{inside}{mark}{anchor}")

    @staticmethod
    def _replace(link: nodes.Element, address: str) -> None:
        link.replace_self(nodes.reference("", "", *link.children, refuri=address))


def setup(app: Sphinx) -> dict[str, Any]:
    """Called by Sphinx."""
    app.add_config_value("repository", "", "env", str)
    app.add_transform(RepositoryLinks)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
