"""The JSON Schema accepts the shipped scenarios and refuses what the loader refuses. Needs python3-jsonschema, python3-yaml."""
import glob
import json
import sys

import jsonschema
import yaml

ROOT = sys.argv[1]
with open(ROOT + "/docs/scenario.schema.json", encoding="utf-8") as f:
    SCHEMA = json.load(f)
with open(ROOT + "/docs/plant.schema.json", encoding="utf-8") as f:
    PLANT = json.load(f)
forms = SCHEMA["properties"]["plant"]["anyOf"]
assert {"$ref": "plant.schema.json"} in forms
forms[forms.index({"$ref": "plant.schema.json"})] = PLANT
jsonschema.Draft7Validator.check_schema(SCHEMA)
VALIDATOR = jsonschema.Draft7Validator(SCHEMA)

failures = 0
scenarios = [p for p in sorted(glob.glob(ROOT + "/scenarios/**/*.yaml", recursive=True)) if "/plants/" not in p and "/campaigns/" not in p]
assert scenarios, "no scenarios"
for path in scenarios:
    with open(path, encoding="utf-8") as f:
        for error in VALIDATOR.iter_errors(yaml.safe_load(f)):
            failures += 1
            print(f"{path}: {error.json_path}: {error.message}")

BAD = [
    "steps: [ stop ]",
    "plant: p.yaml",
    "{ plant: { drivers: [] }, steps: [ stop ] }",
    "{ plant: p.yaml, steps: [] }",
    "{ plant: p.yaml, steps: forward }",
    "{ plant: p.yaml, step: [ stop ] }",
    "{ plant: p.yaml, limit: 30, steps: [ stop ] }",
    "{ plant: p.yaml, tolerance: { times: 1 s }, steps: [ stop ] }",
    "{ plant: p.yaml, steps: [ halt ] }",
    "{ plant: p.yaml, steps: [ { rum: forward } ] }",
    "{ plant: p.yaml, steps: [ { run: foward } ] }",
    "{ plant: p.yaml, steps: [ { stop: now } ] }",
    "{ plant: p.yaml, steps: [ { reference: 40 } ] }",
    "{ plant: p.yaml, steps: [ { load: { torke: 12 Nm } } ] }",
    "{ plant: p.yaml, steps: [ { after: 2, stop: null } ] }",
    "{ plant: p.yaml, steps: [ { reached: { speed: 10 rpm } } ] }",
    "{ plant: p.yaml, steps: [ { trip: { code: E.OV3 } } ] }",
    "{ plant: p.yaml, steps: [ { ramp: { signal: speed, from: 0 rpm, to: 10 rpm, time: 1 s } } ] }",
    "{ plant: p.yaml, steps: [ { repeat: { times: 3 } } ] }",
    "{ plant: p.yaml, steps: [ { phase_loss: L4 } ] }",
    "{ plant: p.yaml, steps: [ { refused: perhaps, stop: null } ] }",
]
for text in BAD:
    if VALIDATOR.is_valid(yaml.safe_load(text)):
        failures += 1
        print(f"accepted: {text}")
sys.exit(1 if failures else 0)
