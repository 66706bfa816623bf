"""npm st-ethernet-ip with its I/O scanner and explicit messages: run, ramp, stop, monitors, trip, fault reset, time-outs
with each Pr.502, two scanners that want the same drive, parameters and monitors by polled data. FR-A7NE manual, 4.5, 4.6
and 7. Usage: eip_story.py run|line_error|polled
"""
import sys
import time

from eip_masters import Node, PAIR_126, PAIR_129, PAIR_20, PAIR_21
from eip_plant import EipPlant, FOR_126, FOR_129, FOR_20, KEEP_OPTION
from plant import wait_until
from ramp import slope

CONTROL, REFERENCE, FORWARD, REVERSE, RESET, MRS, WRITE = 0x20, 0x40, 1, 2, 4, 0x80, 0x80
GO = CONTROL | REFERENCE | FORWARD
FAULTED, COMMANDS, RUNS_FORWARD, RUNS_REVERSE, READY, FROM_NET, REF_FROM_NET, AT_REFERENCE = (1 << n for n in range(8))
IDLE = READY | FROM_NET | REF_FROM_NET
SUPERVISOR, AC_DRIVE = 0x29, 0x2A
RPM_30_HZ = 900
TOLERANCE = 0.1


def bits_of(io, wanted, seconds=10, mask=0xFF):
    wait_until(lambda: io.data()[0] & mask == wanted & mask, seconds,
               f"status {wanted:02X}, it is {io.data().hex()}")


def ramp(read_rpm, target, seconds=10):
    samples, end = [], time.monotonic() + seconds
    while not samples or samples[-1][1] != target:
        samples.append((time.monotonic(), read_rpm()))
        assert samples[-1][0] < end, f"{target} r/min not within {seconds} s: {samples[-5:]}"
        time.sleep(0.004)
    return samples


def check_slope(samples, low, high, expected):
    measured = slope(samples, low, high)
    assert abs(measured / expected - 1) < TOLERANCE, f"{measured:.0f} r/min/s, expected {expected}"
    print(f"ramp {measured:.0f} r/min/s (expected {expected}, {len(samples)} samples)")


def run_by_io(plant, io, m):
    bits_of(io, IDLE | AT_REFERENCE, mask=IDLE)
    io.out_short(GO, RPM_30_HZ)
    check_slope(ramp(io.speed, RPM_30_HZ), 150, 800, 1500)  # 50 Hz, 1500 r/min, in 1 s
    bits_of(io, IDLE | RUNS_FORWARD | AT_REFERENCE)
    assert m.get(SUPERVISOR, 1, 6) == 4 and m.get(SUPERVISOR, 1, 7) == 1
    for path, name, scale in (((AC_DRIVE, 1, 9), "current", 10), ((AC_DRIVE, 1, 17), "voltage", 1),
                              ((0x80, 1, 12), "current", 100), ((AC_DRIVE, 1, 170), "frequency", 100)):
        wait_until(lambda: abs(m.get(*path) / scale - plant.signals("d1")[f"output_{name}"]) < 1.1 / scale + 0.02, 10,
                   f"{path} as the signal {name}")
    assert m.get(AC_DRIVE, 1, 7) == RPM_30_HZ and m.get(AC_DRIVE, 1, 114) & 0x800F == 0x800B
    io.out_short(CONTROL | REFERENCE | REVERSE, RPM_30_HZ)
    bits_of(io, IDLE | RUNS_REVERSE | AT_REFERENCE)
    io.out_short(CONTROL | REFERENCE, RPM_30_HZ)
    samples = ramp(io.speed, 0)
    check_slope(samples, 150, 800, -1500)
    bits_of(io, IDLE, mask=IDLE | RUNS_FORWARD | RUNS_REVERSE)


def run_by_explicit(m):
    def rpm():
        return m.get(AC_DRIVE, 1, 7)
    m.set(AC_DRIVE, 1, 18, 2400)  # ms: Pr.7 x Pr.1 / Pr.20 with Pr.1 = 120 Hz
    assert m.get(0x66, 1, 17) == 10, "Pr.7 in 0.1 s"
    m.set(AC_DRIVE, 1, 8, RPM_30_HZ)
    m.set(SUPERVISOR, 1, 3, 1, size=1)
    check_slope(ramp(rpm, RPM_30_HZ), 150, 800, 1500)
    m.set(AC_DRIVE, 1, 112, 1500)
    ramp(rpm, 450)
    m.set(SUPERVISOR, 1, 3, 0, size=1)
    wait_until(lambda: m.get(SUPERVISOR, 1, 6) == 3, 10, "Ready")
    m.set(AC_DRIVE, 1, 114, 4)  # STR
    ramp(rpm, 450)
    assert m.get(SUPERVISOR, 1, 8) == 1
    m.set(AC_DRIVE, 1, 114, 0)
    wait_until(lambda: m.get(SUPERVISOR, 1, 6) == 3, 10, "Ready")


def trip_and_reset(plant, io, m):
    """The fault reset bit acts when it comes, and not while it stays."""
    io.out_short(GO, RPM_30_HZ)
    wait_until(lambda: io.speed() == RPM_30_HZ, 10, "30 Hz")
    io.out_short(GO | RESET, RPM_30_HZ)
    wait_until(lambda: m.get_bytes(4, 21, 3)[0] == GO | RESET, 10, "the bit at the option")
    plant.ctl("d1", "fault", "E.OV1")
    bits_of(io, FAULTED | READY, mask=FAULTED | READY | RUNS_FORWARD)
    assert m.get(AC_DRIVE, 1, 141) == 0x20 and m.get(SUPERVISOR, 1, 10) == 1 and m.get(SUPERVISOR, 1, 6) == 7
    time.sleep(0.3)
    assert io.data()[0] & FAULTED, "the bit was there before the alarm"
    io.out_short(CONTROL)
    time.sleep(0.1)
    assert io.data()[0] & FAULTED
    packets = io.packets()
    io.out_short(CONTROL | RESET)
    bits_of(io, 0, mask=FAULTED)
    assert m.get(AC_DRIVE, 1, 141) == 0x20, "the history stays"
    status = m.set_status(AC_DRIVE, 1, 112, 3000)
    if status:  # about 1 s without control
        assert status == 0x10, hex(status)
    wait_until(lambda: m.set_status(AC_DRIVE, 1, 112, 3000) == 0, 10, "the end of the reset")
    assert io.packets() > packets, "the connection goes on (Pr.540)"
    m.set(AC_DRIVE, 1, 141, 0)
    assert m.get(AC_DRIVE, 1, 141) == 0


def owners(plant, io, m):
    """Two scanners want the drive: the first one has it until it closes; TCP may end before."""
    with Node(plant.other_master) as other:
        second = other.io("second", plant.host(), PAIR_21)
        second.out_short(GO, RPM_30_HZ)
        io.out_short(GO, RPM_30_HZ)
        wait_until(lambda: io.speed() == RPM_30_HZ, 10, "30 Hz by the first")
        assert not second.connected()
        io.drop()  # its TCP connection: I/O goes on
        packets = io.packets()
        wait_until(lambda: io.packets() > packets + 50, 10, "I/O without TCP")
        assert io.speed() == RPM_30_HZ and not second.connected()
        assert m.get(1, 1, 5) & 1, "owned"
        io.silent()  # its connection times out; Pr.502 = 3: the drive goes on
        second.wait()
        assert second.speed() == RPM_30_HZ
        second.out_short(CONTROL | REFERENCE, RPM_30_HZ)
        wait_until(lambda: second.data()[0] & RUNS_FORWARD == 0, 10, "stopped by the second")
        second.close()
        wait_until(lambda: m.get(1, 1, 5) & 1 == 0, 10, "nobody's")
        assert plant.alarm() == ""


def run():
    with EipPlant(42, [{540: KEEP_OPTION, 502: 3}]) as plant, Node(plant.master) as node:
        m = node.explicit("explicit", plant.host())
        io = node.io("io", plant.host(), PAIR_21).wait()
        run_by_io(plant, io, m)
        run_by_explicit(m)
        trip_and_reset(plant, io, m)
        owners(plant, io, m)
        plant.check_recording(explicit=200, io=1000)


def line_error():
    """4.5.1 for Pr.502 = 0 to 3 at once: a silent scanner, then one that is back."""
    modes = range(4)
    with EipPlant(43, [{502: mode, 500: 0.3} for mode in modes]) as plant, Node(plant.master) as node:
        names = [f"d{n + 1}" for n in modes]
        ios = [node.io(name, plant.host(n + 1), PAIR_21) for n, name in enumerate(names)]
        class3 = node.explicit("class3", plant.host(1), "class3")
        assert class3.get(SUPERVISOR, 1, 6) == 3
        for io in ios:
            io.wait()
            io.out_short(GO, RPM_30_HZ)
        for io in ios:
            wait_until(lambda io=io: io.speed() == RPM_30_HZ, 15, "30 Hz")
        # The class 3 connection of d1 has timed out by now (320 ms): no line error.
        assert [plant.alarm(n + 1) for n in modes] == [""] * 4
        for io in ios:
            io.silent()
        wait_until(lambda: plant.alarm(1) == "E.OP3", 10, "Pr.502 = 0 coasts with the alarm")
        wait_until(lambda: plant.alarm(2) == "E.OP3", 10, "Pr.502 = 1 stops, then the alarm")
        wait_until(lambda: plant.display(3) == "E.OP3" and plant.alarm(3) == "", 10, "Pr.502 = 2 stops without alarm")
        assert plant.display(4) == "30.00", "Pr.502 = 3 goes on"
        again = [node.io(f"{name}_again", plant.host(n + 1), PAIR_21) for n, name in enumerate(names)]
        for io in again:
            io.out_short(GO, RPM_30_HZ)
        for io in again:
            io.wait()
        for io in again[:2]:
            bits_of(io, FAULTED, mask=FAULTED | RUNS_FORWARD)
        for io, name in zip(again[2:], ("restarts", "goes on")):
            wait_until(lambda io=io: io.data()[0] & RUNS_FORWARD and io.speed() == RPM_30_HZ, 10, name)
        counted = [node.explicit(f"{name}_count", plant.host(n + 1)).get(0x67, 1, 193) for n, name in enumerate(names)]
        assert counted == [1] * 4, f"Pr.501 {counted}"
        plant.check_recording(explicit=20, io=800)


def polled():
    """126/176: parameters by polled data. 129/179: signals, monitors, Pr.496. 20/70: forward and speed alone."""
    with EipPlant(44, [{346: FOR_126}, {346: FOR_129, 6: 10}, {346: FOR_20}]) as plant, Node(plant.master) as node:
        io = node.io("d1", plant.host(1), PAIR_126).wait()
        m = node.explicit("explicit", plant.host(1))
        for pr, value in ((7, 25), (8, 35)):
            io.out(WRITE, value, 1, bytes([0x70, 10 + pr]))
            wait_until(lambda value=value: io.word(4) == value and not io.data()[1] & 0x80, 10, f"Pr.{pr} written")
            assert m.get(0x66, 1, 10 + pr) == value
        io.out(0, 0, 1, bytes([0x80, 18]))  # read only: the DC link
        wait_until(lambda: 5000 < io.word(4) < 6500, 10, "converter output voltage")
        io.out(GO, RPM_30_HZ, 1, bytes([0x80, 11]))
        wait_until(lambda: io.word(4) == 3000 and io.data()[0] & COMMANDS, 10, "30.00 Hz in the parameter data")

        io = node.io("d2", plant.host(2), PAIR_129).wait()
        io.out(CONTROL | FORWARD, 0, 0x04, bytes([0x01, 5]))  # RL: Pr.6; output frequency; Pr.496 = 5
        wait_until(lambda: io.word(4) == 1000 and io.speed() == 300, 10, "10 Hz by RL")
        plant.ctl("d2", "terminal", "AU=on")
        wait_until(lambda: io.data()[1] == 0x01, 10, "AU in the terminal monitor")
        assert node.explicit("of_d2", plant.host(2)).get(0x74, 1, 106) == 5, "Pr.496"
        io.out(CONTROL | FORWARD | MRS, 0, 0x04, bytes([0x08, 5]))
        wait_until(lambda: not io.data()[0] & RUNS_FORWARD and 5000 < io.word(4) < 6500, 10, "MRS; DC link")

        io = node.io("d3", plant.host(3), PAIR_20).wait()
        io.out_short(FORWARD, RPM_30_HZ)
        wait_until(lambda: io.data()[:2] == bytes([RUNS_FORWARD, 0]) and io.speed() == RPM_30_HZ, 10, "30 Hz by 20")
        io.close()
        plant.check_recording(explicit=10, io=200)


if __name__ == "__main__":
    {"run": run, "line_error": line_error, "polled": polled}[sys.argv[1]]()
