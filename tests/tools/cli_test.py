"""The command line answers what it cannot do with a sentence and exit code 2, and never hangs or crashes."""
import subprocess
import sys
import unittest

VINVERTER = sys.argv.pop(1)


def run(*words):
    done = subprocess.run([VINVERTER, *words], capture_output=True, text=True, timeout=20)
    return done.returncode, done.stdout, done.stderr


class WrongWords(unittest.TestCase):
    def refused(self, expected, *words):
        code, _, err = run(*words)
        self.assertEqual(code, 2, err)
        self.assertIn(expected, err)

    def test_an_unknown_command_is_named_with_what_is_allowed(self):
        self.refused('unknown command "rum"; allowed: run, ctl, scenario, campaign, doctor, params, schema', "rum")

    def test_a_duration_is_a_number_of_seconds_that_passes(self):
        for bad in ("0", "-1", "nan", "inf", "1e300", "ten"):
            self.refused("is no duration", "run", "--duration", bad)

    def test_a_folder_is_no_plant_file(self):
        self.refused("is a folder", "run", "/tmp")

    def test_an_unknown_option_is_named(self):
        self.refused("--bogus", "run", "--bogus")


class Parameters(unittest.TestCase):
    def test_a_number_with_two_halves_shows_both(self):
        for name in ("902", "Pr.902"):
            code, out, _ = run("params", "fr-e500", "--csv", name)
            self.assertEqual(code, 0)
            self.assertEqual([line.split(",")[0] for line in out.splitlines()[1:]], ["Pr.902.1", "Pr.902.2"])

    def test_a_number_shows_itself_only(self):
        _, out, _ = run("params", "fr-e500", "--csv", "7")
        self.assertEqual([line.split(",")[0] for line in out.splitlines()[1:]], ["Pr.7"])


if __name__ == "__main__":
    unittest.main()
