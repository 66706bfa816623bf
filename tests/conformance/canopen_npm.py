"""npm canopen as the master of a live node: canopen_node_master.js."""
import os
import subprocess

from canopen_plant import CanPlant, HEAVY
from plant import HERE


def main():
    with CanPlant([5], inertia=HEAVY) as plant:
        host, _, port = plant.endpoint("n5", "canopen")["slcan"].rpartition(":")
        subprocess.run(["node", os.path.join(HERE, "canopen_node_master.js"), host, port, "5"], check=True, timeout=120)


if __name__ == "__main__":
    main()
