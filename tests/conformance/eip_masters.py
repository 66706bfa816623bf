"""npm st-ethernet-ip behind calls: eip_node_master.js in a process of its own."""
import os
import subprocess

from plant import HERE, wait_until

GET_ALL, RESET, GET, SET = 0x01, 0x05, 0x0E, 0x10
SUCCESS, NO_CLASS, NO_SERVICE, BAD_VALUE, STATE_CONFLICT, NOT_SETTABLE, DEVICE_CONFLICT = 0, 5, 8, 9, 0x0C, 0x0E, 0x10
NOT_ENOUGH, NO_ATTRIBUTE, TOO_MUCH, NO_INSTANCE = 0x13, 0x14, 0x15, 0x16


class Node:
    """Context manager: one process with explicit masters and I/O connections by name. local: where it binds UDP 2222."""

    def __init__(self, local):
        self.local = local

    def __enter__(self):
        self.child = subprocess.Popen(["node", os.path.join(HERE, "eip_node_master.js"), self.local],
                                      stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1)
        return self

    def __exit__(self, *_):
        self.child.stdin.close()
        try:
            self.child.wait(timeout=5)
        except subprocess.TimeoutExpired:
            self.child.kill()
            self.child.wait()
        self.child.stdout.close()

    def ask(self, *words):
        self.child.stdin.write(" ".join(map(str, words)) + "\n")
        self.child.stdin.flush()
        while True:
            line = self.child.stdout.readline()
            assert line, f"{words}: the master ended"
            kind, _, rest = line.rstrip("\n").partition(" ")
            if kind == "ok":
                return rest.split(" ") if rest else []
            assert kind != "error", f"{words}: {rest}"  # anything else the library says for itself

    def explicit(self, name, host, kind="plain"):
        self.ask("explicit", name, host, kind)
        return Explicit(self, name)

    def io(self, name, host, pair, rpi_ms=10):
        """An exclusive owner, once it has the connection. pair: (output, bytes, input, bytes)."""
        return Io(self, name, host, pair, rpi_ms)


class Refused(Exception):
    def __init__(self, status, what):
        super().__init__(f"{what}: status {status:02X}")
        self.status = status


class Explicit:
    def __init__(self, node, name):
        self.node, self.name = node, name

    def answer(self, service, class_id, instance, attribute=None, data=b""):
        """(status, data)"""
        words = self.node.ask("request", self.name, service, class_id, instance,
                              "-" if attribute is None else attribute, bytes(data).hex())
        return int(words[0]), bytes.fromhex(words[1] if len(words) > 1 else "")

    def get_bytes(self, class_id, instance, attribute):
        status, data = self.answer(GET, class_id, instance, attribute)
        if status != SUCCESS:
            raise Refused(status, f"get {class_id:02X}/{instance}/{attribute}")
        return data

    def get(self, class_id, instance, attribute):
        return int.from_bytes(self.get_bytes(class_id, instance, attribute), "little")

    def set_status(self, class_id, instance, attribute, value, size=2):
        """The status; waits while another write is in progress, as the manual tells masters to (6.3)."""
        def done():
            status, _ = self.answer(SET, class_id, instance, attribute, value.to_bytes(size, "little"))
            return None if status == STATE_CONFLICT and self.patient else [status]
        return wait_until(done, 10, f"set {class_id:02X}/{instance}/{attribute}")[0]

    patient = True

    def set(self, class_id, instance, attribute, value, size=2):
        status = self.set_status(class_id, instance, attribute, value, size)
        if status != SUCCESS:
            raise Refused(status, f"set {class_id:02X}/{instance}/{attribute} to {value}")

    def drop(self):
        self.node.ask("drop", self.name)


PAIR_20, PAIR_21, PAIR_126, PAIR_129 = (20, 4, 70, 4), (21, 4, 71, 4), (126, 6, 176, 6), (129, 6, 179, 6)


class Io:
    def __init__(self, node, name, host, pair, rpi_ms):
        self.node, self.name = node, name
        node.ask("io", name, host, *pair, rpi_ms)

    def packets(self):
        return int(self.node.ask("in", self.name)[0])

    def connected(self):
        return self.packets() > 0

    def wait(self, seconds=10):
        wait_until(self.connected, seconds, f"I/O connection {self.name}")
        return self

    def data(self):
        return bytes.fromhex(self.node.ask("in", self.name)[1])

    def word(self, at):
        return int.from_bytes(self.data()[at:at + 2], "little")

    def speed(self):
        return self.word(2)

    def out(self, control, speed=0, signals=0, more=b"\0\0"):
        """more: the last two bytes of 126 and 129."""
        data = bytes([control, signals]) + speed.to_bytes(2, "little") + more
        self.node.ask("out", self.name, data.hex())

    def out_short(self, control, speed=0):
        self.out(control, speed, more=b"")

    def silent(self):
        self.node.ask("silent", self.name)

    def close(self):
        self.node.ask("close", self.name)

    def drop(self):
        self.node.ask("drop", self.name)
