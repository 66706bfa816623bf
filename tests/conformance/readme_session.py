"""The session in README.md works as printed: its commands, against the demo plant on a port of its own, give its numbers.

Lines that begin with "$ " are run as one bash script; every number that the README shows must come again within the live
tolerance.
"""
import os
import re
import subprocess

from plant import Plant

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
NUMBER = re.compile(r"^(\[\d+\]:|  \w+) +\t?([\d.]+)", re.MULTILINE)
TOLERANCE = 0.05
ON_THE_RAMP = 0.25  # the first number is taken on the ramp, and a busy machine starts the shell's commands late


def read(path):
    with open(os.path.join(ROOT, path), encoding="utf-8") as f:
        return f.read()


def main():
    session = re.search(r"<!-- session -->\n```console\n(.*?)^```", read("README.md"), re.MULTILINE | re.DOTALL).group(1)
    script = "\n".join(line[2:] for line in session.splitlines() if line.startswith("$ "))
    shown = NUMBER.findall(session)
    assert shown, "the session shows no number"
    demo = re.sub(r"(127\.0\.0\.1):(1502|29536)", r"\1:0", read("scenarios/plants/demo.yaml"))
    # Another plant may be at the address meanwhile.
    own = os.getpid()
    demo = demo.replace("address: 127.0.0.2", f"address: 127.{200 + own // 65536 % 50}.{own // 256 % 256}.{own % 254 + 1}")
    with Plant(demo) as plant:
        endpoint = plant.ready["drives"][0]["endpoints"][0]
        assert endpoint["protocol"] == "modbus-tcp" and f"-p 1502 -a {endpoint['unit']} " in script, endpoint
        script = script.replace("-p 1502", f"-p {endpoint['port']}").replace("build/run/vinverter", '"$VINVERTER"')
        done = subprocess.run(["bash", "-e", "-o", "pipefail"], input=script, capture_output=True, text=True, timeout=120,
                              env=plant.environment())
        print(done.stdout, done.stderr)
        assert done.returncode == 0, done.returncode
        seen = NUMBER.findall(done.stdout)
        assert [a for a, _ in seen] == [a for a, _ in shown], (seen, shown)
        for i, ((name, expected), (_, got)) in enumerate(zip(shown, seen)):
            tolerance = TOLERANCE if i > 0 else ON_THE_RAMP
            assert abs(float(got) / float(expected) - 1) <= tolerance, (name, expected, got)


if __name__ == "__main__":
    main()
