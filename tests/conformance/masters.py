"""Modbus masters that this project did not write, behind three calls: read, read_input and write.

A refusal by the device is ModbusException with the code that the master reported; silence is Silence.
Addresses are those in the PDU.
"""
import os
import re
import subprocess

HERE = os.path.dirname(os.path.abspath(__file__))
SILENCE_AFTER = 1.0  # seconds that a master waits for an answer


class ModbusException(Exception):
    def __init__(self, code):
        super().__init__(f"exception {code:02X}")
        self.code = code


class Silence(Exception):
    """No answer within the master's time-out."""


class Master:
    """Counts its requests, so that a recording can be checked for completeness. endpoint: one of the ready file's."""

    def __init__(self, endpoint, **line):
        self.endpoint = endpoint
        self.tcp = endpoint["protocol"] == "modbus-tcp"
        self.unit = line.pop("unit", endpoint["unit"])
        self.baud = line.pop("baud", 9600)
        self.requests = 0
        assert not line, line

    def __enter__(self):
        self.open()
        return self

    def __exit__(self, *_):
        self.close()

    def open(self):
        pass

    def close(self):
        pass

    def read(self, address, count=1):
        self.requests += 1
        return self.do_read(address, count, 3)

    def read_input(self, address, count=1):
        self.requests += 1
        return self.do_read(address, count, 4)

    def write(self, address, value):
        self.requests += 1
        self.do_write(address, value)


class Pymodbus(Master):
    """python3-pymodbus in this process."""

    def open(self):
        from pymodbus.client import ModbusSerialClient, ModbusTcpClient
        options = {"timeout": SILENCE_AFTER, "retries": 0}
        if self.tcp:
            self.client = ModbusTcpClient(self.endpoint["host"], port=self.endpoint["port"], **options)
        else:
            self.client = ModbusSerialClient(self.endpoint["path"], baudrate=self.baud, parity="N", **options)
        assert self.client.connect(), self.endpoint

    def close(self):
        self.client.close()

    def check(self, answer):
        from pymodbus.pdu import ExceptionResponse
        if isinstance(answer, ExceptionResponse):
            raise ModbusException(answer.exception_code)
        if answer.isError():
            if "no response" in str(answer).lower():
                raise Silence(str(answer))
            raise AssertionError(answer)
        return answer

    def do_read(self, address, count, function):
        call = self.client.read_holding_registers if function == 3 else self.client.read_input_registers
        return self.check(call(address, count, slave=self.unit)).registers

    def do_write(self, address, value):
        answer = self.check(self.client.write_register(address, value, slave=self.unit))
        assert (answer.address, answer.value) == (address, value)


class Mbpoll(Master):
    """mbpoll, one process for each request."""

    CODES = {"Illegal function": 1, "Illegal data address": 2, "Illegal data value": 3, "Slave device or server failure": 4,
             "Acknowledge": 5, "Slave device or server is busy": 6, "Gateway path unavailable": 10,
             "Target device failed to respond": 11}

    def run(self, kind, address, options=(), values=()):
        if self.tcp:
            line, target = ["-m", "tcp", "-p", str(self.endpoint["port"])], self.endpoint["host"]
        else:
            line, target = ["-m", "rtu", "-b", str(self.baud), "-P", "none"], self.endpoint["path"]
        command = ["mbpoll", *line, "-a", str(self.unit), "-0", "-1", "-q", "-o", str(SILENCE_AFTER), "-t", str(kind),
                   "-r", str(address), *options, target, *values]
        done = subprocess.run(command, capture_output=True, text=True, timeout=60, env={**os.environ, "LC_ALL": "C"})
        text = done.stdout + done.stderr
        failed = re.search(r"failed: (.+)", text)
        if failed:
            reason = failed.group(1).strip()
            if reason in self.CODES:
                raise ModbusException(self.CODES[reason])
            if "timed out" in reason:
                raise Silence(reason)
            raise AssertionError(text)
        assert done.returncode == 0, text
        return text

    def do_read(self, address, count, function):
        text = self.run({3: 4, 4: 3}[function], address, options=("-c", str(count)))  # mbpoll's own table numbers
        return [int(v) for v in re.findall(r"^\[\d+\]:\s+(\d+)", text, re.MULTILINE)]

    def do_write(self, address, value):
        self.run(4, address, values=(str(value),))


class Child(Master):
    """A master in a process of its own: a line with a request in, a line with the outcome back."""

    def command(self):
        raise NotImplementedError

    def open(self):
        self.child = subprocess.Popen(self.command(), stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1)

    def close(self):
        self.child.stdin.close()
        self.child.wait(timeout=10)
        self.child.stdout.close()

    def ask(self, *words):
        self.child.stdin.write(" ".join(map(str, words)) + "\n")
        self.child.stdin.flush()
        kind, *values = self.child.stdout.readline().split() or ["ended"]
        if kind == "exception":
            raise ModbusException(int(values[0]))
        if kind == "silence":
            raise Silence()
        assert kind == "ok", (kind, values)
        return [int(v) for v in values]

    def do_read(self, address, count, function):
        return self.ask("read" if function == 3 else "input", address, count)

    def do_write(self, address, value):
        self.ask("write", address, value)


class Libmodbus(Child):
    """libmodbus as a client: libmodbus_master.cpp."""

    def command(self):
        target = f"{self.endpoint['host']}:{self.endpoint['port']}" if self.tcp else self.endpoint["path"]
        return [os.environ["LIBMODBUS_MASTER"], "tcp" if self.tcp else "rtu", target, str(self.unit), str(self.baud),
                str(int(SILENCE_AFTER * 1000))]


class ModbusSerial(Child):
    """npm modbus-serial: node_master.js. Its RTU framing runs over a byte pipe between a socket and the pty, because its
    serial port is a native module that not every Node can load."""

    def open(self):
        self.pipe = None
        if not self.tcp:
            self.pipe = subprocess.Popen(["/usr/bin/python3", os.path.join(HERE, "byte_pipe.py"), self.endpoint["path"],
                                          str(self.baud)], stdout=subprocess.PIPE, text=True)
            self.pipe_port = int(self.pipe.stdout.readline())
        super().open()

    def close(self):
        super().close()
        if self.pipe:
            self.pipe.terminate()
            self.pipe.wait()
            self.pipe.stdout.close()

    def command(self):
        host, port = (self.endpoint["host"], self.endpoint["port"]) if self.tcp else ("127.0.0.1", self.pipe_port)
        return ["node", os.path.join(HERE, "node_master.js"), "tcp" if self.tcp else "rtu", host, str(port), str(self.unit),
                str(int(SILENCE_AFTER * 1000))]


MASTERS = {"pymodbus": Pymodbus, "mbpoll": Mbpoll, "libmodbus": Libmodbus, "modbus-serial": ModbusSerial}
