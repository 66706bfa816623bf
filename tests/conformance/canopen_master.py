"""A CANopen master by hand over python-can, which knows frames only: SDO, NMT, node guarding, SYNC, PDOs, emergencies.

DS-301 v4.0, 9.2; addresses and numbers are those of the OI-FR-E5NCO's manual, 6 and 7. python-can 4.1 neither sends nor
shows remote frames over socketcand: guarding and requested PDOs need slcan or socketcan.
"""
import logging
import struct
import threading
import time

import can

START, STOP, PRE_OPERATIONAL, RESET_NODE, RESET_COMMUNICATION = 1, 2, 128, 129, 130
IS_STOPPED, IS_OPERATIONAL, IS_PRE_OPERATIONAL = 4, 5, 127
NMT, SYNC, EMERGENCY, SDO_ANSWER, SDO_REQUEST, GUARD = 0x000, 0x080, 0x080, 0x580, 0x600, 0x700
NOT_VALID = 1 << 31
SILENCE_AFTER = 10.0  # seconds; an answer takes some milliseconds, a loaded machine may take its time

logging.getLogger("can").setLevel(logging.ERROR)  # it warns of each frame that arrives in two pieces


class Abort(Exception):
    def __init__(self, index, sub, code):
        super().__init__(f"{index:04X}:{sub:02X} aborted with {code:08X}")
        self.code = code


def show(message):
    """As candump writes it."""
    data = f"R{message.dlc or ''}" if message.is_remote_frame else bytes(message.data).hex().upper()
    return f"{message.arbitration_id:03X}#{data}"


class Line:
    """A connection to a bus. All that came is in `frames`, in order; a position in it is where waiting begins."""

    def __init__(self, interface, **options):
        if interface == "slcan":
            options.setdefault("sleep_after_open", 0.2)
        self.remote_frames = interface != "socketcand"
        self.bus = can.Bus(interface=interface, **options)
        self.frames = []
        self.sent = 0
        self.news = threading.Condition()
        self.notifier = can.Notifier(self.bus, [self.take], timeout=0.1)

    @classmethod
    def of(cls, interface, endpoint):
        """endpoint: a board's in the ready file."""
        host, _, port = endpoint[interface].rpartition(":")
        if interface == "socketcand":
            return cls("socketcand", host=host, port=int(port), channel=endpoint["channel"])
        return cls("slcan", channel=f"socket://{host}:{port}")

    def __enter__(self):
        return self

    def __exit__(self, kind, *_):
        if kind is not None:
            print("last frames received:", *(f"{m.timestamp:.6f} {show(m)}" for m in self.frames[-30:]), sep="\n  ")
        self.notifier.stop()
        self.bus.shutdown()

    def take(self, message):
        with self.news:
            self.frames.append(message)
            self.news.notify_all()

    def now(self):
        return len(self.frames)

    def send(self, cob_id, data=b"", extended=False):
        self.sent += 1
        self.bus.send(can.Message(arbitration_id=cob_id, data=bytes(data), is_extended_id=extended))

    def request(self, cob_id, length=0):
        """A remote frame."""
        assert self.remote_frames, "python-can has no remote frames on this interface"
        self.sent += 1
        self.bus.send(can.Message(arbitration_id=cob_id, is_remote_frame=True, dlc=length, is_extended_id=False))

    def wait(self, matches, since, timeout=SILENCE_AFTER, what=None):
        """(frame, position after it): the first from `since` on that fits. matches: a COB-ID or a predicate."""
        fits = matches if callable(matches) else lambda m: m.arbitration_id == matches
        deadline = time.monotonic() + timeout
        with self.news:
            while True:
                while since < len(self.frames):
                    message = self.frames[since]
                    since += 1
                    if fits(message):
                        return message, since
                left = deadline - time.monotonic()
                assert left > 0, f"not within {timeout} s: {what or (matches if callable(matches) else hex(matches))}"
                assert self.notifier.exception is None, self.notifier.exception
                self.news.wait(min(left, 0.5))

    def collect(self, matches, since, seconds):
        """All frames from `since` on that fit, until so many seconds from now."""
        time.sleep(seconds)
        fits = matches if callable(matches) else lambda m: m.arbitration_id == matches
        return [m for m in self.frames[since:] if fits(m)]

    def expect_silence(self, matches, since, seconds):
        heard = self.collect(matches, since, seconds)
        assert not heard, [show(m) for m in heard]

    def nmt(self, command, node=0):
        self.send(NMT, [command, node])

    def sync(self):
        self.send(SYNC)


class Node:
    """One slave on a line."""

    def __init__(self, line, number):
        self.line = line
        self.number = number

    def sdo(self, request):
        """The answer to eight bytes; nothing in it has been looked at but for whose object it is."""
        since = self.line.now()
        self.line.send(SDO_REQUEST + self.number, request)
        answer, _ = self.line.wait(SDO_ANSWER + self.number, since, what=f"the answer to {bytes(request).hex()}")
        return bytes(answer.data)

    def transfer(self, command, index, sub, data=b""):
        answer = self.sdo(struct.pack("<BHB4s", command, index, sub, bytes(data)))
        assert len(answer) == 8 and answer[1:4] == struct.pack("<HB", index, sub), (hex(index), sub, answer.hex())
        if answer[0] == 0x80:
            raise Abort(index, sub, int.from_bytes(answer[4:], "little"))
        return answer

    def read_bytes(self, index, sub=0):
        answer = self.transfer(0x40, index, sub)
        assert answer[0] & 0xF3 == 0x43, f"not an expedited upload with its size: {answer.hex()}"
        size = 4 - (answer[0] >> 2 & 3)
        assert not any(answer[4 + size:]), f"bytes beyond the data: {answer.hex()}"
        return answer[4:4 + size]

    def read(self, index, sub=0, signed=False):
        return int.from_bytes(self.read_bytes(index, sub), "little", signed=signed)

    def write(self, index, sub, value, size=2):
        data = (value & (1 << 8 * size) - 1).to_bytes(size, "little")
        answer = self.transfer(0x23 | (4 - size) << 2, index, sub, data)
        assert answer[0] == 0x60 and not any(answer[4:]), answer.hex()

    def parameter(self, number, value):
        self.write(0x3000 + number, 0, value)

    def expect_abort(self, code, call, *arguments):
        try:
            answer = call(*arguments)
        except Abort as refusal:
            assert refusal.code == code, f"{call.__name__}{arguments}: {refusal}, expected {code:08X}"
            return
        raise AssertionError(f"{call.__name__}{arguments}: {answer}, expected abort {code:08X}")

    def nmt(self, command):
        self.line.nmt(command, self.number)

    def wait_boot_up(self, since):
        frame, since = self.line.wait(GUARD + self.number, since, what=f"the boot-up of node {self.number}")
        assert bytes(frame.data) == b"\0", show(frame)
        return since

    def wait_emergency(self, since, error_code=None):
        """(frame, position): the next one, or the next one with that code."""
        def fits(m):
            return (m.arbitration_id == EMERGENCY + self.number and len(m.data) == 8
                    and error_code in (None, struct.unpack_from("<H", m.data)[0]))
        return self.line.wait(fits, since, what=f"emergency {error_code} of node {self.number}")

    def guard(self):
        """(toggle bit, state)"""
        since = self.line.now()
        self.line.request(GUARD + self.number, 1)
        frame, _ = self.line.wait(lambda m: m.arbitration_id == GUARD + self.number and not m.is_remote_frame, since,
                                  what=f"the guard answer of node {self.number}")
        assert len(frame.data) == 1, show(frame)
        return frame.data[0] >> 7, frame.data[0] & 0x7F

    def set_tpdo1_type(self, transmission_type):
        """Of TPDO1 as delivered, which does not exist meanwhile. Returns its COB-ID."""
        cob_id = 0x180 + self.number
        self.write(0x1800, 1, NOT_VALID | cob_id, 4)
        self.write(0x1800, 2, transmission_type, 1)
        self.write(0x1800, 1, cob_id, 4)
        return cob_id

    def map_pdo(self, direction, pdo, entries, transmission_type, inhibit=0, event_timer=0, cob_id=None):
        """Sets up a PDO (1-4) in the order that DS-301 asks for, and returns its COB-ID: that of the predefined connection
        set if none is given. direction: "receive" or "transmit"; entries: (index, sub-index, bits); inhibit in 100 us,
        event timer in ms."""
        transmit = direction == "transmit"
        communication = (0x1800 if transmit else 0x1400) + pdo - 1
        cob_id = cob_id or (0x180 if transmit else 0x200) + 0x100 * (pdo - 1) + self.number
        self.write(communication, 1, NOT_VALID | cob_id, 4)
        self.write(communication + 0x200, 0, 0, 1)
        for i, (index, sub, bits) in enumerate(entries, 1):
            self.write(communication + 0x200, i, index << 16 | sub << 8 | bits, 4)
        self.write(communication + 0x200, 0, len(entries), 1)
        self.write(communication, 2, transmission_type, 1)
        if transmit:
            self.write(communication, 3, inhibit, 2)
            self.write(communication, 5, event_timer, 2)
        self.write(communication, 1, cob_id, 4)
        return cob_id
