"""All rows of docs/decisions/0009-ethernet-ip-speed.md in one go, against the product: `vinverter run` with plants of
FR-A700s that stand still. For an idle machine; it takes about five minutes, and says how busy the machine was.

Usage: all_rows.py VINVERTER ENIP_BENCH [--json FILE] [--quick] [--real-time]
  --quick      each row for a moment, to see that it works
  --real-time  SCHED_FIFO for server and benchmark, on a machine that has other work: what else runs then takes no time
               slices from them, but for the floods. Without it they get priority -15 where that is allowed.
"""
import argparse
import contextlib
import ipaddress
import json
import os
import signal
import subprocess
import sys
import tempfile
import time

FIRST = "127.91.1.1"
OWN = "127.0.0.1"


def arguments():
    parser = argparse.ArgumentParser(description="All rows of the EtherNet/IP benchmarks against `vinverter run`")
    parser.add_argument("vinverter")
    parser.add_argument("bench")
    parser.add_argument("--json")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--real-time", action="store_true")
    return parser.parse_args()


def plant(count):
    first = int(ipaddress.IPv4Address(FIRST))
    drives = "".join(
        f"  - name: d{i}\n"
        "    inverter: { family: fr-a700, model: FR-A740-1.5K }\n"
        "    motor: { preset: iec4p_1k5kW_400V }\n"
        f"    board: {{ type: fr-a7ne, address: {ipaddress.IPv4Address(first + i)} }}\n" for i in range(count))
    return f"name: bench_{count}\ndrives:\n{drives}"


@contextlib.contextmanager
def server(vinverter, count):
    """A running plant of so many drives; gives its process id."""
    with tempfile.TemporaryDirectory() as folder:
        paths = {name: os.path.join(folder, name) for name in ("plant.yaml", "ready.json", "state", "runtime", "log")}
        with open(paths["plant.yaml"], "w", encoding="utf-8") as f:
            f.write(plant(count))
        began = time.monotonic()
        with open(paths["log"], "w+", encoding="utf-8") as log, subprocess.Popen(
                [vinverter, "run", paths["plant.yaml"], "--fresh", "--ready-file", paths["ready.json"],
                 "--state-dir", paths["state"], "--runtime-dir", paths["runtime"]],
                stdout=log, stderr=subprocess.STDOUT) as process:
            try:
                while not os.path.exists(paths["ready.json"]):
                    if process.poll() is not None or time.monotonic() > began + 60:
                        log.seek(0)
                        sys.exit(f"the plant does not start:\n{log.read()}")
                    time.sleep(0.02)
                print(f"\n{count} drives, ready after {time.monotonic() - began:.1f} s", flush=True)
                yield process.pid
            finally:
                process.send_signal(signal.SIGINT)
                process.wait(20)
                log.seek(0)
                late = [line for line in log if "late by" in line]
                print("server:", *late, end="\n" if not late else "", flush=True)


def cpu_seconds(pid):
    with open(f"/proc/{pid}/stat", encoding="utf-8") as f:
        fields = f.read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def main():
    options = arguments()
    with contextlib.suppress(PermissionError):
        os.nice(-15)
    seconds, rounds = (0.1, 1) if options.quick else (2, 3)
    results = {"load_before": os.getloadavg(), "rows": []}
    print(f"load average before: {os.getloadavg()}, {os.cpu_count()} processors")

    def run(what, pid, drives, *extra):
        with tempfile.NamedTemporaryFile("r", suffix=".json") as out:
            subprocess.run([options.bench, what, "--host", FIRST, "--own", OWN, "--pid", str(pid), "--json", out.name, *extra],
                           check=True)
            results["rows"].append({"drives": drives, "load": os.getloadavg()[0], **json.load(out)})

    def io(pid, drives, *rpi_us):
        run("io", pid, drives, "--adapters", str(drives), "--rpi-us", ",".join(map(str, rpi_us)), "--seconds", str(seconds),
            "--rounds", str(rounds))

    with server(options.vinverter, 2) as pid:
        run("flood", pid, 2, "--rpi-us", "2000", "--seconds", str(seconds), "--rounds", "1")
    if options.real_time:  # not before the floods: the kernel stops such processes when they take all there is
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(1))
    with server(options.vinverter, 1) as pid:  # which is pinned to one processor by this
        run("explicit", pid, 1, "--connections", "1,16,64", "--rounds", "1" if options.quick else "21", "--seconds",
            str(0.1 if options.quick else 0.3))
    for drives in (1, 16, 64, 128):
        with server(options.vinverter, drives) as pid:
            before, moment = cpu_seconds(pid), 0.2 if options.quick else 5
            time.sleep(moment)
            idle = 100 * (cpu_seconds(pid) - before) / moment / drives
            print(f"without clients: {idle:.2f} % of a core per drive", flush=True)
            results["rows"].append({"drives": drives, "idle_cpu_percent_per_drive": idle})
            io(pid, drives, 1000, 2000, 10000)
    with server(options.vinverter, 256) as pid:
        before, began = cpu_seconds(pid), time.monotonic()
        time.sleep(1 if options.quick else 5)
        share = 100 * (cpu_seconds(pid) - before) / (time.monotonic() - began)
        print(f"without clients: {share:.0f} % of a core", flush=True)
        results["rows"].append({"drives": 256, "idle_cpu_percent_per_drive": share / 256})
    results["load_after"] = os.getloadavg()
    print(f"load average after: {os.getloadavg()}")
    if options.json:
        with open(options.json, "w", encoding="utf-8") as f:
            json.dump(results, f, indent=2)


main()
