"""The JSON Schema accepts the shipped campaigns and refuses what the loader refuses."""
import glob
import sys

ROOT = sys.argv[1]
sys.path.insert(0, ROOT + "/tests")
import schema_check  # noqa: E402 (its folder is an argument)

SCHEMA, SCENARIO, PLANT = (
    schema_check.load(f"{ROOT}/docs/{n}.schema.json") for n in ("campaign", "scenario", "scenario-plant"))
SCHEMA["definitions"].update(SCENARIO.pop("definitions"))
for schema, key, ref, part in ((SCENARIO, "plant", "scenario-plant", PLANT), (SCHEMA, "scenario", "scenario", SCENARIO)):
    forms = schema["properties"][key]["anyOf"]
    forms[forms.index({"$ref": ref + ".schema.json"})] = part

# Entries of variations.
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
EXTRA = ["measure: { a: {} }", "measure: { a: { maximum: x, minimum: x } }", "sead: 1"]


def campaign(variation, extra=""):
    return f"scenario: s.yaml\n{extra}\nvariations:\n  {variation}\n"


schema_check.check(SCHEMA, sorted(glob.glob(ROOT + "/scenarios/campaigns/*.yaml")),
                   [campaign(v) for v in BAD] + [campaign("- grid: { a: [1] }", e) for e in EXTRA],
                   [campaign(v) for v in GOOD] + [campaign("- grid: { a: [1] }")])
