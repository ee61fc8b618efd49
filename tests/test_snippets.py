"""The Python of README and docs runs, and the commands in them exist."""

import re
import runpy
import shlex
import warnings

import pytest
from serving import served

from gym_babble.cli import main
from gym_babble.remote import DEFAULT_URL

FOLDERS = ("docs", "docs/how-to")
FENCED = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)
PAGES = (
    "README.md",
    *(
        f"docs/{name}.md"
        for name in (
            "baselines",
            "beyond-the-paper",
            "environments",
            "export",
            "index",
            "start",
            "studies",
            *(f"how-to/own-{name}" for name in ("agent", "body", "chunk", "model", "rule")),
        )
    ),
)

FRAMEWORKS = "docs/frameworks.md"
"""Runs by section: here what needs nothing more, the others by `make frameworks`."""
SERVED = "docs/server.md"
"""Runs with a server, whose address replaces the default one."""
HERE = ("stable-baselines3",)
IN_TEST_EXAMPLES = ("CleanRL's style",)


def blocks(repository, page, *languages):
    """The code blocks of a page that are in one of the languages."""
    text = (repository / page).read_text(encoding="utf-8")
    return [code for language, code in FENCED.findall(text) if language in languages]


def small(code):
    """The code with thousands of movements, babbles or steps turned into tens."""
    return re.sub(r"\b(\d+)_000\b", r"\g<1>0", code)


def test_every_page_with_python_is_run(repository):
    docs = [path for folder in FOLDERS for path in (repository / folder).glob("*.md")]
    found = [str(path.relative_to(repository)) for path in [repository / "README.md", *docs]]
    runs = {*PAGES, FRAMEWORKS, SERVED}
    assert {page for page in found if blocks(repository, page, "python")} == runs


def test_every_section_of_frameworks_is_run(repository):
    text = (repository / FRAMEWORKS).read_text(encoding="utf-8")
    heads = re.findall(r"^## (.+?)(?: [\d.]+)?$", text, re.MULTILINE)
    runner = runpy.run_path(str(repository / ".ci" / "frameworks.py"))
    apart = [name for names in runner["ENVIRONMENTS"].values() for name in names]
    assert [*heads[:-1]] == [*apart, *IN_TEST_EXAMPLES]
    makefile = (repository / "Makefile").read_text(encoding="utf-8")
    assert f"FRAMEWORK_SETS := {' '.join(runner['ENVIRONMENTS'])}\n" in makefile
    assert all(runner["commands"](name) for name in apart)


@pytest.mark.parametrize("name", HERE)
def test_a_framework_that_is_here_runs(repository, name, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    runner = runpy.run_path(str(repository / ".ci" / "frameworks.py"))
    ((_, _, code),) = runner["commands"](name)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        exec(compile(small(code), name, "exec"), {"__name__": "snippet"})  # noqa: S102 - ours


@pytest.mark.parametrize("page", PAGES)
def test_the_python_of_a_page_runs(repository, page, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    for code in blocks(repository, page, "toml", "python"):
        if name := re.match(r"# (\S+\.(?:toml|py)): ", code):
            (tmp_path / name[1]).write_text(code, encoding="utf-8")
    names = {"__name__": "snippet"}
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for code in blocks(repository, page, "python"):
            exec(compile(small(code), page, "exec"), names)  # noqa: S102 - our own docs


def test_the_python_of_the_servers_page_runs(repository):
    with served() as server:
        for code in blocks(repository, SERVED, "python"):
            assert DEFAULT_URL in code
            here = code.replace(DEFAULT_URL, server.url)
            exec(compile(here, SERVED, "exec"), {"__name__": "snippet"})  # noqa: S102 - our own docs


def shell_lines(repository):
    """The commands in the docs' shell blocks and in inline code, comments cut off."""
    for path in (path for folder in (".", *FOLDERS) for path in (repository / folder).glob("*.md")):
        page = str(path.relative_to(repository))
        for code in blocks(repository, page, "sh", "console"):
            for line in code.replace("\\\n", " ").splitlines():
                yield page, line.split(" #")[0].strip()
        text = FENCED.sub("", path.read_text(encoding="utf-8"))
        yield from ((page, line) for line in re.findall(r"`((?:gym-babble|make) [^`|]+)`", text))


def test_the_docs_commands_are_those_of_the_command_line(repository, capsys):
    lines = {line for _, line in shell_lines(repository) if line.startswith("gym-babble ")}
    assert len(lines) > 10
    for line in lines:
        words = [word for word in shlex.split(line)[1:] if word not in ("…", "&")]
        with pytest.raises(SystemExit) as ended:
            main([*words, "--help"])
        assert ended.value.code == 0, (line, capsys.readouterr().err)


def test_the_docs_targets_are_the_makefiles(repository):
    makefile = (repository / "Makefile").read_text(encoding="utf-8")
    known = set(re.findall(r"^([a-z-]+):", makefile, re.MULTILINE))
    named = [shlex.split(line) for _, line in shell_lines(repository) if line.startswith("make")]
    targets = {word for _, *words in named for word in words if re.fullmatch(r"[a-z-]+", word)}
    assert len(targets) > 5
    assert targets <= known
