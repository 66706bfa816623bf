#!/usr/bin/env python3
"""docs/scenario-plant.schema.json is docs/plant.schema.json where $name and ${expression} may stand for any value.

Compares them; with --write writes it anew.
"""
import json
import pathlib
import sys

DOCS = pathlib.Path(sys.argv[1]) / "docs"
VARIABLE = {"type": "string", "pattern": "\\$"}
ABOUT = ("title", "description", "default")
SCALARS = ("number", "integer", "boolean")


def is_narrow(schema):
    """Refuses some text."""
    return schema.get("type") in SCALARS or any(k in schema for k in ("enum", "const", "pattern"))


def with_variables(schema):
    if not isinstance(schema, dict):
        return schema
    if is_narrow(schema):
        about = {k: v for k, v in schema.items() if k in ABOUT}
        return {**about, "anyOf": [{k: v for k, v in schema.items() if k not in ABOUT}, VARIABLE]}
    out = dict(schema)
    for key in ("properties", "patternProperties"):
        if key in out:
            out[key] = {name: with_variables(part) for name, part in out[key].items()}
    for key in ("additionalProperties", "items", "propertyNames"):
        if key in out:
            out[key] = with_variables(out[key])
    if "patternProperties" in out:
        out["patternProperties"]["\\$"] = True
    # The others of a network say which keys go together.
    if "oneOf" in out and "properties" not in out:
        out["oneOf"] = [with_variables(part) for part in out["oneOf"]]
    return out


def main():
    plant = json.loads((DOCS / "plant.schema.json").read_text(encoding="utf-8"))
    plant["title"] = "plant of a vinverter scenario"
    plant["description"] = "As a plant file, with variables. Made from plant.schema.json."
    text = json.dumps(with_variables(plant), indent=1) + "\n"
    path = DOCS / "scenario-plant.schema.json"
    if "--write" in sys.argv:
        path.write_text(text, encoding="utf-8")
    elif path.read_text(encoding="utf-8") != text:
        print(f"{path} is not what plant.schema.json says; run {sys.argv[0]} {sys.argv[1]} --write")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
