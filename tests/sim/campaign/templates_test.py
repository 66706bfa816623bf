"""The shipped campaign through GNU parallel, and the shell part of the other templates with the variables of their batch
engines: all give the same merged bytes as one run in one piece."""
import os
import subprocess
import sys
import tempfile

import yaml

VINVERTER, ROOT = sys.argv[1:3]
CAMPAIGN = ROOT + "/scenarios/campaigns/deceleration_ov3.yaml"
MERGED = ["deceleration_ov3.csv", "deceleration_ov3.html", "deceleration_ov3.junit.xml"]
failures = 0


def expect(condition, what):
    global failures
    if not condition:
        failures += 1
        print("not so: " + what)


def run(*args, **env):
    done = subprocess.run(args, capture_output=True, text=True, timeout=280, env={**os.environ, **env})
    return done.returncode, done.stdout, done.stderr


def merged(folder):
    texts = []
    for name in MERGED:
        with open(f"{folder}/{name}", "rb") as f:
            texts.append(f.read())
    return texts


with tempfile.TemporaryDirectory() as folder:
    programs = folder + "/bin"
    os.mkdir(programs)
    os.symlink(VINVERTER, programs + "/vinverter")
    path = programs + ":" + os.environ["PATH"]

    code, out, err = run(ROOT + "/tools/campaign/parallel.sh", CAMPAIGN, folder + "/parallel", "5", "--jobs", "2", VINVERTER=VINVERTER)
    expect(code == 1, f"some cases fail, and all have a result: {code} {out} {err}")
    expect("42 cases: " in out and ", 0 could not run, 0 crashed, 0 without result" in out, out)
    code, out, err = run(ROOT + "/tools/campaign/parallel.sh", CAMPAIGN, folder + "/parallel", "3", VINVERTER=VINVERTER)
    expect(code == 1 and "14 had one before" in err, f"nothing is run twice: {code} {err}")
    with open(folder + "/parallel/deceleration_ov3.csv", encoding="utf-8") as f:
        rows = [line.split(",") for line in f.read().splitlines()[1:]]
    alarms = {row[2] for row in rows if row[1] == "failed"}
    expect(alarms == {"E.OV3"}, f"what fails is over-voltage during deceleration: {alarms}")
    expect(any(row[1] == "passed" for row in rows), "some pass")

    # The finished results stand in for the cases that a shard runs: copies, a few of them taken away.
    results = folder + "/slurm"
    os.mkdir(results)
    with open(folder + "/all", "w", encoding="utf-8") as everything:
        for name in sorted(os.listdir(folder + "/parallel")):
            if name.endswith(".jsonl"):
                with open(f"{folder}/parallel/{name}", encoding="utf-8") as f:
                    everything.write(f.read())
    with open(folder + "/all", encoding="utf-8") as f:
        lines = f.read().splitlines()
    taken = [line for line in lines if any(line.startswith(f'{{"case":{k},') for k in (1, 2, 31, 32))]
    expect(len(taken) == 4, "four lines are taken away")
    with open(results + "/earlier.jsonl", "w", encoding="utf-8") as f:
        f.write("".join(line + "\n" for line in lines if line not in taken))

    code, out, err = run(ROOT + "/tools/campaign/slurm.sh", CAMPAIGN, results, PATH=path, SLURM_ARRAY_TASK_ID="7",
                         SLURM_ARRAY_TASK_MIN="7", SLURM_ARRAY_TASK_COUNT="2", SLURM_CPUS_PER_TASK="2")
    expect(code == 0 and "shard 1/2: 21 of 42" in out and "19 had one before" in out, f"Slurm: {code} {out} {err}")
    with open(ROOT + "/tools/campaign/kubernetes.yaml", encoding="utf-8") as f:
        job = yaml.safe_load(f)
    container = job["spec"]["template"]["spec"]["containers"][0]
    env = {e["name"]: e["value"] for e in container["env"]}
    expect(env["SHARDS"] == str(job["spec"]["completions"]), "as many shards as completions")
    expect(env["CAMPAIGN"].endswith(CAMPAIGN[len(ROOT):]), "the campaign is a shipped one")
    script = container["args"][0].replace("/results", results)
    code, out, err = run(*container["command"], script, PATH=path, JOB_COMPLETION_INDEX="1", SHARDS="2", CAMPAIGN=CAMPAIGN)
    expect(code == 0 and "shard 2/2: 21 of 42" in out and "19 had one before" in out, f"Kubernetes: {code} {out} {err}")

    code, out, err = run(VINVERTER, "campaign", "merge", CAMPAIGN, "--out", results)
    expect(merged(results) == merged(folder + "/parallel"), "the same bytes whatever ran the shards")
sys.exit(1 if failures else 0)
