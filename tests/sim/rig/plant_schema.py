"""The JSON Schema accepts the shipped plant files and refuses what the loader refuses. Needs python3-jsonschema, python3-yaml."""
import glob
import json
import sys

import jsonschema
import yaml

ROOT = sys.argv[1]
with open(ROOT + "/docs/plant.schema.json", encoding="utf-8") as f:
    SCHEMA = json.load(f)
jsonschema.Draft7Validator.check_schema(SCHEMA)
VALIDATOR = jsonschema.Draft7Validator(SCHEMA)

failures = 0
plants = sorted(glob.glob(ROOT + "/scenarios/plants/*.yaml"))
assert plants, "no plant files"
for path in plants:
    with open(path, encoding="utf-8") as f:
        for error in VALIDATOR.iter_errors(yaml.safe_load(f)):
            failures += 1
            print(f"{path}: {error.message}")

BAD = [
    "drives: []",
    "name: a",
    "drives: [{ invertor: {} }]",
    "drives: [{ name: ../etc }]",
    "drives: [{ inverter: { model: FR-E540-1.5 } }]",
    "drives: [{ load: { inertia_kg_m2: 0.02 kg m2 } }]",
    "drives: [{ load: { torque: 9 } }]",
    "drives: [{ motor: { R_s_ohm: -1 } }]",
    "drives: [{ board: { node: 0 } }]",
    "drives: [{ board: { node: 1.5 } }]",
    "drives: [{ board: some }]",
    "drives: [{ power: maybe }]",
    "drives: [{ solver: euler }]",
    "drives: [{ terminals: { STF: 1 } }]",
    "drives: [{ parameters: { Pr.7: fast } }]",
    "{ networks: { hall: {} }, drives: [{}] }",
    "{ networks: { hall: { serial: COM1 } }, drives: [{}] }",
]
for text in BAD:
    if VALIDATOR.is_valid(yaml.safe_load(text)):
        failures += 1
        print(f"accepted: {text}")
sys.exit(1 if failures else 0)
