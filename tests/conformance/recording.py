"""tshark's opinion of a recorded wire: every request and answer is there, and none is malformed."""
import subprocess


def tshark(path, port, *options):
    done = subprocess.run(["tshark", "-n", "-r", path, "-d", f"tcp.port=={port},mbtcp", *options],
                          capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()


def check_recording(path, port, requests):
    """requests: how many the master sent and saw answered."""
    asked = tshark(path, port, "-Y", f"modbus && tcp.dstport == {port}")
    told = tshark(path, port, "-Y", f"modbus && tcp.srcport == {port}")
    broken = tshark(path, port, "-Y", "_ws.malformed || _ws.unreassembled || tcp.analysis.lost_segment || "
                                      "tcp.checksum.status == Bad || ip.checksum.status == Bad",
                    "-o", "tcp.check_checksum:TRUE", "-o", "ip.check_checksum:TRUE")
    assert not broken, "\n".join(broken)
    assert len(asked) == requests, f"{len(asked)} requests in the recording, {requests} were sent"
    assert len(told) == requests, f"{len(told)} answers in the recording, {requests} were received"
    print(f"tshark: {requests} requests and as many answers, none malformed")
