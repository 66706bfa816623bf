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

# Two nodes acknowledge each other from the start. One that is alone causes error frames until a master joins, and those of
# its controller's state python-can 4.1 takes for extended data frames when it reads a log.
NODE, SECOND, BYSTANDER = 5, 6, 77


def content(message):
    return message.arbitration_id, bool(message.is_remote_frame), message.dlc, bytes(message.data)


def record(log, capture):
    """Guarding, requested PDOs, an emergency, a ride. Returns the number of frames that the master sent and received, and
    what a witness saw."""
    with Plant(plant_text([NODE, SECOND]), "--record-can", log, "--record-can", capture) as plant:
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
    """can.player onto the bus of another plant, whose node is not spoken to; returns what a witness saw.

    The player closes the channel right behind its last frame, and an adapter drops what it has not sent by then: it gets one
    frame more than is looked for, and no more at a time than the bus takes."""
    with open(log, encoding="ascii") as f:
        lines = f.readlines()
    last_frame = f"{lines[-1].rsplit(' ', 1)[0]} 7FF#\n"
    with open(log + ".log", "w", encoding="ascii") as f:
        f.writelines([*lines, last_frame])
    with Plant(plant_text([BYSTANDER])) as plant:
        endpoint = plant.endpoint(f"n{BYSTANDER}", "canopen")
        with Line.of("slcan", endpoint) as witness:
            Node(witness, BYSTANDER).read(0x1000)
            since = witness.now()
            subprocess.run(["/usr/bin/python3", "-m", "can.player", "-i", "slcan", "-c", f"socket://{endpoint['slcan']}",
                            "--ignore-timestamps", "--gap", "0.002", log + ".log"], check=True, timeout=120, stdout=subprocess.DEVNULL)
            wait_until(lambda: witness.now() - since >= wanted, 30, "all of the replay")
            return [content(m) for m in witness.frames[since:since + wanted]]


def main():
    with tempfile.TemporaryDirectory(prefix="vinv-") as folder:
        log, asc, capture = (os.path.join(folder, f"wire.{ending}") for ending in ("log", "asc", "pcapng"))
        on_bus, seen = record(log, capture)
        messages = list(can.LogReader(log))
        recorded = [content(m) for m in messages]
        missed = recorded[:len(recorded) - on_bus]
        boot_ups = [(GUARD + number, False, 1, b"\0") for number in (NODE, SECOND)]
        assert len(recorded) >= on_bus and missed == boot_ups[:len(missed)], (len(recorded), on_bus, missed[:5])
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
