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


def check_eip_recording(path, explicit, io):
    """At least so many explicit packets and so many that tshark can tell are I/O of a Forward_Open before; all are
    dissected as EtherNet/IP and CIP."""
    rule = "tcp.port==44818,enip"
    broken = tshark(path, rule, "-Y", "_ws.malformed || _ws.expert.severity == error || ip.checksum.status == Bad || "
                                      "tcp.checksum.status == Bad || udp.checksum.status == Bad",
                    "-o", "ip.check_checksum:TRUE", "-o", "tcp.check_checksum:TRUE", "-o", "udp.check_checksum:TRUE")
    assert not broken, "\n".join(broken[:20])
    messages = tshark(path, rule, "-Y", "enip && cip && tcp")
    packets = tshark(path, rule, "-Y", "enip && cipio && udp.port == 2222")
    strange = tshark(path, rule, "-Y", "udp.port == 2222 && !cipio || tcp.len > 0 && !enip")
    assert not strange, "\n".join(strange[:20])
    assert len(messages) >= explicit, f"{len(messages)} explicit packets in the recording, at least {explicit} expected"
    assert len(packets) >= io, f"{len(packets)} I/O packets in the recording, at least {io} expected"
    print(f"tshark: {len(messages)} explicit packets, {len(packets)} I/O packets, none malformed")
