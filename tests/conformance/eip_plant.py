"""FR-A700 drives with FR-A7NE. Each test has a part of the loopback network of its own, so that tests run side by side:
masters are at 127.0.PART.1 and 127.0.PART.101, drive n at 127.0.PART.(1 + n)."""
import os

from plant import Plant
from recording import check_eip_recording

DRIVE = """
  - name: d{n}
    inverter: {{family: fr-a700, model: FR-A740-1.5K}}
    load: {{inertia_kg_m2: {inertia}}}
    board: {{type: fr-a7ne, address: 127.0.{part}.{host}, timing: {timing}}}
    parameters: {{Pr.3: 50, Pr.20: 50, Pr.340: 10, {parameters}}}
"""
KEEP_OPTION = 2048  # Pr.540: the option outlives a reset of the inverter
FOR_20, FOR_126, FOR_129 = 0, 792, 924  # Pr.346


class EipPlant(Plant):
    """drives: a dict of parameters (number to value) for each. Records what goes over its wires and has tshark look at it
    when it ends."""

    def __init__(self, part, drives, timing="real", inertia=0.005):
        text = f"name: eip{part}\ndrives:"
        for n, parameters in enumerate(drives, 1):
            words = ", ".join(f"Pr.{number}: {value}" for number, value in
                              {7: 1, 8: 1, **parameters}.items())
            text += DRIVE.format(n=n, part=part, host=n + 1, timing=timing, inertia=inertia, parameters=words)
        super().__init__(text, "--record-ip", "wire.pcapng")
        self.part = part
        self.master, self.other_master = f"127.0.{part}.1", f"127.0.{part}.101"

    def host(self, n=1):
        endpoint = self.endpoint(f"d{n}", "ethernet-ip")
        assert (endpoint["host"], endpoint["tcp"], endpoint["udp_io"]) == (f"127.0.{self.part}.{n + 1}", 44818, 2222)
        return endpoint["host"]

    def display(self, n=1):
        return self.ctl(f"d{n}", "status")["display"]

    def alarm(self, n=1):
        return (self.ctl(f"d{n}", "status")["alarm"] or {}).get("name", "")

    def check_recording(self, explicit, io):
        """Stops the plant. At least so many explicit packets and I/O packets are in its recording."""
        self.stop()
        check_eip_recording(os.path.join(self.folder, "wire.pcapng"), explicit, io)
