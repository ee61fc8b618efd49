"""Make the addresses in README.md absolute, for a release.

In the repository they are relative, so that they hold in every fork and checkout. PyPI shows the
README beside no other file: there links and pictures must name the repository at the release's tag.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

RELATIVE = re.compile(r"(!?)\[([^\]]*)\]\((?!https?://)([^)\s]+)\)")
"""A link or picture of markdown whose address is relative: mark of a picture, text, address."""


def value(file: Path, key: str) -> str:
    """The first value of a key in a TOML file; Python 3.10 has no reader of its own."""
    found = re.search(rf'^{key} = "(.+)"$', file.read_text(encoding="utf-8"), re.MULTILINE)
    if found is None:
        sys.exit(f"error: {file} has no {key}")
    return found[1]


def absolute(text: str, repository: str, version: str) -> str:
    """The text with absolute addresses, at the tag of a version."""
    raw = repository.replace("//github.com/", "//raw.githubusercontent.com/", 1)

    def address(found: re.Match[str]) -> str:
        picture, words, path = found.groups()
        path = f"README.md{path}" if path.startswith("#") else path
        root = raw if picture else f"{repository}/blob"
        return f"{picture}[{words}]({root}/v{version}/{path})"

    return RELATIVE.sub(address, text)


def main(folder: Path) -> None:
    """Rewrite the README of a checkout, or of an unpacked sdist."""
    repository = value(folder / "pyproject.toml", "Repository")
    version = value(folder / "Cargo.toml", "version")
    readme = folder / "README.md"
    text = readme.read_text(encoding="utf-8")
    readme.write_text(absolute(text, repository, version), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
