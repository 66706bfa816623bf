"""A program run from a shell, and what is expected of it."""
import subprocess
import sys

failures = 0


def run(*command, timeout, cwd=None):
    """Exit code, standard output, standard error."""
    done = subprocess.run(command, capture_output=True, text=True, timeout=timeout, cwd=cwd)
    return done.returncode, done.stdout, done.stderr


def expect(condition, what):
    global failures
    if not condition:
        failures += 1
        print("not so: " + what)


def finish():
    sys.exit(1 if failures else 0)
