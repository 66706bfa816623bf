"""99 nodes on one bus: all boot, answer SDO and guarding, obey a broadcast, and send a PDO each for one SYNC."""
from canopen_master import (GUARD, IS_OPERATIONAL, IS_PRE_OPERATIONAL, Node, PRE_OPERATIONAL, RESET_NODE, START)
from canopen_plant import CanPlant
from canopen_steps import is_remote
from plant import wait_until

NODES = range(1, 100)


def all_of(line, base, since, what):
    """One frame of each node; returns them and the position after the last."""
    frames = {}
    while len(frames) < len(NODES):
        frame, since = line.wait(lambda m: base < m.arbitration_id <= base + 99 and not m.is_remote_frame, since, what=what)
        number = frame.arbitration_id - base
        assert number not in frames, f"a second one of node {number}: {what}"
        frames[number] = frame
    return frames, since


def main():
    with CanPlant(NODES) as plant, plant.line("slcan") as line:
        nodes = [Node(line, number) for number in NODES]
        begin = since = line.now()
        line.nmt(RESET_NODE)
        boot_ups, _ = all_of(line, GUARD, since, "boot-up")
        assert all(bytes(m.data) == b"\0" for m in boot_ups.values())
        for node in nodes:
            assert node.read(0x100B) == node.number
            assert node.guard() == (0, IS_PRE_OPERATIONAL)
            node.set_tpdo1_type(1)  # with every SYNC
        line.nmt(START)
        for node in nodes:
            assert node.guard() == (1, IS_OPERATIONAL)
            wait_until(lambda: is_remote(node), 10, f"NET mode of node {node.number}")
        for _ in range(3):
            since = line.now()
            line.sync()
            told, since = all_of(line, 0x180, since, "PDO")
            order = list(told)
            # All wait for the bus at once, but for the first, which it may have taken before the others were ready.
            assert order[1:] == sorted(order[1:]), order
            assert all(len(m.data) == 8 for m in told.values())
            line.expect_silence(lambda m: 0x180 < m.arbitration_id <= 0x1E3, since, 0.1)
        line.nmt(PRE_OPERATIONAL)
        for node in nodes:
            assert node.guard() == (0, IS_PRE_OPERATIONAL)
        emergencies = [m for m in line.frames[begin:] if 0x80 < m.arbitration_id < 0x100]
        assert not emergencies, emergencies
        bus, = plant.ctl(None, "buses")
        assert bus["error_frames"] == 0 and bus["frames"] >= len(line.frames) + line.sent, bus
        assert [drive["state"] for drive in bus["drives"]] == ["error active"] * len(NODES), bus
        print({key: bus[key] for key in ("frames", "error_frames", "arbitrations_lost", "peak_load_percent")})


if __name__ == "__main__":
    main()
