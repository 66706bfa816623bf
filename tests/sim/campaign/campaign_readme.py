"""The campaign session in README.md prints, byte for byte, what it shows."""
import difflib
import os
import re
import subprocess
import sys
import tempfile

VINVERTER, ROOT = sys.argv[1:3]
with open(ROOT + "/README.md", encoding="utf-8") as f:
    session = re.search(r"<!-- campaign session -->\n```console\n(.*?)^```", f.read(), re.MULTILINE | re.DOTALL).group(1)
commands = [line[2:] for line in session.splitlines() if line.startswith("$ ")]
shown = [line for line in session.splitlines() if not line.startswith("$ ")]
assert len(commands) >= 3 and len(shown) > len(commands), session
with tempfile.TemporaryDirectory() as folder:
    # Paths as in the README, seen from a folder of its own.
    os.symlink(ROOT + "/scenarios", folder + "/scenarios")
    script = "\n".join(commands).replace("build/run/vinverter", VINVERTER)
    done = subprocess.run(["bash", "-e"], input=script, capture_output=True, text=True, timeout=200, cwd=folder)
    seen = done.stdout.splitlines()
if done.returncode != 0 or seen != shown:
    print(done.returncode, done.stderr)
    print("\n".join(difflib.unified_diff(shown, seen, "README.md", "seen", lineterm="")))
    sys.exit(1)
