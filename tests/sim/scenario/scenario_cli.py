"""vinverter scenario from a shell: exit codes, where output goes, reports that cannot be written."""
import os
import sys
import tempfile
import xml.etree.ElementTree as ElementTree

VINVERTER, ROOT = sys.argv[1:3]
sys.path.insert(0, ROOT + "/tests")
import cli_check  # noqa: E402 (its folder is an argument)
from cli_check import expect  # noqa: E402
GOOD = ROOT + "/scenarios/fr-e500/multi_speed.yaml"
BROKEN = ROOT + "/tests/sim/scenario/broken/unknown_word.yaml"


def run(*args, cwd=ROOT):
    return cli_check.run(VINVERTER, "scenario", *args, timeout=60, cwd=cwd)


with tempfile.TemporaryDirectory() as folder:
    failing = folder + "/failing.yaml"
    with open(failing, "w", encoding="utf-8") as f:
        f.write("# Fails.\nplant: { drives: [{}] }\nsteps:\n  - { when: ready, check: { mode: PU } }\n")
    live = folder + "/live.yaml"
    with open(live, "w", encoding="utf-8") as f:
        f.write("# Live.\nplant: { name: scenario_cli_test, drives: [{ board: { modbus_tcp: '127.0.0.1:0', network: none } }] }\n"
                "limit: 10 s\ntolerance: { time: 1 s }\nsteps:\n  - { when: ready, within: 3 s, check: { mode: EXT } }\n")
    # An owner, and somebody who listens to the same multicast, on sockets of this machine.
    live_io = folder + "/live_io.yaml"
    pid = os.getpid()
    address = f"127.{130 + pid // 256 % 60}.{pid % 256}.2"
    with open(live_io, "w", encoding="utf-8") as f:
        f.write("# Live.\nplant:\n  name: scenario_cli_io_test\n  drives:\n    - inverter: { family: fr-a700, model: FR-A740-1.5K }\n"
                f"      board: {{ address: {address} }}\n      parameters: {{ Pr.7: 0.2, Pr.8: 0.2, Pr.340: 1 }}\n"
                "limit: 30 s\ntolerance: { time: 5 s }\nsteps:\n  - { when: ready, within: 5 s }\n"
                "  - { via: ethernet-ip-second, open: { role: listen_only, multicast: on, extended: 0x0119 } }\n"
                "  - { via: ethernet-ip, open: { multicast: on, multiplier: 64 } }\n"
                "  - { via: ethernet-ip-second, open: { multicast: on, extended: 0x0106 } }\n"
                "  - { via: ethernet-ip-second, open: { role: listen_only, multicast: on, multiplier: 64 } }\n"
                "  - { via: ethernet-ip, reference: 20 Hz }\n  - { via: ethernet-ip, run: forward }\n"
                "  - { via: ethernet-ip-second, input: { bytes: F4 00 58 02, within: 2 s } }\n"
                "  - { via: ethernet-ip-explicit, request: { get: 0x29/1/7, answer: 01 } }\n"
                "  - { via: ethernet-ip, close: }\n"
                "  - { via: ethernet-ip-20, open: { points: 238/71, sizes: 0/4, header: off, multiplier: 64 } }\n"
                "  - { via: ethernet-ip-20, input: { bytes: 70 00 00 00, mask: 70 00 00 00 } }\n"
                "  - { via: ethernet-ip-20, close: }\n  - check: { alarm: none }\n")

    code, out, err = run("run", GOOD)
    expect(code == 0 and out.startswith("passed") and err == "", f"a passing scenario is 0: {code} {out} {err}")
    code, out, err = run("run", failing)
    expect(code == 1 and "FAILED" in out and "expected  PU" in out and "seen      EXT" in out, f"a failure is 1: {code} {out}")
    code, out, err = run("run", BROKEN, GOOD, failing)
    expect(code == 2 and "passed" in out and "1 passed, 1 failed, 1 could not run" in out, f"a broken file is 2: {code} {out}")
    expect("unknown_word.yaml:4:5:" in out and 'Did you mean "run"?' in out, f"mistakes are told: {out}")
    code, out, err = run("run", folder + "/nowhere.yaml")
    expect(code == 2 and "no file or folder" in err, f"a path that is not there is 2: {code} {err}")
    code, out, err = run("run", GOOD, "--filter", "nothing like it")
    expect(code == 2 and "there is no scenario" in err, f"an empty choice is 2: {code} {err}")

    code, out, err = run("check", GOOD)
    expect(code == 0 and out == "1 of 1 scenarios are in order\n", f"check passes: {code} {out}")
    code, out, err = run("check", BROKEN, GOOD)
    expect(code == 2 and "1 of 2" in out and "unknown_word.yaml:4:5:" in err, f"check fails: {code} {out} {err}")
    code, out, err = run("list", "scenarios/fr-e500")
    expect(code == 0 and "multi_speed.yaml" in out and "The three speeds of RH" in out, f"list has titles: {out}")
    code, out, err = run("schema")
    expect(code == 0 and '"vinverter scenario"' in out and "$ref\": \"plant" not in out, "schema is in one piece")

    junit = folder + "/junit.xml"
    code, out, err = run("run", GOOD, failing, "--junit", junit, "--report", folder + "/report", "--jobs", "2")
    root = ElementTree.parse(junit).getroot()
    expect(code == 1 and root.get("tests") == "2" and root.get("failures") == "1", "JUnit counts")
    written = os.listdir(folder + "/report")
    expect({"index.html", "fr-e500_multi_speed.html", "fr-e500_multi_speed.csv"} <= set(written), f"reports are written: {written}")

    code, out, err = run("run", GOOD, failing, "--junit", "/dev/full", "--report", "/dev/null/x")
    expect(code == 2 and "/dev/full cannot be written: No space left on device." in err, f"a full disk is told: {code} {err}")
    expect("/dev/null/x cannot be made" in err and "passed" in out and "FAILED" in out, f"no result is lost: {out} {err}")

    # A file that does not fit costs itself and nothing else: not the other files, not the next run, not the index.
    can = "scenarios/fr-e500/master_canopen.yaml"
    names = [f"fr-e500_{stem}{ending}" for stem, endings in (
        ("master_canopen", (".html", ".csv", ".states.csv", ".events.csv", ".candump.log", ".pcapng")),
        ("multi_speed", (".html", ".csv", ".states.csv", ".events.csv"))) for ending in endings] + ["index.html"]
    for n, lost in enumerate(names[:6] + ["index.html"]):
        report = f"{folder}/full{n}"
        os.mkdir(report)
        os.symlink("/dev/full", f"{report}/{lost}.new")
        code, out, err = run("run", can, GOOD, "--junit", f"{folder}/full{n}.xml", "--report", report)
        told = f"{report}/{lost}.new cannot be written: No space left on device."
        expect(code == 2 and err.count("cannot be written") == 1 and told in err, f"{lost} does not fit: {code} {err}")
        expect("2 scenarios: 2 passed" in out, f"results without {lost}: {out}")
        expect(sorted(os.listdir(report)) == sorted(set(names) - {lost}), f"the others than {lost}: {os.listdir(report)}")
        expect(ElementTree.parse(f"{folder}/full{n}.xml").getroot().get("tests") == "2", f"JUnit without {lost}")
    code, out, err = run("run", GOOD, "--junit", "/dev/full", "--report", folder + "/kept")
    expect(code == 2 and len(os.listdir(folder + "/kept")) == 5, f"reports without JUnit: {code} {err}")
    snap = folder + "/run.snap"
    talk = ROOT + "/scenarios/fr-e500/master_modbus.yaml"
    code, out, err = run("run", talk, "--snapshot-at", "1.23 s", "--snapshot", snap, "--report", folder + "/whole")
    expect(code == 0 and f"at 1.3 s in {snap}" in err, f"a run is saved at the next instant: {code} {out} {err}")
    code, out, err = run("run", talk, "--resume", snap, "--report", folder + "/resumed")
    expect(code == 0 and "passed" in out, f"a run is resumed: {code} {out} {err}")
    for name in os.listdir(folder + "/whole"):
        with open(f"{folder}/whole/{name}", "rb") as a, open(f"{folder}/resumed/{name}", "rb") as b:
            expect(a.read() == b.read(), f"{name} is the same")
    code, out, err = run("run", GOOD, "--resume", snap)
    expect(code == 2 and "the snapshot is of another plant" in out, f"another plant is told: {code} {out} {err}")
    with open(snap, "r+b") as f:
        f.seek(-100, 2)
        f.write(b"damage")
    code, out, err = run("run", talk, "--resume", snap)
    expect(code == 2 and "damaged" in err and snap in err, f"damage is told: {code} {out} {err}")
    code, out, err = run("run", talk, "--snapshot-at", "900 s", "--snapshot", snap)
    expect(code == 2 and "there is no snapshot: the run is over at" in out, f"an end before is told: {code} {out} {err}")
    code, out, err = run("run", talk, "--snapshot-at", "3", "--snapshot", snap)
    expect(code == 2 and "--snapshot-at" in err and "unit" in err, f"a time has a unit: {code} {out} {err}")
    code, out, err = run("run", talk, "--snapshot", snap)
    expect(code == 2 and "go together" in err, f"a file needs a time: {code} {out} {err}")

    code, out, err = run("run", failing, "--set", "f=3")
    expect(code == 2 and "no variable" in out, f"an unknown variable is told: {code} {out}")
    code, out, err = run("run", "--live", live)
    expect(code == 0 and "passed" in out and "Modbus/TCP" in err, f"a live run passes: {code} {out} {err}")
    code, out, err = run("run", "--live", live_io)
    expect(code == 0 and "passed" in out and "EtherNet/IP " + address in err, f"scanners do I/O in a live run: {code} {out} {err}")
cli_check.finish()
