"""tshark's opinion of a recorded wire: what went over it is there, and nothing is malformed."""
import subprocess


def tshark(path, dissector, *options):
    """The lines of its output. dissector: a rule of "decode as"."""
    done = subprocess.run(["tshark", "-n", "-r", path, "-d", dissector, *options],
                          capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()


def check_recording(path, port, requests):
    """requests: how many the master sent and saw answered."""
    dissector = f"tcp.port=={port},mbtcp"
    asked = tshark(path, dissector, "-Y", f"modbus && tcp.dstport == {port}")
    told = tshark(path, dissector, "-Y", f"modbus && tcp.srcport == {port}")
    broken = tshark(path, dissector, "-Y", "_ws.malformed || _ws.unreassembled || tcp.analysis.lost_segment || "
                                      "tcp.checksum.status == Bad || ip.checksum.status == Bad",
                    "-o", "tcp.check_checksum:TRUE", "-o", "ip.check_checksum:TRUE")
    assert not broken, "\n".join(broken)
    assert len(asked) == requests, f"{len(asked)} requests in the recording, {requests} were sent"
    assert len(told) == requests, f"{len(told)} answers in the recording, {requests} were received"
    print(f"tshark: {requests} requests and as many answers, none malformed")


def check_can_recording(path, frames=None):
    """Every data frame is one of CANopen. frames: how many data and remote frames there are, if that is known."""
    rule = "can.subdissector,canopen"
    told = tshark(path, rule, "-Y", "can.flags.err == 0")
    assert told, "an empty recording"
    broken = tshark(path, rule, "-Y", "_ws.malformed || _ws.expert.severity == error")
    assert not broken, "\n".join(broken)
    # tshark's dissector leaves remote frames alone.
    others = tshark(path, rule, "-Y", "can.flags.err == 0 && can.flags.rtr == 0 && !canopen")
    assert not others, "\n".join(others[:10])
    assert frames in (None, len(told)), f"{len(told)} frames in the recording, {frames} were on the bus"
    print(f"tshark: {len(told)} frames, none malformed")
