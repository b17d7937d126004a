#!/usr/bin/env python3
"""Prints the page of a JSON Schema in Markdown: a table of keys, types and meanings for every object.

    schema_page.py SCHEMA

All words come from the "description" of the schema; a key without one is an error.
"""

import json
import pathlib
import sys


def kind_of(schema, part):
    """The type of a value in words: `number or null`, `array of gate`, `"ok", "check"`."""
    if "$ref" in part:
        referred = schema["$defs"][name_of(part)]
        return f"[{name_of(part)}](#{name_of(part)})" if "properties" in referred else kind_of(schema, referred)
    if "anyOf" in part or "oneOf" in part:
        return " or ".join(kind_of(schema, choice) for choice in part.get("anyOf") or part["oneOf"])
    if "const" in part:
        return f"`{json.dumps(part['const'])}`"
    if "enum" in part:
        return ", ".join(f"`{json.dumps(value)}`" for value in part["enum"])
    types = part.get("type", "any value")
    words = " or ".join(sorted(types, key="array".__eq__)) if isinstance(types, list) else types
    return f"{words} of {kind_of(schema, part['items'])}" if isinstance(part.get("items"), dict) else words


def name_of(part):
    return part["$ref"].rsplit("/", 1)[-1]


def meaning_of(schema, key, part):
    """The words of a key, or of what it refers to."""
    referred = schema.get("$defs", {}).get(name_of(part), {}) if "$ref" in part else {}
    choices = part.get("anyOf") or part.get("oneOf") or []
    words = [part.get("description"), referred.get("description"), *(meaning_of(schema, "", choice) for choice in choices)]
    found = next((text for text in words if text), "")
    if key and not found:
        raise SystemExit(f"{schema['title']}: '{key}' has no description")
    return found.replace("|", "\\|")


def table(schema, part):
    rows = [f"| `{key}` | {kind_of(schema, value)} | {meaning_of(schema, key, value)} |"
            for key, value in part["properties"].items()]
    return ["| key | type | meaning |", "|---|---|---|", *rows, ""]


def page(schema):
    lines = [f"# Schema {schema['title']}", "", schema["description"], "", *table(schema, schema)]
    for name, part in schema.get("$defs", {}).items():
        if "properties" not in part:
            continue
        lines += [f"## {name}", "", part.get("description", ""), "", *table(schema, part)]
    return "\n".join(lines)


if __name__ == "__main__":
    print(page(json.loads(pathlib.Path(sys.argv[1]).read_text())))
