"""vinverter campaign from a shell: exit codes, where output goes, what cannot be written."""
import os
import sys
import tempfile
import xml.etree.ElementTree as ElementTree

VINVERTER, ROOT = sys.argv[1:3]
sys.path.insert(0, ROOT + "/tests")
import cli_check  # noqa: E402 (its folder is an argument)
from cli_check import expect  # noqa: E402
SCENARIO = """# Speeds.
scenario:
  plant: { drives: [{ inverter: { model: FR-E540-0.75K }, load: { inertia_kg_m2: 0.002 }, parameters: { Pr.7: 0.1 } }] }
  limit: 5 s
  variables: { speed: 5 Hz }
  steps:
    - { when: ready, reference: $speed }
    - { after: 100 ms, run: forward }
    - { when: at_reference, within: 2 s }
    - check: { output_frequency: below 10.2 Hz }
variations:
"""


def run(*args, command="campaign", cwd=None):
    return cli_check.run(VINVERTER, command, *args, timeout=100, cwd=cwd)


with tempfile.TemporaryDirectory() as folder:
    def write(name, text):
        with open(f"{folder}/{name}", "w", encoding="utf-8") as f:
            f.write(text)
        return f"{folder}/{name}"

    good = write("good.yaml", SCENARIO + "  - grid: { speed: [5 Hz, 6 Hz, 7 Hz] }\n")
    bad = write("bad.yaml", SCENARIO + "  - grid: { speed: [5 Hz, 20 Hz] }\n")
    broken = write("broken.yaml", SCENARIO + "  - grid: { sped: [5 Hz] }\n")
    unusable = write("unusable.yaml", SCENARIO + "  - grid: { speed: [5 Hz, 5000 Hz, 5 s] }\n")
    out = folder + "/results"

    code, text, err = run("check", good)
    expect((code, text, err) == (0, "3 cases\n", ""), f"check: {code} {text} {err}")
    code, text, err = run("check", broken)
    expect(code == 2 and err.startswith(broken + ":12:13: the scenario has no variable \"sped\"") and err.count("\n") == 1, f"mistakes: {code} {err}")
    code, text, err = run("list", good, "--shard", "2/2")
    expect((code, text) == (0, "2  speed = 6 Hz\n"), f"list: {code} {text}")
    code, text, err = run("run", good, "--out", out, "--shard", "0/2")
    expect(code == 2 and "write i/n" in err, f"a bad shard is 2: {code} {err}")

    code, text, err = run("run", good, "--out", out, "--shard", "1/2")
    expect(code == 0 and "shard 1/2: 2 of 3 cases: 2 passed" in text and err == "", f"a shard: {code} {text} {err}")
    code, text, err = run("missing", good, "--out", out)
    expect((code, text, err) == (1, "2\n", "1 cases have no result\n"), f"missing: {code} {text} {err}")
    code, text, err = run("merge", good, "--out", out)
    expect(code == 2 and "2 passed, 0 failed, 0 could not run, 0 crashed, 1 without result" in text, f"merge too early: {code} {text} {err}")
    code, text, err = run("run", good, "--out", out, "--shard", "2/2")
    code, text, err = run("missing", good, "--out", out)
    expect((code, text) == (0, ""), f"nothing missing: {code} {text}")
    code, text, err = run("merge", good, "--out", out)
    expect(code == 0 and "3 cases: 3 passed" in text, f"merge: {code} {text} {err}")
    expect(sorted(os.listdir(out)) == ["good.csv", "good.html", "good.junit.xml", "good.shard-1-of-2.jsonl", "good.shard-2-of-2.jsonl"],
           f"files: {os.listdir(out)}")
    expect(ElementTree.parse(out + "/good.junit.xml").getroot().get("tests") == "3", "JUnit")
    code, text, err = run("merge", good, "--out", out, "--csv", folder + "/nowhere/x.csv")
    expect(code == 2 and f"{folder}/nowhere/x.csv cannot be written: No such file or directory." in err and "good.html" in text,
           f"one file that cannot be written: {code} {text} {err}")
    for option, lost in (("--junit", "good.junit.xml"), ("--html", "good.html"), ("--csv", "good.csv")):
        others = {"good.csv", "good.html", "good.junit.xml"} - {lost}
        for name in others:
            os.remove(f"{out}/{name}")
        code, text, err = run("merge", good, "--out", out, option, "/dev/full")
        expect(code == 2 and "/dev/full cannot be written: No space left on device." in err, f"{lost} does not fit: {code} {err}")
        expect(all(f"{out}/{name}\n" in text and os.path.getsize(f"{out}/{name}") > 100 for name in others) and "3 passed" in text,
               f"the others than {lost}: {text}")
    code, text, err = run("run", good, "--out", "/dev/null/x")
    expect(code == 2 and err == "vinverter: /dev/null/x cannot be made: Not a directory.\n", f"no folder: {code} {err}")

    # A shard without room tells so once; what others have found stays, and what it lacks is run later.
    small = folder + "/small"
    code, text, err = run("run", good, "--out", small, "--shard", "1/2")
    os.symlink("/dev/full", small + "/good.shard-2-of-2.jsonl")
    code, text, err = run("run", good, "--out", small, "--shard", "2/2")
    expect(code == 2 and err.count("cannot be written: No space left on device.") == 1 and "1 without result" in text, f"full: {code} {text} {err}")
    code, text, err = run("missing", good, "--out", small)
    expect((code, text) == (1, "2\n"), f"missing after a full disk: {code} {text} {err}")
    code, text, err = run("merge", good, "--out", small)
    expect(code == 2 and "2 passed, 0 failed, 0 could not run, 0 crashed, 1 without result" in text, f"merged after a full disk: {code} {text}")
    os.remove(small + "/good.shard-2-of-2.jsonl")
    code, text, err = run("run", good, "--out", small)
    expect(code == 0 and "2 had one before" in text, f"room again: {code} {text} {err}")

    code, text, err = run("run", bad, "--out", out)
    expect(code == 1 and "FAILED   case 2  speed = 20 Hz" in text and "seen 20 Hz" in text, f"a failure is 1: {code} {text} {err}")
    code, text, err = run("run", unusable, "--out", out)
    expect(code == 2 and "NOT RUN  case 3" in text and "unusable_case_3.yaml:" in text, f"an impossible value is 2: {code} {text} {err}")

    code, text, err = run("repro", bad, "2", cwd=folder)
    expect((code, text) == (0, "bad_case_2.yaml\n"), f"repro: {code} {text} {err}")
    code, text, err = run("run", "bad_case_2.yaml", command="scenario", cwd=folder)
    expect(code == 1 and "seen      20 Hz" in text, f"the plain scenario fails too: {code} {text} {err}")
    code, text, err = run("repro", bad, "2", "-o", "/dev/full")
    expect(code == 2 and "/dev/full cannot be written: No space left on device." in err, f"repro to a full disk: {code} {err}")
    code, text, err = run("repro", bad, "3")
    expect(code == 2 and "there is no case 3; allowed: 1 to 2." in err, f"no such case: {code} {err}")
    code, text, err = run("shrink", bad, "2", "-o", "-")
    expect(code == 0 and "output_frequency" in text and "limit" not in text and "Pr.7" not in text, f"shrink: {code} {text} {err}")
    code, text, err = run("shrink", bad, "1")
    expect(code == 2 and "case 1 passes" in err, f"nothing to shrink: {code} {err}")
    code, text, err = run("schema")
    expect(code == 0 and '"vinverter campaign"' in text and "schema.json\"" not in text.replace("draft-07/schema", ""), "schema is in one piece")
cli_check.finish()
