"""Frames that no master should send, on a live bus: the standard's answer or silence, nothing lost, neighbours undisturbed.

Node 5 takes it all, from a master on slcan, which has remote frames. Node 6 sends a PDO every 20 ms meanwhile, which an
observer on socketcand times by the bus's own clock.
"""
import struct
import time

from canopen_master import (GUARD, IS_OPERATIONAL, IS_PRE_OPERATIONAL, IS_STOPPED, NMT, Node, PRE_OPERATIONAL, SDO_ANSWER,
                            SDO_REQUEST, START, STOP, SYNC)
from canopen_plant import CanPlant
import canopen_steps as steps
from plant import wait_until

VICTIM, NEIGHBOUR = 5, 6
NEIGHBOURS_PDO = 0x082  # only NMT and SYNC have priority
PERIOD_MS = 20
NO_COMMAND = 0x05040001
COB_IDS = [SYNC, 0x80 + VICTIM, *(base + VICTIM for base in range(0x180, 0x580, 0x80)), SDO_ANSWER + VICTIM,
           SDO_REQUEST + VICTIM, GUARD + VICTIM]
# Bits of the command word that mean nothing, so that no PDO starts the motor.
HARMLESS = bytes([0xC0, 0xF8, 0x34, 0x12, 0xFF, 0xFF, 0x00, 0x80])


def settled(node):
    """All that was sent before has been dealt with when this request, the last one, has its answer."""
    since = node.line.now()
    node.line.send(SDO_REQUEST + node.number, bytes.fromhex("4000100000000000"))
    node.line.wait(lambda m: is_the_question(m), since)


def is_the_question(message):
    return message.arbitration_id == SDO_ANSWER + VICTIM and bytes(message.data) == bytes.fromhex("4300100092010100")


def in_pieces(node, calls):
    """Sends so few at a time that frames of higher priority do not fill the bus for longer than the neighbour may wait."""
    calls = list(calls)
    for i in range(0, len(calls), 3):
        for send, *arguments in calls[i:i + 3]:
            send(*arguments)
        settled(node)


def told(line, since):
    """What came from the victim but for the answers to settled()."""
    return [m.arbitration_id for m in line.frames[since:] if m.arbitration_id != NEIGHBOURS_PDO and not is_the_question(m)]


def every_length_everywhere(line, node, state):
    """Data and remote frames of every length; what may answer, does, and nobody else."""
    allowed = {
        # remote frames that are asked for something
        (GUARD + VICTIM, True): [GUARD + VICTIM] * 9,
        # a request of eight bytes, without a known command specifier
        (SDO_REQUEST + VICTIM, False): [SDO_ANSWER + VICTIM],
    }
    if state == IS_OPERATIONAL:
        allowed[0x180 + VICTIM, True] = [0x180 + VICTIM] * 9
        allowed[0x200 + VICTIM, False] = [0x80 + VICTIM] * 2  # one that is too short, and its end
    for cob_id in COB_IDS:
        for remote in (False, True):
            since = line.now()
            in_pieces(node, ((line.request, cob_id, length) if remote else (line.send, cob_id, HARMLESS[:length])
                             for length in range(9)))
            answers, expected = told(line, since), allowed.get((cob_id, remote), [])
            assert answers == expected, (f"{cob_id:03X}", remote, [f"{m:03X}" for m in answers])
    assert node.guard()[1] == state


def extended_frames(line, node):
    """Identifiers of 29 bits with the same number are not the slave's; nor is a stop by NMT with one."""
    since = line.now()
    in_pieces(node, ((line.send, cob_id, HARMLESS, True) for cob_id in COB_IDS))
    in_pieces(node, [(line.send, NMT, [2, VICTIM], True), (line.send, SDO_REQUEST + VICTIM, [0x40] + [0] * 7, True)])
    assert not told(line, since)


def stopped(line, node):
    """Only NMT and guarding are left, and the order of the answers shows that nothing else came between."""
    node.nmt(STOP)
    assert node.guard()[1] == IS_STOPPED
    since = line.now()
    for cob_id in COB_IDS:
        for length in range(9):
            line.send(cob_id, HARMLESS[:length])
            if cob_id != GUARD + VICTIM:
                line.request(cob_id, length)
        assert node.guard()[1] == IS_STOPPED
    assert told(line, since) == [GUARD + VICTIM] * len(COB_IDS)


def network_commands(line, node):
    """Unknown commands, wrong lengths, other nodes' commands."""
    before = node.guard()[1]
    since = line.now()
    lengths = (0, 1, 3, 4, 5, 6, 7, 8)
    in_pieces(node, ((line.send, NMT, bytes([2, VICTIM, 0, 0, 0, 0, 0, 0])[:length]) for length in lengths))
    in_pieces(node, ((line.request, NMT, length) for length in range(9)))
    in_pieces(node, ((line.send, NMT, [command, VICTIM]) for command in set(range(256)) - {1, 2, 128, 129, 130}))
    line.send(NMT, [2, 77])
    settled(node)
    assert not told(line, since)
    assert node.guard()[1] == before


def command_specifiers(line, node):
    """All 256 first bytes of a request for 1000H, which is read-only."""
    for first in range(256):
        request = struct.pack("<BHB4x", first, 0x1000, 0)
        specifier, expedited = first >> 5, first & 2
        if specifier == 4:  # the client's abort is not answered
            since = line.now()
            line.send(SDO_REQUEST + VICTIM, request)
            settled(node)
            assert not told(line, since), hex(first)
            continue
        answer = node.sdo(request)
        code = int.from_bytes(answer[4:], "little")
        if specifier == 2:
            assert answer[0] == 0x43 and code == 0x10192, (first, answer.hex())
        elif specifier == 1 and expedited:
            assert answer[0] == 0x80 and code == 0x06010002, (first, answer.hex())
        else:
            assert answer[0] == 0x80 and code == NO_COMMAND, (first, answer.hex())


def sdo_answers(line, number, since):
    return [bytes(m.data) for m in line.frames[since:] if m.arbitration_id == SDO_ANSWER + number]


def interleaved_and_aborted(line, node, neighbour):
    """Transfers of two nodes at once; requests without waiting; a download that is given up is carried out all the same."""
    steps.goes_operational(node)
    read = struct.pack("<BHB4x", 0x40, 0x3007, 0)
    since = line.now()
    for _ in range(20):
        for number in (VICTIM, NEIGHBOUR):
            line.send(SDO_REQUEST + number, read)
    for other in (node, neighbour):
        wait_until(lambda: len(sdo_answers(line, other.number, since)) >= 20, 20, "20 answers")
        other.read(0x1000)
        assert [answer[1:3] for answer in sdo_answers(line, other.number, since)] == [b"\x07\x30"] * 20 + [b"\x00\x10"]

    def write(value):
        return struct.pack("<BHBHxx", 0x2B, 0x3007, 0, value)

    # What follows a download that is not decided yet gives it up: that alone is answered then. Either way it is carried
    # out, and nothing is answered twice or out of order.
    abort = struct.pack("<BHBI", 0x80, 0x3007, 0, 0x05040000)
    for value, follows, answered in ((61, read, [0x4B]), (62, abort, []), (63, write(63), [0x60])):
        since = line.now()
        line.send(SDO_REQUEST + VICTIM, write(value))
        line.send(SDO_REQUEST + VICTIM, follows)
        time.sleep(0.2)
        answers = [answer[0] for answer in sdo_answers(line, VICTIM, since)]
        assert answers in (answered, [0x60, *answered]), answers
        wait_until(lambda: node.read(0x3007) == value, 10, f"Pr.7 = {value}")
    # An initiated segmented download and its segments are refused one by one.
    for request in (struct.pack("<BHBI", 0x21, 0x3007, 0, 20), bytes([0x00, *b"segment"]), bytes([0x60] + [0] * 7)):
        answer = node.sdo(request)
        assert answer[0] == 0x80 and int.from_bytes(answer[4:], "little") == NO_COMMAND, answer.hex()
    node.nmt(PRE_OPERATIONAL)


def floods(line, node, count=400):
    """As fast as the bus takes them: each request is answered, in order; each guarding, with its toggle bit."""
    since = line.now()
    for _ in range(count):
        line.request(GUARD + VICTIM, 1)
    wait_until(lambda: told(line, since).count(GUARD + VICTIM) >= count, 30, "an answer to each guarding")
    toggles = [m.data[0] >> 7 for m in line.frames[since:] if m.arbitration_id == GUARD + VICTIM]
    assert len(toggles) == count and all(a != b for a, b in zip(toggles, toggles[1:]))
    since = line.now()
    for i in range(count):
        line.send(SDO_REQUEST + VICTIM, struct.pack("<BHB4x", 0x40, 0x3000 + i % 3, 0))
    wait_until(lambda: len(sdo_answers(line, VICTIM, since)) >= count, 30, "an answer to each request of the flood")
    node.read(0x1000)
    indices = [int.from_bytes(answer[1:3], "little") for answer in sdo_answers(line, VICTIM, since)]
    assert indices == [0x3000 + i % 3 for i in range(count)] + [0x1000], "lost or out of order"


def main():
    with (CanPlant([VICTIM, NEIGHBOUR], good_frames=False) as plant, plant.line("socketcand") as observer,
          plant.line("slcan") as line):
        node, neighbour = Node(line, VICTIM), Node(line, NEIGHBOUR)
        neighbour.map_pdo("transmit", 2, [(0x2000, 0, 16)], 255, event_timer=PERIOD_MS, cob_id=NEIGHBOURS_PDO)
        steps.goes_operational(neighbour)
        observer.wait(NEIGHBOURS_PDO, observer.now())
        begin = observer.now()
        for state, command in ((IS_PRE_OPERATIONAL, PRE_OPERATIONAL), (IS_OPERATIONAL, START)):
            node.nmt(command)
            every_length_everywhere(line, node, state)
            network_commands(line, node)
            extended_frames(line, node)
        command_specifiers(line, node)
        interleaved_and_aborted(line, node, neighbour)
        floods(line, node)
        end = observer.now()
        stopped(line, node)
        times = [m.timestamp for m in observer.frames[begin:end] if m.arbitration_id == NEIGHBOURS_PDO]
        gaps = [b - a for a, b in zip(times, times[1:])]
        print(f"{len(line.frames)} frames received, the neighbour's period {min(gaps):.4f} to {max(gaps):.4f} s")
        assert PERIOD_MS * 0.0008 < min(gaps) and max(gaps) < PERIOD_MS * 0.0012, "the neighbour was disturbed"
        assert not [m for m in observer.frames if m.arbitration_id == 0x80 + NEIGHBOUR]
        assert not plant.signals(plant.first)["output_frequency"]


if __name__ == "__main__":
    main()
