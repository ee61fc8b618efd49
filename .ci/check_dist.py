"""Check what a folder's wheel and sdist hold: the package alone, and the whole workspace."""

from __future__ import annotations

import sys
import tarfile
import zipfile
from pathlib import Path

from pypi_readme import RELATIVE

SDIST_NEEDS = {
    ".cargo/config.toml",  # The seed of the property tests.
    "Cargo.lock",
    "Cargo.toml",
    "lab/package-lock.json",
    "lab/src/engine/contract.ts",
    "LICENSE-MIT",
    "README.md",
    "pyproject.toml",
}
PAGE = "gym_babble/lab/page/index.html"
"""The lab's page, if it was built before."""
BUILT = (".so", ".pyd", ".pyc", ".wasm")
"""How files end that something else was made into."""
TOY = b"BabbleToy-" + b"v0"
"""The id of the task that only `make setup` builds."""


def check_description(path: Path, metadata: bytes) -> None:
    """What PyPI shows has only absolute addresses."""
    relative = [found.group() for found in RELATIVE.finditer(metadata.decode())]
    if relative:
        sys.exit(f"error: {path}: PyPI cannot follow {relative}: run .ci/pypi_readme.py first")


def check_wheel(path: Path) -> None:
    """One abi3 wheel, with nothing in it but gym_babble/ and its metadata."""
    with zipfile.ZipFile(path) as wheel:
        names = wheel.namelist()
        if any(TOY in wheel.read(name) for name in names):
            sys.exit(f"error: {path} holds the toy task of development builds")
        (metadata,) = (name for name in names if name.endswith(".dist-info/METADATA"))
        check_description(path, wheel.read(metadata))
    strays = [name for name in names if not name.startswith(("gym_babble/", "gym_babble-"))]
    kinds = ("*.py", "*.pyi", "*.css", "*.html", "*.js", "*.json", "*.toml", "*.yml", "py.typed")
    kinds += ("*.safetensors", "*.safetensors.xz", "*.zip")
    kinds += ("*.wasm", "*.svg", "*.png", "*.webmanifest")
    sources = {str(source) for kind in kinds for source in Path("gym_babble").rglob(kind)}
    missing = sources - set(names)
    if strays or missing or "-abi3-" not in path.name:
        sys.exit(f"error: {path}: strays {strays}, missing {sorted(missing)}")
    lab = "with" if PAGE in names else "without"
    size = path.stat().st_size / 1e6
    print(f"{path.name}: {len(names)} files, {size:.1f} MB, {lab} the lab's page")


def check_sdist(path: Path) -> None:
    """The workspace's sources, and nothing that was built."""
    with tarfile.open(path) as sdist:
        names = {name.partition("/")[2] for name in sdist.getnames()}
        metadata = sdist.extractfile(f"{path.name.removesuffix('.tar.gz')}/PKG-INFO")
        check_description(path, metadata.read())
    crates = {str(manifest) for manifest in Path("rust").glob("*/Cargo.toml")}
    missing = (SDIST_NEEDS | crates) - names
    built = [name for name in names if name.endswith(BUILT) or "node_modules" in name]
    if missing or built:
        sys.exit(f"error: {path}: missing {sorted(missing)}, built files {built}")
    print(f"{path.name}: {len(names)} files, {path.stat().st_size / 1e6:.1f} MB")


def main(folder: Path) -> None:
    """Check the one wheel and the one sdist in `folder`."""
    (wheel,) = folder.glob("*.whl")
    (sdist,) = folder.glob("*.tar.gz")
    check_wheel(wheel)
    check_sdist(sdist)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
