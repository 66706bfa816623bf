"""The JSON Schema accepts the shipped scenarios and refuses what the loader refuses."""
import glob
import sys

ROOT = sys.argv[1]
sys.path.insert(0, ROOT + "/tests")
import schema_check  # noqa: E402 (its folder is an argument)

SCHEMA = schema_check.load(ROOT + "/docs/scenario.schema.json")
forms = SCHEMA["properties"]["plant"]["anyOf"]
assert {"$ref": "plant.schema.json"} in forms
forms[forms.index({"$ref": "plant.schema.json"})] = schema_check.load(ROOT + "/docs/plant.schema.json")

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
SCENARIOS = sorted(glob.glob(ROOT + "/scenarios/**/*.yaml", recursive=True))
NOT_SCENARIOS = ("/plants/", "/campaigns/")
schema_check.check(SCHEMA, [p for p in SCENARIOS if not any(n in p for n in NOT_SCENARIOS)], BAD)
