"""A live plant for the conformance tests: starts `vinverter run`, reads its ready file, talks to its control socket.

Every test has its own folder for state, sockets and links, and lets the plant choose its ports, so that tests run side by
side. Limits on waiting are generous: they only bound a test that hangs.
"""
import json
import os
import shutil
import signal
import socket
import subprocess
import tempfile
import time

VINVERTER = os.environ["VINVERTER"]
HERE = os.path.dirname(os.path.abspath(__file__))


class ControlError(Exception):
    """The control socket refused a command."""


def wait_until(condition, timeout, what):
    """Polls until the condition gives a true value, which is returned."""
    deadline = time.monotonic() + timeout
    while True:
        value = condition()
        if value:
            return value
        if time.monotonic() > deadline:
            raise AssertionError(f"not within {timeout} s: {what}")
        time.sleep(0.02)


class Plant:
    """Context manager. yaml_text: the plant file; options: further options of `vinverter run`."""

    def __init__(self, yaml_text, *options, folder=None):
        self.own_folder = folder is None
        self.folder = folder or tempfile.mkdtemp(prefix="vinv-")
        self.file = os.path.join(self.folder, "plant.yaml")
        self.log_path = os.path.join(self.folder, "log.txt")
        self.options = options
        with open(self.file, "w", encoding="utf-8") as f:
            f.write(yaml_text)
        self.process = None
        self.control = None
        self.ready = None

    def environment(self):
        return {**os.environ, "XDG_STATE_HOME": os.path.join(self.folder, "state"),
                "XDG_RUNTIME_DIR": self.folder}

    def start(self):
        ready_file = os.path.join(self.folder, "ready.json")
        if os.path.exists(ready_file):
            os.unlink(ready_file)
        with open(self.log_path, "ab") as log:
            self.process = subprocess.Popen([VINVERTER, "run", self.file, "--ready-file", ready_file, *self.options],
                                            stdout=log, stderr=log, stdin=subprocess.DEVNULL, env=self.environment(),
                                            cwd=self.folder)

        def appeared():
            assert self.process.poll() is None, f"vinverter ended with {self.process.returncode}:\n{self.log()}"
            return os.path.exists(ready_file)

        wait_until(appeared, 60, "the ready file")
        with open(ready_file, encoding="utf-8") as f:
            self.ready = json.load(f)  # it appears whole, so this never sees half a file
        return self

    def log(self):
        with open(self.log_path, encoding="utf-8", errors="replace") as f:
            return f.read()

    def signal_and_wait(self, number):
        """Seconds until the plant has ended, and its exit status."""
        started = time.monotonic()
        self.process.send_signal(number)
        status = self.process.wait(timeout=30)
        return time.monotonic() - started, status

    def stop(self):
        if self.control:
            self.control.close()
            self.control = None
        if self.process and self.process.poll() is None:
            _, status = self.signal_and_wait(signal.SIGTERM)
            assert status == 0, f"exit status {status} after SIGTERM:\n{self.log()}"

    def __enter__(self):
        try:
            return self.start()
        except BaseException:
            self.__exit__(AssertionError, None, None)
            raise

    def __exit__(self, kind, value, trace):
        try:
            if kind is None:
                self.stop()
        finally:
            if self.process and self.process.poll() is None:
                self.process.kill()
                self.process.wait()
            if kind is not None:
                print(f"--- log of the plant ---\n{self.log()}--- end ---", flush=True)
            if self.own_folder:
                shutil.rmtree(self.folder, ignore_errors=True)

    def endpoint(self, drive, protocol):
        entry = next(d for d in self.ready["drives"] if d["name"] == drive)
        return next(e for e in entry["endpoints"] if e["protocol"] == protocol)

    def ctl(self, drive, command, *words):
        """One command on the control socket (JSON-RPC 2.0, one line each), in the words of `vinverter ctl`. drive: None for
        a command to the plant."""
        if not self.control:
            with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as connection:
                connection.settimeout(30)
                connection.connect(self.ready["control"])
                self.control = connection.makefile("rw", encoding="utf-8", newline="\n")
        params = {"drive": drive, "words": words} if drive else {}
        request = {"jsonrpc": "2.0", "id": 1, "method": command, "params": params}
        self.control.write(json.dumps(request) + "\n")
        self.control.flush()
        answer = json.loads(self.control.readline())
        if "error" in answer:
            raise ControlError(answer["error"]["message"])
        return answer["result"]

    def signals(self, drive):
        """The drive's named live values."""
        return {name: signal["value"] for name, signal in self.ctl(drive, "status")["signals"].items()}

    def power_off(self, drive):
        """Opens the drive's breaker and waits until its control supply, which lives on the DC link for a while, is gone."""
        self.ctl(drive, "power", "off")
        wait_until(lambda: not self.ctl(drive, "status")["ready"], 10, f"{drive} without control supply")

    def power_on(self, drive):
        """Closes the breaker and waits until the drive has started."""
        self.ctl(drive, "power", "on")
        wait_until(lambda: self.ctl(drive, "status")["ready"], 10, f"{drive} started")
