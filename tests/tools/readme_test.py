"""The commands that README.md and the scripts name exist and can be executed."""
import os
import re
import subprocess
import unittest

ROOT = os.path.realpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))


def read(path):
    with open(os.path.join(ROOT, path), encoding="utf-8") as f:
        return f.read()


class Readme(unittest.TestCase):
    def assert_executable(self, path):
        full = os.path.join(ROOT, path)
        self.assertTrue(os.path.isfile(full) and os.access(full, os.X_OK), f"{path} is not an executable file")

    def test_first_screen_names_the_two_commands(self):
        first_screen = read("README.md").splitlines()[:40]
        for command in ("tools/run", "tools/test"):
            self.assertTrue(any(line.startswith(command) for line in first_screen), command)

    def test_commands_in_code_blocks_exist(self):
        commands = set()
        for block in re.findall(r"^```\w*\n(.*?)^```", read("README.md"), re.MULTILINE | re.DOTALL):
            commands.update(re.findall(r"^(?:\$ )?((?:tools|\.ci)/[\w./-]+)", block, re.MULTILINE))
        self.assertLessEqual({"tools/run", "tools/test"}, commands)
        for command in commands:
            self.assert_executable(command)

    def test_plant_files_that_are_named_exist(self):
        for path in set(re.findall(r"\bscenarios/[\w./-]+\.yaml", read("README.md") + read("tools/run"))):
            self.assertTrue(os.path.isfile(os.path.join(ROOT, path)), path)

    def test_continuous_integration_calls_the_same_script(self):
        self.assert_executable(".ci/run")
        self.assertIn("/tools/test", read(".ci/run"))

    def test_scripts_are_valid_and_reject_nonsense(self):
        for script in ("tools/run", "tools/test", "tools/build", "tools/install-deps", "tools/check.sh", ".ci/run"):
            self.assert_executable(script)
            subprocess.run(["bash", "-n", os.path.join(ROOT, script)], check=True)
        for script in ("tools/install-deps", "tools/build"):
            result = subprocess.run([os.path.join(ROOT, script)], capture_output=True, text=True)
            self.assertEqual(result.returncode, 2)
            self.assertIn("Usage", result.stderr)


if __name__ == "__main__":
    unittest.main()
