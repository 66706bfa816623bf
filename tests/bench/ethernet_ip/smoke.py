"""That the EtherNet/IP benchmarks work: each runs for a moment and gives numbers. How large they are is not looked at.

Usage: smoke.py ENIP_BENCH ENIP_LOCAL_SERVER
"""
import json
import os
import subprocess
import sys
import tempfile

bench, server = sys.argv[1:]
pid = os.getpid()
own, host = (f"127.{128 + (pid >> 8) % 100}.{pid % 256}.{last}" for last in (200, 1))

with tempfile.TemporaryDirectory() as folder, \
        subprocess.Popen([server, host, "2"], stdout=subprocess.PIPE, text=True) as process:
    try:
        assert process.stdout.readline() == "ready\n"

        def run(what, *options):
            path = os.path.join(folder, what + ".json")
            subprocess.run([bench, what, "--host", host, "--own", own, "--pid", str(process.pid), "--json", path, *options],
                           check=True, timeout=60)
            with open(path, encoding="utf-8") as f:
                return json.load(f)[what]

        rates = run("explicit", "--connections", "1,4", "--rounds", "2", "--seconds", "0.1", "--cpu", "-1")
        assert [r["connections"] for r in rates] == [1, 4]
        assert all(r["server_per_s"] > 0 and r["echo_per_s"] > 0 and r["ratio"] > 0 for r in rates)
        rows = run("io", "--adapters", "1,2", "--rpi-us", "10000", "--rounds", "1", "--seconds", "0.3")
        assert [r["adapters"] for r in rows] == [1, 2]
        assert all(r[side]["got_share"] > 0 for r in rows for side in ("server", "sender"))
        floods = run("flood", "--kinds", "garbage,udp-2222", "--rounds", "1", "--seconds", "0.3", "--rpi-us", "10000")
        assert all(r["during"]["got_share"] > 0 and r["attacks_per_s"] > 0 for r in floods)
    finally:
        process.terminate()
