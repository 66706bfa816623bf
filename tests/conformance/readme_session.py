"""The session in README.md works as printed: its commands, against the demo plant on a port of its own, give its numbers.

Lines that begin with "$ " are run as one bash script; every number that the README shows for a register must come within
the live tolerance.
"""
import os
import re
import subprocess

from plant import Plant

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
REGISTER = re.compile(r"^\[(\d+)\]:\s+(\d+)", re.MULTILINE)
TOLERANCE = 0.05
RESOLUTION = 30  # of a number near zero; registers count in hundredths and tenths


def read(path):
    with open(os.path.join(ROOT, path), encoding="utf-8") as f:
        return f.read()


def main():
    session = re.search(r"<!-- session -->\n```console\n(.*?)^```", read("README.md"), re.MULTILINE | re.DOTALL).group(1)
    script = "\n".join(line[2:] for line in session.splitlines() if line.startswith("$ "))
    shown = REGISTER.findall(session)
    assert shown, "the session shows no register"
    demo = re.sub(r"(127\.0\.0\.1):1502", r"\1:0", read("scenarios/plants/demo.yaml"))
    with Plant(demo) as plant:
        endpoint = plant.ready["drives"][0]["endpoints"][0]
        assert endpoint["protocol"] == "modbus-tcp" and endpoint["unit"] == 1, endpoint
        assert "-p 1502" in script
        script = script.replace("-p 1502", f"-p {endpoint['port']}")
        done = subprocess.run(["bash", "-e"], input=script, capture_output=True, text=True, timeout=120)
        print(done.stdout, done.stderr)
        assert done.returncode == 0, done.returncode
        seen = REGISTER.findall(done.stdout)
        assert [a for a, _ in seen] == [a for a, _ in shown], (seen, shown)
        for (address, expected), (_, got) in zip(shown, seen):
            assert abs(int(got) - int(expected)) <= max(RESOLUTION, TOLERANCE * int(expected)), (address, expected, got)


if __name__ == "__main__":
    main()
