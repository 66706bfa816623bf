"""The sessions in README.md work as printed: their commands, against the demo plant on ports and addresses of its own, give
their output.

Lines that begin with "$ " are run as one bash script. On Modbus every number that the README shows must come again within
the live tolerance; the EtherNet/IP scanner must print the same lines.
"""
import os
import re
import subprocess

from plant import HERE, Plant

ROOT = os.path.join(HERE, "..", "..")
NUMBER = re.compile(r"^(\[\d+\]:|  \w+) +\t?([\d.]+)", re.MULTILINE)
TOLERANCE = 0.05
ON_THE_RAMP = 0.25  # the first number is taken on the ramp, and a busy machine starts the shell's commands late


def read(path):
    with open(os.path.join(ROOT, path), encoding="utf-8") as f:
        return f.read()


def block(before, language):
    """What stands in the code block of this language that follows the text before."""
    found = re.search(re.escape(before) + r"\n+```" + language + r"\n(.*?)^```", read("README.md"), re.MULTILINE | re.DOTALL)
    assert found, f"README.md has no {language} block after {before!r}"
    return found.group(1)


def script_and_output(session):
    lines = session.splitlines()
    script = "\n".join(line[2:] for line in lines if line.startswith("$ "))
    return script, "\n".join(line for line in lines if not line.startswith("$ "))


def run(plant, script, **more):
    done = subprocess.run(["bash", "-e", "-o", "pipefail"], input=script, capture_output=True, text=True, timeout=120,
                          env=plant.environment() | more, cwd=plant.folder)
    print(done.stdout, done.stderr)
    assert done.returncode == 0, done.returncode
    return done.stdout


def modbus(plant):
    session = block("<!-- session -->", "console")
    script, _ = script_and_output(session)
    shown = NUMBER.findall(session)
    assert shown, "the session shows no number"
    endpoint = plant.endpoint("conveyor_1", "modbus-tcp")
    assert f"-p 1502 -a {endpoint['unit']} " in script, endpoint
    seen = NUMBER.findall(run(plant, script.replace("-p 1502", f"-p {endpoint['port']}")
                              .replace("build/run/vinverter", '"$VINVERTER"')))
    assert [a for a, _ in seen] == [a for a, _ in shown], (seen, shown)
    for i, ((name, expected), (_, got)) in enumerate(zip(shown, seen)):
        tolerance = TOLERANCE if i > 0 else ON_THE_RAMP
        assert abs(float(got) / float(expected) - 1) <= tolerance, (name, expected, got)


def ethernet_ip(plant, master):
    program = block("in the same folder `node mixer.js`):", "js")
    script, shown = script_and_output(block("<!-- ethernet-ip session -->", "console"))
    host = plant.endpoint("mixer_1", "ethernet-ip")["host"]
    assert '"127.0.0.1"' in program and '"127.0.0.2"' in program
    with open(os.path.join(plant.folder, "mixer.js"), "w", encoding="utf-8") as f:
        f.write(program.replace("127.0.0.1", master).replace("127.0.0.2", host))
    seen = run(plant, script, NODE_PATH=os.path.join(HERE, "node_modules"))
    assert seen.strip("\n") == shown.strip("\n"), (seen, shown)
    assert plant.ctl("mixer_1", "status")["alarm"] is None, "a Forward_Close is no line error"


def main():
    demo = re.sub(r"(127\.0\.0\.1):(1502|29536)", r"\1:0", read("scenarios/plants/demo.yaml"))
    # Another plant may be at the address meanwhile.
    own = os.getpid()
    network = f"127.{200 + own // 126 // 256 % 50}.{own // 126 % 256}"
    host = own % 126 * 2 + 1
    adapter, master = f"{network}.{host}", f"{network}.{host + 1}"
    with Plant(demo.replace("address: 127.0.0.2", f"address: {adapter}")) as plant:
        modbus(plant)
        ethernet_ip(plant, master)


if __name__ == "__main__":
    main()
