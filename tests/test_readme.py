"""What the README shows and prints, and what PyPI makes of it."""

import re
import runpy

import gymnasium
import pytest
from PIL import Image
from test_snippets import blocks

IMAGES = "docs/images"
"""The folder of the docs' pictures."""


@pytest.fixture(scope="module")
def pages(repository):
    """The text of each page, by its path in the repository."""
    folders = (".", "docs", "docs/how-to", "docs/experiments")
    found = [path for folder in folders for path in (repository / folder).glob("*.md")]
    return {path.relative_to(repository): path.read_text(encoding="utf-8") for path in found}


@pytest.fixture(scope="module")
def pypi(repository):
    """The module that prepares the README for PyPI."""
    return runpy.run_path(str(repository / ".ci" / "pypi_readme.py"))


def anchors(text):
    """The anchors of a page's headings, as GitHub names them."""
    headings = re.findall(r"^#+ (.+)$", text, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-") for head in headings}


def test_the_quick_start_prints_what_it_says(repository, capsys):
    code, printed = (
        blocks(repository, "README.md", language)[0] for language in ("python", "text")
    )
    assert len(code.splitlines()) <= 12
    exec(compile(code, "README.md", "exec"), {})  # noqa: S102 - our own README
    assert capsys.readouterr().out == printed


def test_each_link_of_a_page_leads_somewhere(pages, pypi, repository):
    for page, text in pages.items():
        for _, _, address in pypi["RELATIVE"].findall(text):
            path, _, anchor = address.partition("#")
            if path.endswith("lab/index.html") or path.startswith("envs/"):
                continue  # On the site alone, where `make docs` checks it.
            target = (repository / page.parent / path).resolve() if path else repository / page
            assert target.exists(), (page, address)
            assert not anchor or anchor in anchors(target.read_text(encoding="utf-8")), address


def test_each_picture_is_shown_by_a_page_and_is_small(pages, repository):
    text = "".join(pages.values())
    for path in (repository / IMAGES).glob("*.*"):
        assert f"images/{path.name})" in text, path.name
        assert path.stat().st_size < 500_000, path.name


def test_the_first_picture_moves(repository):
    text = (repository / "README.md").read_text(encoding="utf-8")
    first = re.search(r"!\[[^]]+\]\(([^)]+)\)", text)
    assert text.index(first[0]) < 1_000
    with Image.open(repository / first[1]) as film:
        assert film.n_frames > 20


def test_pypi_gets_absolute_addresses_at_the_tag(repository, pypi):
    text = (repository / "README.md").read_text(encoding="utf-8")
    root = pypi["value"](repository / "pyproject.toml", "Repository")
    version = pypi["value"](repository / "Cargo.toml", "version")
    shown = pypi["absolute"](text, root, version)
    assert not pypi["RELATIVE"].search(shown)
    pictures = re.findall(r"!\[[^]]*\]\(([^)]+)\)", shown)
    raw = f"https://raw.githubusercontent.com/gym-babble/gym-babble/v{version}/"
    assert len(pictures) >= 2
    assert all((repository / address.removeprefix(raw)).is_file() for address in pictures)
    linked = re.findall(rf"\({re.escape(root)}/blob/v{re.escape(version)}/([^)#]+)", shown)
    assert len(linked) > 10
    assert all((repository / path).is_file() for path in linked)


def test_both_kinds_of_links_become_absolute(pypi):
    text = "![a](b.png) [c](d.md#e) [f](#g) [h](https://i)"
    host = "https://github.com/us/it"
    assert pypi["absolute"](text, host, "1.2") == (
        "![a](https://raw.githubusercontent.com/us/it/v1.2/b.png) "
        f"[c]({host}/blob/v1.2/d.md#e) [f]({host}/blob/v1.2/README.md#g) [h](https://i)"
    )


def test_both_citations_are_the_projects(repository, pypi):
    cff = (repository / "CITATION.cff").read_text(encoding="utf-8")
    (bibtex,) = blocks(repository, "README.md", "bibtex")
    version = pypi["value"](repository / "Cargo.toml", "version")
    address = pypi["value"](repository / "pyproject.toml", "Repository")
    assert f"\nversion: {version}\n" in cff
    assert f"{{{version}}}" in bibtex
    assert f"\nrepository-code: {address}\n" in cff
    assert f"{{{address}}}" in bibtex
    families = re.findall(r"family-names: (\w+)\n +given-names: (\w+)", cff)
    authors = " and ".join(f"{family}, {given}" for family, given in families)
    words = " ".join(re.sub("[{}]", "", bibtex).split())
    assert authors in words
    for title in re.findall(r'title: "?([^"\n]+)', cff):
        assert title in words


def test_the_table_of_ids_is_complete(repository):
    text = (repository / "README.md").read_text(encoding="utf-8")
    ours = [name for name in gymnasium.registry if re.match(r"Babble(?!Toy)", name)]
    assert re.findall(r"^\| `(Babble\w+-v\d+)`(?: \||,)", text, re.MULTILINE)[: len(ours)] == ours
