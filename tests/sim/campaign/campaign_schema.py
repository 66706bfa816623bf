"""The JSON Schema accepts the shipped campaigns and refuses what the loader refuses. Needs python3-jsonschema, python3-yaml."""
import glob
import json
import sys

import jsonschema
import yaml

ROOT = sys.argv[1]


def load(name):
    with open(f"{ROOT}/docs/{name}.schema.json", encoding="utf-8") as f:
        return json.load(f)


SCHEMA, SCENARIO, PLANT = load("campaign"), load("scenario"), load("scenario-plant")
SCHEMA["definitions"].update(SCENARIO.pop("definitions"))
for schema, key, ref, part in ((SCENARIO, "plant", "scenario-plant", PLANT), (SCHEMA, "scenario", "scenario", SCENARIO)):
    forms = schema["properties"][key]["anyOf"]
    forms[forms.index({"$ref": ref + ".schema.json"})] = part
jsonschema.Draft7Validator.check_schema(SCHEMA)
VALIDATOR = jsonschema.Draft7Validator(SCHEMA)

failures = 0
campaigns = sorted(glob.glob(ROOT + "/scenarios/campaigns/*.yaml"))
assert campaigns, "no campaigns"
for path in campaigns:
    with open(path, encoding="utf-8") as f:
        for error in VALIDATOR.iter_errors(yaml.safe_load(f)):
            failures += 1
            print(f"{path}: {error.json_path}: {error.message}")

GOOD = [
    "- grid: { a: [1 s, 2], /plant/drives/pump/parameters/Pr.8: { from: 0.1, to: 5, step: 0.1 } }",
    "- { set: { a: 1 }, boundary: { b: { from: 1 s, to: 2 s } }, random: { c: [on, off] }, samples: 3 }",
]
BAD = [
    "[]",
    "- {}",
    "- gird: { a: [1] }",
    "- grid: {}",
    "- grid: { a: 5 }",
    "- grid: { a: [] }",
    "- grid: { a: { from: 1, to: 2 } }",
    "- grid: { a: { from: 1, to: 2, count: 3, step: 1 } }",
    "- grid: { a: { from: 1, count: 3 } }",
    "- grid: { a: { from: 1, to: 2, count: 3, spacing: log } }",
    "- grid: { 'a//b': [1] }",
    "- random: { a: [1] }",
    "- { grid: { a: [1] }, samples: 3 }",
    "- { random: { a: [1] }, samples: 0 }",
]
for wanted, texts in ((True, GOOD), (False, BAD)):
    for text in texts:
        if VALIDATOR.is_valid({"scenario": "s.yaml", "variations": yaml.safe_load(text)}) != wanted:
            failures += 1
            print(f"{'refused' if wanted else 'accepted'}: {text}")
for extra in ({"measure": {"a": {}}}, {"measure": {"a": {"maximum": "x", "minimum": "x"}}}, {"sead": 1}):
    if VALIDATOR.is_valid({"scenario": "s.yaml", "variations": [{"grid": {"a": [1]}}], **extra}):
        failures += 1
        print(f"accepted: {extra}")
sys.exit(1 if failures else 0)
