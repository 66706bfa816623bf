"""The JSON Schema accepts the shipped plant files and refuses what the loader refuses."""
import glob
import sys

ROOT = sys.argv[1]
sys.path.insert(0, ROOT + "/tests")
import schema_check  # noqa: E402 (its folder is an argument)

SCHEMA = schema_check.load(ROOT + "/docs/plant.schema.json")

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
    "drives: [{ board: { address: localhost } }]",
    "drives: [{ board: { address: 127.0.0 } }]",
    "drives: [{ board: { link_partner: 1000_full } }]",
    "drives: [{ board: { connector: 4 } }]",
    "drives: [{ board: { lease: { adress: 10.0.0.1 } } }]",
    "drives: [{ board: { flash: { dhcp: maybe } } }]",
    "drives: [{ power: maybe }]",
    "drives: [{ solver: euler }]",
    "drives: [{ terminals: { STF: 1 } }]",
    "drives: [{ parameters: { Pr.7: fast } }]",
    "{ networks: { hall: {} }, drives: [{}] }",
    "{ networks: { hall: { serial: COM1 } }, drives: [{}] }",
]
schema_check.check(SCHEMA, sorted(glob.glob(ROOT + "/scenarios/plants/*.yaml")), BAD)
