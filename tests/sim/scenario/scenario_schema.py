"""The JSON Schema accepts the shipped scenarios and refuses what the loader refuses."""
import glob
import sys

ROOT = sys.argv[1]
sys.path.insert(0, ROOT + "/tests")
import schema_check  # noqa: E402 (its folder is an argument)

SCHEMA = schema_check.load(ROOT + "/docs/scenario.schema.json")
forms = SCHEMA["properties"]["plant"]["anyOf"]
assert {"$ref": "scenario-plant.schema.json"} in forms
forms[forms.index({"$ref": "scenario-plant.schema.json"})] = schema_check.load(ROOT + "/docs/scenario-plant.schema.json")

GOOD = [
    "{ plant: { drives: [ { inverter: { model: $m }, load: { inertia_kg_m2: $j, torque: { constant_Nm: '${t * 2}' } }, "
    "parameters: { Pr.7: $ramp, $name: 3 }, analog: { terminal_2: $u }, terminals: { STF: $on }, ideal: $ideal, "
    "board: { node: $n } } ] }, steps: [ stop ] }",
    "{ plant: { networks: { $bus: { can: virtual, bitrate: $rate } }, drives: [ { name: $d, board: $b } ] }, steps: [ stop ] }",
]
BAD = [
    "{ plant: { drives: [ { load: { inertia_kg_m2: 2 kg m2 } } ] }, steps: [ stop ] }",
    "{ plant: { drives: [ { motor_source: line } ] }, steps: [ stop ] }",
    "{ plant: { drives: [ { parameters: { Pr.7: fast } } ] }, steps: [ stop ] }",
    "{ plant: p.yaml, steps: [ { motor: line } ] }",
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
NARROW = schema_check.load(ROOT + "/docs/plant.schema.json")
assert not schema_check.accepts(NARROW, "drives: [{ ambient_C: $t }]"), "a plant file has no variables"
NOT_SCENARIOS = ("/plants/", "/campaigns/")
schema_check.check(SCHEMA, [p for p in SCENARIOS if not any(n in p for n in NOT_SCENARIOS)], BAD, GOOD)
