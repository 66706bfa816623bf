"""Ten nodes on a real SocketCAN interface: all services with remote frames, python-can and can-utils as masters, and an
interface that goes down and comes back. It needs a kernel with CAN: tests/sim/transports/can/in_vcan.py brings one.

Usage: canopen_vcan.py INTERFACE
"""
import os
import subprocess
import sys
import time

from canopen_master import (GUARD, IS_OPERATIONAL, IS_PRE_OPERATIONAL, Line, NOT_VALID, Node, RESET_NODE,
                            START)
from canopen_plant import CanPlant, HEAVY
import canopen_steps as steps
from plant import wait_until

TOLERANCE = 0.2
NODES = range(1, 11)


def ip(interface, state):
    subprocess.run(["ip", "link", "set", interface, state], check=True)


def all_nodes(line, nodes):
    """Boot-up, guarding and SDO of each; a SYNC brings a PDO of each."""
    since = line.now()
    line.nmt(RESET_NODE)
    for node in nodes:
        node.wait_boot_up(since)
    for node in nodes:
        assert node.guard() == (0, IS_PRE_OPERATIONAL)
        assert node.read(0x100B) == node.number
        cob_id = 0x180 + node.number
        node.write(0x1800, 1, NOT_VALID | cob_id, 4)
        node.write(0x1800, 2, 1, 1)
        node.write(0x1800, 1, cob_id, 4)
    line.nmt(START)
    for node in nodes:
        assert node.guard() == (1, IS_OPERATIONAL)
    since = line.now()
    line.sync()
    for node in nodes:
        line.wait(0x180 + node.number, since, what=f"the PDO of node {node.number}")
    line.nmt(RESET_NODE)
    for node in nodes:
        node.wait_boot_up(since)
        wait_until(lambda: not steps.is_remote(node), 20, "the end of NET mode")


def can_utils(interface, number, folder):
    """cansend asks with a remote frame and an SDO, candump writes down what goes by."""
    guarding, request = f"{GUARD + number:03X}#R1", f"{0x600 + number:03X}#4000100000000000"
    path = os.path.join(folder, "candump.txt")
    with open(path, "w", encoding="utf-8") as out:
        dump = subprocess.Popen(["candump", "-L", interface], stdout=out)

    def seen():
        with open(path, encoding="utf-8") as f:
            return {line.split()[2] for line in f if line.endswith("\n")}

    def asked_and_answered():
        for frame in (guarding, request):
            subprocess.run(["cansend", interface, frame], check=True)
        return {guarding, f"{GUARD + number:03X}#7F", f"{GUARD + number:03X}#FF", request,
                f"{0x580 + number:03X}#4300100092010100"} <= seen()

    try:
        wait_until(asked_and_answered, 20, "questions and answers in candump")
    finally:
        dump.terminate()
        dump.wait()


def runs_and_trips(line, node):
    told = steps.watches(node)
    steps.goes_operational(node)
    steps.sets_ramps(node, up_s=2.0, down_s=1.0)
    steps.runs_by_pdo(line, node, told, seconds_to_reference=2.0, tolerance=TOLERANCE)
    steps.trips(line, node, told, tolerance=TOLERANCE * 0.040)
    steps.is_reset(line, node)


def line_goes_down(plant, interface, number, guard_ms=100, factor=5):
    """The guarded motor stops when the line is gone; the nodes are there again when it is back."""
    with Line("socketcan", channel=interface) as line:
        node = Node(line, number)
        steps.goes_operational(node)
        steps.sets_ramps(node, up_s=0.5, down_s=0.5)
        node.write(steps.ABORT_OPTION, 0, 3)
        node.write(steps.GUARD_TIME, 0, guard_ms)
        node.write(steps.LIFE_TIME_FACTOR, 0, factor, 1)
        steps.command(line, node, steps.BIT_STF, 1000)

        def runs():
            node.guard()
            return plant.signals(f"n{number}")["output_frequency"] == 10
        wait_until(runs, 20, "a running motor")
    ip(interface, "down")
    wait_until(lambda: plant.signals(f"n{number}")["output_frequency"] == 0, 20, "the stop of the motor without a line")
    ip(interface, "up")
    with Line("socketcan", channel=interface) as line:
        def is_back():
            since = line.now()
            line.request(GUARD + number, 1)
            time.sleep(0.1)
            return any(not m.is_remote_frame for m in line.frames[since:])
        wait_until(is_back, 20, "an answer after the line came back")
        for other in NODES:
            assert Node(line, other).read(0x100B) == other
        Node(line, number).write(steps.LIFE_TIME_FACTOR, 0, 0, 1)


def main():
    interface = sys.argv[1]
    with CanPlant(NODES, inertia=HEAVY, can=f"socketcan:{interface}") as plant:
        with Line("socketcan", channel=interface) as line:
            nodes = [Node(line, number) for number in NODES]
            all_nodes(line, nodes)
            steps.guards(nodes[3])
            steps.answers_remote_frames(line, nodes[3])
            guarded = dict(zip((0, 2, 3), nodes))
            watched, since = steps.stops_when_guarding_ends(line, guarded, tolerance=TOLERANCE)
            steps.reactions_to_lost_guarding(line, guarded, watched, since, tolerance=TOLERANCE)
            runs_and_trips(line, nodes[4])
            can_utils(interface, 6, plant.folder)
        line_goes_down(plant, interface, 7)


if __name__ == "__main__":
    main()
