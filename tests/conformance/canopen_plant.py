"""Plants with boards on a CAN bus, and what is checked of every run: no malformed frame in its recording."""
import os

from canopen_master import Line
from plant import Plant
from recording import check_can_recording

DRIVE = """
  - name: {name}
    inverter: {{family: fr-e500, model: FR-E540-1.5K}}
    load: {{inertia_kg_m2: {inertia}, torque: {{constant_Nm: 1}}}}
    board: {{type: oi-fr-e5nco, node: {node}, network: line_can, modbus_rtu: none, modbus_tcp: "{modbus_tcp}"}}
"""
HEAVY, LIGHT = 0.05, 0.004  # kg m2; heavy: a stop in 1 s is an over-voltage


def plant_text(nodes, inertia=LIGHT, can="virtual", modbus_tcp="none"):
    """One bus at 125 kbit/s with a drive n<node> for each node."""
    servers = ', socketcand: "127.0.0.1:0", slcan: "127.0.0.1:0"' if can == "virtual" else ""
    drives = "".join(DRIVE.format(name=f"n{node}", node=node, inertia=inertia, modbus_tcp=modbus_tcp) for node in nodes)
    return f"""
name: canopen
networks:
  line_can: {{can: "{can}", bitrate: 125k{servers}, channel: line_can}}
drives:{drives}"""


class CanPlant(Plant):
    """A plant whose bus is recorded; when it has ended tshark reads the recording, if only good frames were sent."""

    def __init__(self, nodes, good_frames=True, **options):
        super().__init__(plant_text(nodes, **options), "--record-can", "wire.pcapng")
        self.first = f"n{min(nodes)}"
        self.good_frames = good_frames

    def line(self, interface):
        return Line.of(interface, self.endpoint(self.first, "canopen"))

    def stop(self):
        super().stop()
        if self.good_frames:
            check_can_recording(os.path.join(self.folder, "wire.pcapng"))
