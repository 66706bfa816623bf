"""The tables of scenarios/README.md are what `vinverter scenario list` says. With VINV_UPDATE set they are written anew."""
import os
import subprocess
import sys

VINVERTER, ROOT = sys.argv[1:3]
BEGIN = "<!-- scenario-list -->\n"
END = "<!-- end scenario-list -->"


def tables():
    done = subprocess.run([VINVERTER, "scenario", "list", "scenarios"], capture_output=True, text=True, timeout=60,
                          cwd=ROOT, check=True)
    folders = {}
    for line in done.stdout.splitlines():
        path, title = line.split("  ", 1)
        folder, name = path.removeprefix("scenarios/").rsplit("/", 1)
        folders.setdefault(folder, []).append((path.removeprefix("scenarios/"), name, title.strip()))
    out = ""
    for folder in sorted(folders):
        out += f"\n## {folder}\n\n| file | what it shows |\n| --- | --- |\n"
        for path, name, title in folders[folder]:
            assert title, path + " has no title"
            out += f"| [{name.removesuffix('.yaml')}]({path}) | {title.replace('|', '/')} |\n"
    return out + "\n"


readme = ROOT + "/scenarios/README.md"
with open(readme, encoding="utf-8") as f:
    text = f.read()
begin = text.index(BEGIN) + len(BEGIN)
now = text[:begin] + tables() + text[text.index(END):]
if now != text and os.environ.get("VINV_UPDATE"):
    with open(readme, "w", encoding="utf-8") as f:
        f.write(now)
elif now != text:
    print("scenarios/README.md is behind the scenarios; run this test with VINV_UPDATE=1")
    sys.exit(1)
