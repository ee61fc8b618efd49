"""`gym-babble lab`: the page's server, and the records that students hand in."""

from __future__ import annotations

import csv
import io
import json
import threading
import time
from http.client import HTTPConnection

import pytest

from gym_babble import _core
from gym_babble.cli import main
from gym_babble.errors import ConfigError
from gym_babble.files.handed_in import as_csv
from gym_babble.lab.checking import COLUMNS, Checked, check_record
from gym_babble.lab.serving import page_server


@pytest.fixture
def page(tmp_path):
    """A page with a file of each kind."""
    folder = tmp_path / "page"
    (folder / "assets").mkdir(parents=True)
    for name in ("index.html", "assets/app.js", "assets/engine.wasm", "manifest.webmanifest"):
        (folder / name).write_text(name)
    (tmp_path / "secret.txt").write_text("secret")
    return folder


@pytest.fixture
def get(page):
    """Asks the page's server for a path: status, type and body of the answer."""
    with page_server(0, page) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()

        def ask(path):
            connection = HTTPConnection("127.0.0.1", server.server_port, timeout=10)
            connection.request("GET", path)
            answer = connection.getresponse()
            found = answer.status, answer.headers["Content-Type"], answer.read().decode()
            connection.close()
            return found

        yield ask
        server.shutdown()


@pytest.mark.parametrize(
    ("path", "kind", "body"),
    [
        ("/", "text/html", "index.html"),
        ("/assets/app.js?v=1", "text/javascript", "assets/app.js"),
        ("/assets/engine.wasm", "application/wasm", "assets/engine.wasm"),
        ("/manifest.webmanifest", "application/manifest+json", "manifest.webmanifest"),
    ],
)
def test_the_page_is_served_with_the_types_that_browsers_need(get, path, kind, body):
    assert get(path) == (200, kind, body)


@pytest.mark.parametrize("path", ["/assets/", "/../secret.txt", "/%2e%2e/secret.txt", "/none"])
def test_nothing_else_is_served(get, path):
    status, _, body = get(path)
    assert status == 404
    assert "secret" not in body


def test_the_server_is_reached_from_this_machine_alone(page):
    with page_server(0, page) as server:
        assert server.server_address[0] == "127.0.0.1"


def test_a_package_without_the_page_says_what_to_do(tmp_path):
    with pytest.raises(ConfigError, match=r"without the lab's page.*Node 20\.19.*make lab"):
        page_server(0, tmp_path)


def test_a_port_that_is_taken_is_an_error_that_helps(page, monkeypatch, capsys):
    monkeypatch.setattr("gym_babble.cli.lab.page_server", lambda port: page_server(port, page))
    with page_server(0, page) as server, pytest.raises(SystemExit) as ended:
        main(["lab", "--port", str(server.server_port)])
    assert ended.value.code == 1
    assert "--port 0 takes any free one" in capsys.readouterr().err


# A session as the page writes it: two babbles of reaching. The hash is what running it gives.
RECORD = {
    "version": 1,
    "package": None,
    "lesson": None,
    "name": "Ada",
    "setup": {
        "env": "BabbleReach-v0",
        "options": {},
        "profile": "paper",
        "config": {},
        "seed": 3,
        "agents": [{"kind": "hebb", "variant": "paper", "brain": {}, "rule": None}],
    },
    "commands": [{"do": "babble", "n": 2}, {"do": "test", "n": 3}],
    "hash": "0000000000000000",
}


@pytest.fixture
def record():
    """The record, of this version of the package."""
    return {**RECORD, "package": _core.__version__}


def written(tmp_path, record, name="record.json"):
    path = tmp_path / name
    path.write_text(record if isinstance(record, str) else json.dumps(record), encoding="utf-8")
    return path


def found_hash(record):
    """The hash in which running a record ends."""
    return json.loads(_core.check_record(json.dumps(record), {}, 60.0, 1))["hash"]


def test_a_record_that_is_right_is_accepted_and_one_that_was_altered_is_not(tmp_path, record):
    record["hash"] = found_hash(record)
    checked = check_record(written(tmp_path, record))
    assert checked == Checked(file="record.json", name="Ada", commands=2, same_hash=True)
    assert checked.verdict == "no lesson"
    for alter in (
        {"hash": "0" * 16},
        {"commands": [{"do": "babble", "n": 3}, {"do": "test", "n": 3}]},
        {"commands": record["commands"][:1]},
        {"setup": {**record["setup"], "seed": 4}},
    ):
        checked = check_record(written(tmp_path, {**record, **alter}))
        assert not checked.same_hash
        assert "it was altered" in checked.verdict, alter


def test_the_tasks_and_answers_of_a_lesson_are_counted(tmp_path, record):
    answer = {"do": "answer", "question": "constant", "value": 0.4}
    done = [{"do": "recall", "case": None}, {"do": "step", "n": 1_000}]
    setup = {**record["setup"], "agents": [{"kind": "scripted"}]}
    record |= {"lesson": "equilibrium", "setup": setup, "commands": [answer, *done]}
    record["hash"] = found_hash(record)
    checked = check_record(written(tmp_path, record))
    assert checked.lesson == "equilibrium"
    assert (sum(checked.tasks), sum(checked.answers)) == (1, 1)
    assert checked.tasks[0]
    assert "tasks not done" in checked.verdict
    record["commands"][0] = {**answer, "value": 0.5}
    record["hash"] = found_hash(record)
    assert not any(check_record(written(tmp_path, record)).answers)


DEEP = '{"setup":' * 100_000


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("", "no record of the lab"),
        ("[1, 2]", "no record of the lab"),
        (DEEP, "no record of the lab"),
        ('{"version": 1e999}', "no record of the lab"),
        ("x" * (4 * 2**20 + 1), "more than 4,194,304 bytes"),
    ],
    ids=["empty", "list", "deep", "infinite", "long"],
)
def test_a_file_that_is_no_record_has_a_row_that_says_so(tmp_path, content, said):
    checked = check_record(written(tmp_path, content))
    assert said in checked.verdict
    assert not checked.same_hash


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"version": 2}, "version 2 is not 1"),
        ({"package": "9.9"}, "version 9.9 of the lab"),
        ({"surprise": 1}, "surprise"),
        ({"lesson": "cooking"}, "cooking"),
        ({"name": "x" * 201}, "at most 200 letters"),
        ({"commands": [{"do": "explode"}]}, "explode"),
        ({"commands": [{"do": "babble", "n": 0}]}, "command 1"),
        (
            {
                "commands": [
                    {"do": "lesion", "agent": 7, "map": "input", "association": 0, "neurons": [1]}
                ]
            },
            "agent",
        ),
        ({"loaded": ["0123456789abcdef"]}, "cannot be run again"),
    ],
)
def test_a_record_that_cannot_be_run_has_a_row_that_says_why(tmp_path, record, change, said):
    checked = check_record(written(tmp_path, {**record, **change}))
    assert said in checked.verdict
    assert not checked.same_hash


def test_a_record_that_takes_too_long_is_given_up(tmp_path, record):
    record["commands"] = [{"do": "babble", "n": 100_000}] * 500
    started = time.monotonic()
    checked = check_record(written(tmp_path, record), seconds=0.5)
    assert "takes more than 0.5 s" in checked.verdict
    assert time.monotonic() - started < 60  # Unbounded, it would take half an hour.


def test_files_that_cannot_be_read_have_rows(tmp_path):
    binary = tmp_path / "binary.json"
    binary.write_bytes(b"\xff\xfe\x00")
    assert check_record(binary).verdict == "it is no text in UTF-8"
    assert "it cannot be read" in check_record(tmp_path).verdict
    assert "it cannot be read" in check_record(tmp_path / "missing.json").verdict


def test_texts_of_a_record_command_neither_the_terminal_nor_a_spreadsheet(tmp_path, record):
    checked = check_record(written(tmp_path, {**record, "name": "\x1b[2J=1+1\n"}))
    assert checked.name.isprintable()
    rows = [
        *csv.reader(io.StringIO(as_csv(COLUMNS, [Checked(file="a", name="=HYPERLINK(1)").row()])))
    ]
    assert rows[0] == [*COLUMNS]
    assert rows[1][1] == "'=HYPERLINK(1)"


def test_the_command_prints_a_row_for_each_file_and_writes_them(tmp_path, record, capsys):
    record["hash"] = found_hash(record)
    good, bad = written(tmp_path, record, "good.json"), written(tmp_path, "{", "bad.json")
    table = tmp_path / "class.csv"
    with pytest.raises(SystemExit) as ended:
        main(["lab", "check", str(good), str(bad), "--csv", str(table), "--json"])
    assert not ended.value.code
    rows = json.loads(capsys.readouterr().out)
    assert [row["same_hash"] for row in rows] == [True, False]
    assert [row["file"] for row in rows] == ["good.json", "bad.json"]
    assert table.read_text().splitlines()[1] == "good.json,Ada,,,,2,yes,no lesson"
