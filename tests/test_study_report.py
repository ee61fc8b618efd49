"""A report says what its study's folder holds: all of it, and nothing else."""

from __future__ import annotations

import csv
import json
import re
from html import unescape
from html.parser import HTMLParser
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

pytest.importorskip("jinja2", reason="the wheel's tests install no extra")
pytest.importorskip("matplotlib", reason="the wheel's tests install no extra")
pytest.importorskip("scipy", reason="the wheel's tests install no extra")

from gym_babble.cli import main
from gym_babble.errors import ConfigError
from gym_babble.report.charts import learning_charts
from gym_babble.report.citation import bibtex
from gym_babble.report.data import AXES, tasks_of
from gym_babble.report.formats import count, seconds
from gym_babble.report.joined import read_joined
from gym_babble.report.numbers import task_numbers
from gym_babble.report.writing import REPORT_FILES, write_report
from gym_babble.study.rates import share
from gym_babble.study.run import execute, runs_of
from gym_babble.study.spec import study_of
from gym_babble.study.store import Store

if TYPE_CHECKING:
    from pathlib import Path

HOSTILE = "<script>alert('study & report')</script>"
SPEC: dict[str, Any] = {
    "name": "small",
    "title": HOSTILE,
    "seeds": 2,
    "tasks": {"reach": {"protocol": "table1", "cases": 40, "checkpoint_cases": 20}},
    "agents": [
        {"agent": "hebb-paper", "budget": 30_000},
        "random",
        "scripted",
        {"agent": "nowhere:Nobody", "label": "nobody", "seeds": [0]},
        {"agent": "oracle", "label": "missing"},
    ],
}
MISSING = "reach.missing.0"
VOID = {"meta", "br", "path", "use", "img"}


@pytest.fixture(scope="module")
def store(tmp_path_factory) -> Store:
    """The folder of a study with finished runs, a failed and a missing one, and one left over."""
    made = Store(tmp_path_factory.mktemp("study"))
    earlier = study_of({**SPEC, "tasks": {"reach": {"protocol": "table1", "cases": 2}}})
    made.open(earlier)
    specs = [*runs_of(earlier)[2:3], *runs_of(study_of(SPEC))]
    for spec in specs:
        if spec.name != MISSING:
            made.write(spec, *execute(spec))
    made.open(study_of(SPEC))
    return made


@pytest.fixture(scope="module")
def logs(tmp_path_factory) -> Path:
    """The logs of two runs of stable-baselines3, in a folder with a hostile name."""
    folder = tmp_path_factory.mktemp("logs") / "<a>"
    for seed in ("a", "b"):
        (folder / seed).mkdir(parents=True)
        steps, successes = np.array([0, 10, 100]), np.array([[0, 0], [1, 0], [1, 1]])
        np.savez(folder / seed / "evaluations.npz", timesteps=steps, successes=successes)
    return folder


@pytest.fixture(scope="module")
def report(store, logs, tmp_path_factory) -> dict[str, str]:
    """The files of the report by name, as the command line writes them."""
    folder = tmp_path_factory.mktemp("report")
    words = ["study", "report", str(store.folder), "--out", str(folder)]
    words += ["--join", f"reach:mine={logs}", "--steps-per-action", "200"]
    with pytest.raises(SystemExit) as ended:
        main(words)
    assert not ended.value.code
    return {path.name: path.read_text(encoding="utf-8") for path in folder.iterdir()}


class Page(HTMLParser):
    """Elements and texts of a page; fails where an element does not end."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.cells: list[list[str]] = []
        self.feed(page)
        self.close()
        assert not self.open

    def handle_starttag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))
        if tag == "tr":
            self.cells.append([])
        if tag in {"td", "th"} and self.cells:
            self.cells[-1].append("")
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))

    def handle_endtag(self, tag):
        if tag not in VOID:
            assert self.open.pop() == tag

    def handle_data(self, data):
        if {"td", "th"} & {*self.open} and self.cells:
            self.cells[-1][-1] += f" {data.strip()}"

    def row(self, *beginnings: str) -> list[str]:
        """The first row whose first cells begin like this."""
        rows = ([" ".join(cell.split()) for cell in row] for row in self.cells)
        return next(
            row
            for row in rows
            if len(row) >= len(beginnings)
            and all(cell.startswith(b) for cell, b in zip(row, beginnings, strict=False))
        )


@pytest.fixture(scope="module")
def page(report) -> Page:
    return Page(report["index.html"])


def test_a_report_is_a_page_with_its_numbers_tables_and_charts(report):
    assert set(REPORT_FILES) < set(report)
    charts = {"success", "profiles", "curve.control_steps", "case0", "hebb-paper.fig4", "fig2"}
    assert {f"reach.{name}.svg" for name in charts} < set(report)
    assert json.loads(report["results.json"])["files"] == sorted(
        name for name in report if name.endswith(".svg")
    )


def test_a_page_needs_nothing_but_itself(report, page):
    fetched = ("src", "href", "xlink:href", "srcset", "action", "data")
    for tag, attributes in page.elements:
        for name in fetched:
            value = attributes.get(name) or ""
            assert value.startswith(("data:", "#")) or not value, (tag, value)
    assert not re.findall(r"@import|url\((?!#)|\bfetch\(", report["index.html"])
    assert "//" not in re.sub(r"https://github.com/gym-babble/\S+|^//.*$|data:[^\"]+", "",
                              report["index.html"], flags=re.MULTILINE)  # fmt: skip


def test_ids_are_unique_and_links_lead_to_them(page):
    ids = [attributes["id"] for _, attributes in page.elements if "id" in attributes]
    assert len(ids) == len({*ids})
    links = [
        attributes.get("xlink:href") or attributes.get("href") for _, attributes in page.elements
    ]
    assert {link[1:] for link in links if link and link.startswith("#")} <= {*ids}


def test_the_numbers_are_those_of_the_store(store, report, page):
    (task,) = json.loads(report["results.json"])["tasks"]
    agents = {agent["label"]: agent for agent in task["agents"]}
    rows = {(row["label"], row["seed"]): row for row in table(report["runs.csv"])}
    for run in store.runs():
        if not run.finished:
            continue
        test, label = run.record["test"], run.spec.agent.label
        hits = test["outcome"].count(str(test["outcomes"].index("success")))
        (found,) = (one for one in agents[label]["runs"] if one["seed"] == run.spec.seed)
        assert found["rates"]["success"]["count"] == hits
        row = rows[label, str(run.spec.seed)]
        assert float(row["success"]) == hits / 40
        assert int(row["control_steps"]) == run.record["cost"]["control_steps"]
        shown = page.row(label, "reach", str(run.spec.seed), "finished")
        assert shown[4].split()[0] == share(hits / 40)
        assert shown[6] == f"{run.record['cost']['control_steps']:,}"


def test_the_table_of_rates_is_that_of_the_json(report, page):
    (task,) = json.loads(report["results.json"])["tasks"]
    by_label = {row["label"]: row for row in table(report["rates.csv"])}
    for agent in task["agents"]:
        success = agent["success"]
        row = page.row(agent["title"])
        assert row[1].split()[0] == share(success["iqm"]["estimate"])
        assert row[4] == share(agent["rates"]["collision"])
        assert float(by_label[agent["label"]]["success_iqm"]) == success["iqm"]["estimate"]
        seeds = [run["rates"]["success"]["rate"] for run in agent["runs"]]
        assert (success["worst"], success["best"]) == (min(seeds), max(seeds))
        assert success["worst"] <= success["iqm"]["estimate"] <= success["best"]


def test_runs_that_failed_or_are_missing_are_rows_that_say_so(report, page):
    assert "there is no module 'nowhere'" in page.row("nobody", "failed")[1]
    assert page.row("missing", "reach", "0")[3].startswith("missing")
    rows = {row["label"]: row for row in table(report["runs.csv"])}
    assert rows["nobody"]["status"] == "failed"
    assert "nowhere" in rows["nobody"]["why"]
    assert "1 run failed" in report["index.html"]
    assert "1 stored run left out" in report["index.html"]
    (unfit,) = json.loads(report["results.json"])["unfit"]
    assert "task.cases was 2, and is 40 now" in unfit
    assert unfit in report["index.html"]


def test_names_are_text_and_never_markup(report):
    assert HOSTILE not in report["index.html"]
    assert "&lt;script&gt;alert(" in report["index.html"]
    assert "<a>" not in report["index.html"]
    assert "&lt;a&gt;" in report["index.html"]


def test_a_few_seeds_are_warned_of(report):
    assert "Hebb paper, Random: Only 2 seeds" in report["index.html"]
    assert "Scripted: Only" not in report["index.html"]


def test_who_is_better_is_one_minus_who_is_worse(report):
    (task,) = json.loads(report["results.json"])["tasks"]
    better = task["improvement"]
    for x, others in better.items():
        for y, one in others.items():
            there, back = one["probability"], better[y][x]["probability"]
            assert there["estimate"] + back["estimate"] == pytest.approx(1.0)
            if there["low"] is not None:
                assert there["low"] <= there["estimate"] <= there["high"]
                assert there["low"] + back["high"] == pytest.approx(1.0)
    paper = better["hebb-paper"]["random"]["probability"]
    seeds = {
        agent["label"]: [run["rates"]["success"]["rate"] for run in agent["runs"]]
        for agent in task["agents"]
    }
    signs = [np.sign(a - b) for a in seeds["hebb-paper"] for b in seeds["random"]]
    assert paper["estimate"] == pytest.approx((1 + np.mean(signs)) / 2)


def test_runs_that_join_stand_beside_the_learners(report, page):
    assert page.row("mine")[:2] == ["mine joined, 2 runs", "2,000 0–2,000"]
    assert "mine: from logs of stable-baselines3" in report["index.html"]
    assert {row["axis"] for row in table(report["curves.csv"]) if row["label"] == "mine"} == {
        "control_steps"
    }


def test_budgets_that_were_not_reached_are_bounds(report):
    for row in table(report["budgets.csv"]):
        if int(row["reached"]) == 0:
            assert row["by"] == ""
            assert float(row["after"]) > 0


def test_each_learner_is_the_reference_of_ratios_in_control_steps(store, logs):
    (task,) = tasks_of(store)
    joined = read_joined(f"reach:mine={logs}", store.study(), steps_per_action=200)
    assert joined.names == ("a", "b")
    assert joined.runs == [([2_000.0, 20_000.0], [0.5, 1.0])] * 2
    numbers = task_numbers(task, [joined])
    assert {axis: {*found} for axis, found in numbers["ratios"].items()} == {
        "trials": {"hebb-paper"},
        "control_steps": {"hebb-paper", "mine"},
        "cpu_seconds": {"hebb-paper"},
    }
    (mine,) = numbers["joined"]
    assert [cell["by"] for cell in mine["budgets"]["control_steps"]] == [2e3] + [2e4] * 4
    names = [chart.name for chart in learning_charts(numbers)]
    assert names == [f"reach.curve.{axis}" for axis in AXES]


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ("reach:mine", "TASK:LABEL=PATH"),
        ("reach:a b=logs", "TASK:LABEL=PATH"),
        ("grip:mine=logs", "'grip' is not one of reach"),
        ("reach:random=logs", "already"),
        ("reach:mine=nowhere", "no file or folder nowhere"),
    ],
)
def test_what_cannot_join_is_named(store, given, said):
    with pytest.raises(ConfigError, match=said):
        read_joined(given, store.study())


def test_the_same_store_and_logs_are_the_same_report(store, logs, report, tmp_path):
    # An earlier report of a study with another task leaves nothing behind.
    (tmp_path / "results.json").write_text('{"files": ["old.svg", "../x.svg"]}', encoding="utf-8")
    for name in ("old.svg", "mine.svg"):
        (tmp_path / name).write_text("<svg/>", encoding="utf-8")
    (command,) = re.findall(r"<pre>(gym-babble study report .*)</pre>", report["index.html"])
    joined = [read_joined(f"reach:mine={logs}", store.study(), 200)]
    write_report(store, tmp_path, unescape(command), joined)
    written = {path.name: path.read_text(encoding="utf-8") for path in tmp_path.iterdir()}
    assert written.pop("mine.svg")
    assert written == report


def test_a_study_that_has_not_begun_has_a_report_too(tmp_path):
    made = Store(tmp_path / "study")
    made.open(study_of(SPEC))
    (page, *_) = write_report(made, tmp_path / "report", "")
    text = page.read_text(encoding="utf-8")
    assert "No run of this study is finished yet." in text
    assert "7 runs missing" in text
    Page(text)


def test_a_report_is_cited_as_the_readme_says(repository, report):
    readme = (repository / "README.md").read_text(encoding="utf-8")
    entries = readme.partition("```bibtex\n")[2].partition("```")[0]
    assert bibtex().split() == entries.split()
    assert "Using motor babbling and {Hebb} rules" in report["index.html"]


@pytest.mark.slow
def test_a_report_of_grasping_shows_sizes_hands_and_sight(tmp_path):
    task = {"protocol": "palm_side", "cases": 12, "checkpoint_cases": 6, "budget": 4_000}
    study = study_of({"name": "g", "tasks": {"grasp": task}, "agents": ["hebb-paper", "random"]})
    made = Store(tmp_path / "study")
    made.open(study)
    for spec in runs_of(study):
        made.write(spec, *execute(spec))
    files = {path.name: path for path in write_report(made, tmp_path / "report", "")}
    charts = {"hebb-paper.fig7", "hebb-paper.fig8", "sight", "case5"}
    assert {f"grasp.{name}.svg" for name in charts} < set(files)
    text = files["index.html"].read_text(encoding="utf-8")
    Page(text)
    for sentence in ("A grasp", "any touch", "Success by size", "objects placed in the hand"):
        assert sentence in text
    assert '<tr class="paper">' not in text


@pytest.mark.parametrize(
    ("value", "shown"), [(950, "950"), (12_345, "12,300"), (1.2546e6, "1.25 M"), (3e9, "3 G")]
)
def test_counts_are_short(value, shown):
    assert count(value) == shown


@pytest.mark.parametrize(
    ("value", "shown"), [(0.123, "0.12 s"), (95.0, "95 s"), (720.0, "12 min"), (12_240.0, "3.4 h")]
)
def test_times_are_short(value, shown):
    assert seconds(value) == shown


def table(text: str) -> list[dict[str, str]]:
    return list(csv.DictReader(text.splitlines()))
