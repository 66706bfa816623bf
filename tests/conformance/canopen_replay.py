"""A recording in candump's format is read by python-can and can-utils without loss, and played onto another bus by
python-can's player and can-utils' converter, frame for frame."""
import os
import subprocess
import tempfile

import can

from canopen_master import Line, Node, PRE_OPERATIONAL
from canopen_plant import plant_text
import canopen_steps as steps
from plant import Plant, wait_until


def content(message):
    return message.arbitration_id, bool(message.is_remote_frame), message.dlc if message.is_remote_frame else bytes(message.data)


def record(path):
    """A run with remote frames, a trip-free ride and an emergency; returns what was on the bus."""
    with Plant(plant_text([5]), "--record-can", path) as plant:
        endpoint = plant.endpoint("n5", "canopen")
        with Line.of("socketcand", endpoint) as witness, Line.of("slcan", endpoint) as line:
            node = Node(line, 5)
            steps.guards(node)
            steps.answers_remote_frames(line, node)
            told = steps.watches(node)
            steps.sets_ramps(node, up_s=0.3, down_s=0.3)
            steps.runs_by_pdo(line, node, told, seconds_to_reference=0.3)
            steps.command(line, node, steps.BIT_STOP, 0)
            wait_until(lambda: not node.read(steps.COMMAND) & steps.BIT_RUN, 10, "the stop")
            node.nmt(PRE_OPERATIONAL)
            node.guard()
            on_bus = len(line.frames) + line.sent
            seen = [content(m) for m in witness.frames]
        plant.stop()
    return on_bus, seen


def play(path):
    """can.player onto the bus of another plant, whose node has another number; returns what a witness saw."""
    with Plant(plant_text([77])) as plant:
        endpoint = plant.endpoint("n77", "canopen")
        with Line.of("slcan", endpoint) as witness:
            subprocess.run(["/usr/bin/python3", "-m", "can.player", "-i", "slcan", "-c", f"socket://{endpoint['slcan']}",
                            "--ignore-timestamps", path], check=True, timeout=120)
            wanted = len(list(can.LogReader(path)))
            wait_until(lambda: len(witness.frames) >= wanted, 30, "all of the replay")
            return [content(m) for m in witness.frames if m.arbitration_id != 0x700 + 77]


def main():
    with tempfile.TemporaryDirectory(prefix="vinv-") as folder:
        path = os.path.join(folder, "wire.log")
        on_bus, seen = record(path)
        messages = list(can.LogReader(path))
        assert len(messages) == on_bus, f"{len(messages)} frames in the log, {on_bus} on the bus"
        assert all(a.timestamp <= b.timestamp for a, b in zip(messages, messages[1:]))
        recorded = [content(m) for m in messages]
        # python-can shows remote frames over socketcand neither way.
        data_frames = [frame for frame in recorded if not frame[1]]
        assert [frame for frame in seen if frame in data_frames] == data_frames, "the log is not what was on the bus"
        asc = os.path.join(folder, "wire.asc")
        subprocess.run(["log2asc", "-I", path, "-O", asc, messages[0].channel], check=True, timeout=60)
        converted = [content(m) for m in can.LogReader(asc)]
        assert converted == recorded, "log2asc lost something"
        assert play(path) == recorded, "can.player lost something"
        print(f"{len(recorded)} frames")


if __name__ == "__main__":
    main()
