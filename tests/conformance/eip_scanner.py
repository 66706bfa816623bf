"""Our own scanner, eip_scanner_story.cpp, against a live plant of three drives."""
import os
import subprocess

from eip_plant import EipPlant


def main():
    with EipPlant(45, [{502: 3}, {}, {}]) as plant:
        hosts = [plant.host(n) for n in (1, 2, 3)]
        subprocess.run([os.environ["EIP_SCANNER_STORY"], hosts[0], plant.master, plant.other_master, ",".join(hosts)],
                       check=True, timeout=120)
        assert plant.alarm() == ""
        plant.check_recording(explicit=50, io=800)


if __name__ == "__main__":
    main()
