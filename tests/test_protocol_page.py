"""docs/protocol.md says what the server speaks."""

from __future__ import annotations

import json

from gym_babble._core import server_protocol
from results.protocol import PAGE, filled, kind


def test_the_page_is_made_from_the_servers_schemas():
    """`python -m results.protocol` writes it."""
    page = PAGE.read_text(encoding="utf-8")
    assert page == filled(page)
    # Every message has a section, and every link leads to one.
    protocol = json.loads(server_protocol())
    for name in (*protocol["requests"], *protocol["replies"]):
        assert f"\n### {name}\n" in page, name
        assert f"(#{name.lower()})" in page, name


def test_types_are_said_in_words():
    shown = {"$ref": "#/$defs/Shown"}
    assert kind({"anyOf": [shown, {"type": "null"}]}) == "[Shown](#shown) or nil"
    assert kind({"type": ["array", "null"], "items": {"type": ["integer", "null"]}}) == (
        "array of (int or nil) or nil"
    )
    assert kind({"description": "anything"}) == "any"
