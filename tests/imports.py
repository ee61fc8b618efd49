"""Which file of ours uses which: the module graphs of a Rust crate and of a Python package."""

from __future__ import annotations

import ast
import re
from functools import cached_property
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

Graph = dict[str, set[str]]
Segments = tuple[str, ...]

PROSE = re.compile(r'"(?:\\.|[^"\\])*"|//.*|/\*(?s:.*?)\*/')
USE = re.compile(r"(pub(?:\([^)]*\))?\s+)?\buse\s+([^;]+);")
MODULE = re.compile(r"\bmod\s+(\w+)\s*;")
ITEM = re.compile(r"\bpub(?:\([^)]*\))?\s+(?:const\s+)?(?:struct|enum|fn|trait|const|type)\s+(\w+)")
PATH = re.compile(r"(?<![\w:])(\w+)((?:::\w+)+)")


def circles(graph: Graph) -> list[set[str]]:
    """The strongly connected components of more than one node."""
    reached = {node: _reached(graph, node) for node in graph}
    found: list[set[str]] = []
    for node in sorted(graph):
        circle = {other for other in reached[node] if node in reached[other]}
        if len(circle) > 1 and circle not in found:
            found.append(circle)
    return found


def _reached(graph: Graph, start: str) -> set[str]:
    reached: set[str] = set()
    ahead = [start]
    while ahead:
        new = graph.get(ahead.pop(), set()) - reached
        reached |= new
        ahead += new
    return reached


def merged(graph: Graph, group: dict[str, str]) -> Graph:
    """The graph between groups of nodes."""
    result: Graph = {name: set() for name in group.values()}
    for node, used in graph.items():
        result[group[node]] |= {group[other] for other in used} - {group[node]}
    return result


class Module:
    """A file of a Rust crate."""

    def __init__(self, path: Path, name: Segments, crate: dict[Segments, Module]) -> None:
        self.path = path
        self.name = name
        self.crate = crate
        crate[name] = self
        code = PROSE.sub("", path.read_text(encoding="utf-8"))
        self.children = set(MODULE.findall(code))
        self.items = set(ITEM.findall(code))
        uses = list(USE.finditer(code))
        # A declaration names a module, and does not use it.
        self.body = MODULE.sub("", USE.sub("", code))
        self.exports = [leaf for use in uses if use[1] for leaf in leaves(use[2])]
        self.imports = [leaf for use in uses if not use[1] for leaf in leaves(use[2])]
        folder = path.parent if path.stem in {"lib", "mod"} else path.with_suffix("")
        for child in self.children:
            files = (folder / f"{child}.rs", folder / child / "mod.rs")
            Module(next(file for file in files if file.exists()), (*name, child), crate)

    @cached_property
    def used(self) -> set[Module]:
        """The modules that this one uses, itself left out. To hand on a name is not to use it."""
        written = set(re.findall(r"\w+", self.body))
        paths = [path for path, _ in self.imports]
        paths += [path for path, name in self.exports if name in written]
        paths += [tuple(f"{first}{rest}".split("::")) for first, rest in PATH.findall(self.body)]
        found = {self.resolve(path) for path in paths}
        return {module for module in found if module not in {None, self}}

    def resolve(self, path: Segments) -> Module | None:
        """The module in which a path's item is defined, if it is one of this crate."""
        first, *rest = path
        if first == "crate":
            return self.crate[()].find(rest)
        if first == "super":
            parent = self.crate[self.name[:-1]]
            return parent.resolve(tuple(rest)) if rest[:1] == ["super"] else parent.find(rest)
        if first == "self":
            return self.find(rest)
        return self.find(path) if first in self.children else None

    def find(self, path: Segments | list[str]) -> Module:
        """The module in which an item is defined that this one holds or hands on."""
        if not path or path[0] == "*" or path[0] in self.items:
            return self
        first, *rest = path
        if first in self.children:
            return self.crate[(*self.name, first)].find(rest)
        for target, name in self.exports:
            if name == first and (module := self.resolve((*target, *rest))):
                return module
            if name == "*" and (module := self.resolve(target)) and first in module.items:
                return module
        return self


def leaves(tree: str) -> Iterator[tuple[Segments, str]]:
    """Each path that a `use` tree names, and the name that it gets."""
    tree = " ".join(tree.split())
    prefix, brace, inner = tree.partition("{")
    if not brace:
        path, _, alias = tree.partition(" as ")
        segments = tuple(segment.strip() for segment in path.split("::") if segment.strip())
        if segments[-1] == "self":
            segments = segments[:-1]
        yield segments, alias or segments[-1]
        return
    for branch in _branches(inner.rpartition("}")[0]):
        yield from leaves(prefix + branch)


def _branches(text: str) -> Iterator[str]:
    """The parts between commas that no brace encloses."""
    depth, branch = 0, ""
    for character in text:
        depth += (character == "{") - (character == "}")
        if character == "," and depth == 0:
            yield branch
            branch = ""
        else:
            branch += character
    if branch.strip():
        yield branch


def rust_graph(source: Path) -> Graph:
    """The files of the crate whose sources are in `source`, each with those that it uses."""
    crate: dict[Segments, Module] = {}
    Module(source / "lib.rs", (), crate)
    name = {module: module.path.relative_to(source).as_posix() for module in crate.values()}
    return {name[module]: {name[used] for used in module.used} for module in name}


def python_graph(package: Path) -> Graph:
    """The modules of a package by their dotted names, each with those that it imports."""
    files = {_dotted(file, package): file for file in package.rglob("*.py")}
    return {name: set(_imported(file, files)) - {name} for name, file in files.items()}


def _dotted(file: Path, package: Path) -> str:
    parts = file.relative_to(package.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def _imported(file: Path, files: dict[str, Path]) -> Iterator[str]:
    """Modules among `files` that a file imports, in functions and for types too."""
    tree = ast.parse(file.read_text(encoding="utf-8"))
    loaded = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name in files)
        elif isinstance(node, ast.ImportFrom):
            for alias in node.names:
                # A package that imports a name for others to import does not use it.
                if file.name != "__init__.py" or (alias.asname or alias.name) in loaded:
                    yield from _defining(node.module or "", alias.name, files)


def _defining(module: str, name: str, files: dict[str, Path]) -> Iterator[str]:
    """The module among `files` that defines what `module` offers under that name."""
    if f"{module}.{name}" in files:
        yield f"{module}.{name}"
    elif module in files and name != "_core":
        for node in ast.walk(ast.parse(files[module].read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and name in {alias.name for alias in node.names}:
                yield from _defining(node.module or "", name, files)
                return
        yield module
