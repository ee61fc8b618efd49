"""The tables of docs/protocol.md, from the schemas of the server: `python -m results.protocol`."""

from __future__ import annotations

import json
import re
from typing import Any

from gym_babble._core import server_protocol
from gym_babble.files.write import write_file
from results.stores import ROOT
from results.tables import markdown

PAGE = ROOT / "docs/protocol.md"
BLOCK = re.compile(r"(<!-- protocol -->\n)(.*?)(<!-- end -->)", re.DOTALL)

SCALARS = {
    "boolean": "bool",
    "integer": "int",
    "number": "float",
    "object": "map",
    "string": "string",
}


def kind(schema: dict[str, Any]) -> str:
    """A type in a few words; what may be nil says so."""
    if "anyOf" in schema:
        return " or ".join(kind(option) for option in schema["anyOf"])
    if "$ref" in schema:
        name = schema["$ref"].rpartition("/")[2]
        return f"[{name}](#{name.lower()})"
    found = schema.get("type", "any")
    names = found if isinstance(found, list) else [found]
    return " or ".join(_named(name, schema) for name in names)


def _named(name: str, schema: dict[str, Any]) -> str:
    if name == "array":
        item = kind(schema["items"])
        return f"array of ({item})" if " or " in item else f"array of {item}"
    if name == "null":
        return "nil"
    return SCALARS.get(name, name)


def _text(schema: dict[str, Any]) -> str:
    text: str = schema["description"]
    return text.replace("\n", " ").replace("\\[", "[").replace("\\]", "]")


def _fields(schema: dict[str, Any]) -> str:
    properties = schema.get("properties", {})
    required = schema.get("required", [])
    rows = [
        [f"`{name}`" if name in required else f"`{name}`?", kind(field), _text(field)]
        for name, field in sorted(properties.items(), key=lambda item: item[0] not in required)
    ]
    return f"\n{markdown(['field', 'type', 'meaning'], rows)}" if rows else ""


def _message(name: str, schema: dict[str, Any]) -> str:
    head = f"### {name}\n\n{_text(schema)}\n"
    if "oneOf" not in schema:
        return head + _fields(schema)
    rows = [[f"`{option['const']}`", _text(option)] for option in schema["oneOf"]]
    return f"{head}\n{markdown(['kind', 'meaning'], rows)}"


def tables() -> str:
    """All operations and messages, in Markdown."""
    protocol = json.loads(server_protocol())
    rows = [
        [f"`{row['name']}`", row["does"], _link(row["request"]), _link(row["reply"])]
        for row in protocol["operations"]
    ]
    messages = {**protocol["requests"], **protocol["replies"]}
    parts = [
        f"\n## Operations\n\n{markdown(['operation', 'does', 'request', 'reply'], rows)}",
        "\n## Messages\n\nA field with a question mark may be left out.\n",
        *(f"\n{_message(name, schema)}" for name, schema in messages.items()),
    ]
    return "".join(parts) + "\n"


def _link(name: str) -> str:
    return f"[{name}](#{name.lower()})"


def filled(page: str) -> str:
    """The page with its tables made anew."""
    return BLOCK.sub(lambda found: found[1] + tables() + found[3], page, count=1)


if __name__ == "__main__":
    write_file(PAGE, filled(PAGE.read_text(encoding="utf-8")))
