"""A recording in candump's format holds what was on the bus, frame for frame; python-can and can-utils read it without
loss, and python-can's player brings it onto another bus."""
import os
import subprocess
import tempfile

import can

from canopen_master import GUARD, Line, Node, PRE_OPERATIONAL
from canopen_plant import plant_text
import canopen_steps as steps
from plant import Plant, wait_until
from recording import check_can_recording

NODE, BYSTANDER = 5, 77


def content(message):
    return message.arbitration_id, bool(message.is_remote_frame), message.dlc, bytes(message.data)


def record(log, capture):
    """Guarding, requested PDOs, an emergency, a ride. Returns the number of frames that the master sent and received, and
    what a witness saw."""
    with Plant(plant_text([NODE]), "--record-can", log, "--record-can", capture) as plant:
        endpoint = plant.endpoint(f"n{NODE}", "canopen")
        with Line.of("socketcand", endpoint) as witness, Line.of("slcan", endpoint) as line:
            node = Node(line, NODE)
            steps.guards(node)
            steps.answers_remote_frames(line, node)
            told = steps.watches(node)
            steps.sets_ramps(node, up_s=0.3, down_s=0.3)
            steps.runs_by_pdo(line, node, told, seconds_to_reference=0.3)
            steps.command(line, node, steps.BIT_STOP, 0)
            wait_until(lambda: not node.read(steps.COMMAND) & steps.BIT_RUN, 10, "the stop")
            node.nmt(PRE_OPERATIONAL)
            node.guard()
            wait_until(lambda: witness.frames[-1].arbitration_id == GUARD + NODE, 10, "the last frame")
            return len(line.frames) + line.sent, [content(m) for m in witness.frames]


def play(log, wanted):
    """can.player onto the bus of another plant, whose node is not spoken to; returns what a witness saw."""
    with Plant(plant_text([BYSTANDER])) as plant:
        endpoint = plant.endpoint(f"n{BYSTANDER}", "canopen")
        with Line.of("slcan", endpoint) as witness:
            Node(witness, BYSTANDER).read(0x1000)
            since = witness.now()
            subprocess.run(["/usr/bin/python3", "-m", "can.player", "-i", "slcan", "-c", f"socket://{endpoint['slcan']}",
                            "--ignore-timestamps", log], check=True, timeout=120, stdout=subprocess.DEVNULL)
            wait_until(lambda: witness.now() - since >= wanted, 30, "all of the replay")
            return [content(m) for m in witness.frames[since:]]


def main():
    with tempfile.TemporaryDirectory(prefix="vinv-") as folder:
        log, asc, capture = (os.path.join(folder, f"wire.{ending}") for ending in ("log", "asc", "pcapng"))
        on_bus, seen = record(log, capture)
        messages = list(can.LogReader(log))
        recorded = [content(m) for m in messages]
        assert recorded[0] == (GUARD + NODE, False, 1, b"\0"), "it begins with the boot-up, which the master may have missed"
        assert len(recorded) - on_bus in (0, 1), f"{len(recorded)} frames in the log, {on_bus} on the bus"
        assert all(a.timestamp <= b.timestamp for a, b in zip(messages, messages[1:]))
        remote = [frame for frame in recorded if frame[1]]
        assert len(remote) > 5
        # python-can does not show remote frames over socketcand.
        assert [frame for frame in recorded if not frame[1]][-len(seen):] == seen
        check_can_recording(capture, len(recorded))
        subprocess.run(["log2asc", "-I", log, "-O", asc, messages[0].channel], check=True, timeout=60)
        assert [content(m) for m in can.LogReader(asc)] == recorded, "log2asc lost something"
        assert play(log, len(recorded)) == recorded, "can.player lost something"
        print(f"{len(recorded)} frames, {len(remote)} of them remote frames")


if __name__ == "__main__":
    main()
