"""Bad input to the executable, end to end: what it says, its exit status, and that it stops when told."""
import glob
import os
import re
import signal
import socket
import subprocess
import tempfile
import unittest

from masters import Pymodbus
from plant import VINVERTER, Plant, wait_until
from story import NET, answered, parameter

DRIVE = """
name: bad
networks:
  can0: {can: virtual, socketcand: "127.0.0.1:0"}
drives:
  - name: mill
    board: {node: 5, modbus_rtu: none, modbus_tcp: "127.0.0.1:PORT"}
"""


def run(*arguments, folder, **environment):
    return subprocess.run([VINVERTER, *arguments], capture_output=True, text=True, timeout=60, cwd=folder,
                          env={**os.environ, "XDG_STATE_HOME": folder, **environment})


class BadInput(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory(prefix="vinv-")
        self.folder = self.temporary.name
        self.addCleanup(self.temporary.cleanup)

    def plant_file(self, text):
        path = os.path.join(self.folder, "plant.yaml")
        with open(path, "w", encoding="utf-8") as f:
            f.write(text)
        return path

    def assert_refused(self, text, line, *words):
        """Exit status 2, one line that names file and line, and no ready file."""
        path = self.plant_file(text)
        ready = os.path.join(self.folder, "ready.json")
        done = run("run", path, "--ready-file", ready, folder=self.folder)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertRegex(done.stderr, rf"plant\.yaml:{line}:\d+: ")
        for word in words:
            self.assertIn(word, done.stderr)
        self.assertFalse(os.path.exists(ready))

    def test_plant_file_mistakes(self):
        self.assert_refused("drives:\n  - name: a\n    moter: {}\n", 3, "moter", "motor")
        self.assert_refused("drives:\n  - inverter: {family: fr-e500, model: FR-E540-1.6K}\n", 2, "FR-E540-1.5K")
        self.assert_refused("drives:\n  - name: a\n    motor: {preset: no_such_motor}\n", 3, "no_such_motor")
        self.assert_refused("drives:\n  - name: a\n    parameters: {Pr.7: 5000}\n", 3, "Pr.7", "3600")
        self.assert_refused("drives:\n  - name: a\n    load: {inertia_kg_m2: -1}\n", 3, "inertia_kg_m2")
        self.assert_refused("drives:\n  - name: a\n  - name: a\n", 3, "taken")
        self.assert_refused("drives: [\n", 2, "YAML")

    def test_plant_file_that_is_not_there(self):
        done = run("run", "nowhere.yaml", folder=self.folder)
        self.assertEqual(done.returncode, 2)
        self.assertIn("nowhere.yaml", done.stderr)

    def test_wrong_command_line(self):
        for arguments in ([], ["no-such-command"], ["run", "x.yaml", "--no-such-option"]):
            done = run(*arguments, folder=self.folder)
            self.assertNotEqual(done.returncode, 0)
            self.assertIn("--help", done.stderr)

    def test_port_in_use(self):
        with socket.create_server(("127.0.0.1", 0)) as taken:
            port = taken.getsockname()[1]
            done = run("run", self.plant_file(DRIVE.replace("PORT", str(port))), folder=self.folder)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn(str(port), done.stderr)
        self.assertRegex(done.stderr, "in use")

    def test_signals_stop_the_plant(self):
        for number in (signal.SIGTERM, signal.SIGINT):
            with Plant(DRIVE.replace("PORT", "0")) as plant:
                connection = socket.create_connection(("127.0.0.1", plant.endpoint("mill", "modbus-tcp")["port"]))
                seconds, status = plant.signal_and_wait(number)
                self.assertEqual(status, 0, plant.log())
                self.assertLess(seconds, 5)  # promised: within one
                connection.close()

    def damaged_eeprom(self, damage):
        """Starts, stores a parameter, stops, damages the file, starts again: E.PE, and the damaged file is kept."""
        with Plant(DRIVE.replace("PORT", "0"), folder=self.folder) as plant:
            with Pymodbus(plant.endpoint("mill", "modbus-tcp")) as m:
                m.write(NET, 1)
                m.write(parameter(7), 123)
        files = [f for f in glob.glob(os.path.join(self.folder, "state", "**", "*"), recursive=True) if os.path.isfile(f)]
        eeprom = [f for f in files if re.search(r"mill", os.path.basename(f))]
        self.assertEqual(len(eeprom), 1, files)
        with open(eeprom[0], "rb") as f:
            content = f.read()
        bad = damage(content)
        self.assertNotEqual(bad, content)
        with open(eeprom[0], "wb") as f:
            f.write(bad)

        with Plant(DRIVE.replace("PORT", "0"), folder=self.folder) as plant:
            self.assertIn(os.path.basename(eeprom[0]), plant.log())
            with Pymodbus(plant.endpoint("mill", "modbus-tcp")) as m:
                status = wait_until(lambda: answered(m, 24000), 10, "the start-up")
                self.assertTrue(status[0] & 0x80, "alarm bit")
                self.assertEqual(m.read(23000)[0] & 0xFF, 0xB0, "E.PE")
                self.assertNotEqual(m.read(parameter(7)), [123])
        kept = []
        for path in glob.glob(os.path.join(self.folder, "state", "**", "*"), recursive=True):
            if os.path.isfile(path):
                with open(path, "rb") as f:
                    kept.append(f.read())
        self.assertIn(bad, kept, "the damaged file is kept aside as it was")

    def test_truncated_eeprom(self):
        self.damaged_eeprom(lambda content: content[:len(content) // 2])

    def test_bit_flipped_eeprom(self):
        def flip(content):
            at = content.index(b"12.3") + 1
            return content[:at] + bytes([content[at] ^ 1]) + content[at + 1:]
        self.damaged_eeprom(flip)


if __name__ == "__main__":
    unittest.main()
