"""Checks a built site: every expected page is there, and every link inside leads somewhere.

`python docs/_ext/check_site.py build/site`. It needs no network: addresses of other hosts are
those of `make docs-links`. No page may load anything from another host.
"""

from __future__ import annotations

import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

import environment_pages
import lesson_pages
import module_pages

DOCS = Path(__file__).resolve().parents[1]
OTHERS = ("lab", "rust")
"""Folders whose pages others make, and check."""
LOADED = {("script", "src"), ("img", "src"), ("iframe", "src"), ("source", "src"), ("link", "href")}
"""What a browser loads without a click."""
NOT_LOADED = ("canonical", "next", "prev", "index", "search", "author", "copyright")


class Page(HTMLParser):
    """The addresses and the anchors of a page."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.links: list[tuple[str, str, str]] = []
        """Element, attribute, address."""
        self.anchors: set[str] = set()
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Called by the parser."""
        found = {name: value or "" for name, value in attrs}
        self.anchors.update(found[name] for name in ("id", "name") if name in found)
        if tag != "link" or found.get("rel", "") not in NOT_LOADED:
            self.links += [(tag, name, found[name]) for name in ("href", "src") if name in found]


def expected() -> dict[str, list[str]]:
    """The pages that the site must have, by kind."""
    tops = [path.stem for path in DOCS.glob("*.md")]
    return {
        "page": [f"{name}.html" for name in sorted(tops)],
        "environment": [f"envs/{row.id}.html" for row in environment_pages.DOCUMENTED],
        "how-to": sorted(f"how-to/{path.stem}.html" for path in DOCS.glob("how-to/*.md")),
        "lesson": [f"course/{name}.html" for name in lesson_pages.sources()],
        "module": [f"api/{name}.html" for name in module_pages.PAGES],
        "crate": [f"rust/{name}/index.html" for name in module_pages.crates()],
        "lab": ["lab/index.html"],
    }


def missing_names(site: Path) -> list[str]:
    """Public names of the package that no page of the API has."""
    faults = []
    for name, modules in module_pages.PAGES.items():
        path = site / "api" / f"{name}.html"
        if not path.is_file():
            continue
        anchors = Page(path).anchors
        for module in modules:
            full = f"gym_babble.{module}".rstrip(".")
            wanted = [f"{full}.{one}" for one in module_pages.public_names(module)]
            faults += [f"{one} is not on api/{name}.html" for one in wanted if one not in anchors]
    return faults


def broken_links(site: Path) -> list[str]:
    """Links inside the site that lead nowhere, and what pages load from other hosts."""
    pages: dict[Path, Page] = {}
    for path in sorted(site.rglob("*.html")):
        if path.relative_to(site).parts[0] not in (*OTHERS, "_static"):
            pages[path] = Page(path)
    faults = []
    for path, page in pages.items():
        for tag, attribute, address in page.links:
            fault = _fault(site, path, (tag, attribute), address, pages)
            if fault:
                faults.append(f"{path.relative_to(site)}: {address}: {fault}")
    return faults


def _fault(
    site: Path, path: Path, place: tuple[str, str], address: str, pages: dict[Path, Page]
) -> str:
    """What is wrong with an address of a page; empty if nothing is."""
    parts = urlsplit(address)
    if parts.scheme or parts.netloc:
        is_other = place in LOADED and parts.scheme != "data"
        return "is loaded from another host" if is_other else ""
    target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
    if parts.path.startswith("/") or not target.is_relative_to(site):
        return "leads out of the site"
    target = target / "index.html" if target.is_dir() else target
    if not target.is_file():
        return "no such file"
    anchor = unquote(parts.fragment)
    if anchor and target in pages and anchor not in pages[target].anchors:
        return "no such anchor"
    return ""


def main(site: Path) -> None:
    """Checks a site, prints its faults, and fails if there are any."""
    pages = expected()
    faults = [
        f"the {kind} {name} is missing"
        for kind, names in pages.items()
        for name in names
        if not (site / name).is_file()
    ]
    faults += [f"{name} is on no page of the API" for name in module_pages.undocumented()]
    faults += missing_names(site) + broken_links(site)
    if faults:
        sys.exit("\n".join(("error: the site has faults", *faults)))
    counts = ", ".join(f"{len(names)} of kind {kind}" for kind, names in pages.items())
    print(f"{site}: all expected pages ({counts}) and all links inside are there")


if __name__ == "__main__":
    main(Path(sys.argv[1]).resolve())
