"""The whole story with one foreign master over one wire: find, configure, run, load, trip, reset, power cycle.

Usage: story.py pymodbus|mbpoll|libmodbus|modbus-serial tcp|rtu
Registers: OI-FR-E5NCO manual, 8.7. Raw 0.1 s for Pr.7 and Pr.8, 0.01 Hz for frequencies, 0.01 A, 0.1 V.
"""
import os
import sys
import time

from drip import Drip
from masters import MASTERS, ModbusException, Silence
from plant import Plant, wait_until
from ramp import slope
from recording import check_recording

PLANT = """
name: story
networks:
  can0: {can: virtual, socketcand: "127.0.0.1:0"}
drives:
  - name: mill
    inverter: {family: fr-e500, model: FR-E540-1.5K}
    load: {inertia_kg_m2: 0.05, torque: {constant_Nm: 2}}
    board: {type: oi-fr-e5nco, node: 5, modbus_rtu: pty, modbus_tcp: "127.0.0.1:0"}
"""
DRIVE = "mill"

NET, COMMAND, FREQUENCY, RESET = 26000, 24000, 24002, 25002
STATUS, ALARMS, OUTPUT_FREQUENCY = 24000, 23000, 23100
STOP, FORWARD = 1, 2
RUN_BIT, FORWARD_BIT, UP_TO_FREQUENCY_BIT, ALARM_BIT = 0x01, 0x02, 0x08, 0x80
E_OV3 = 0x22
LIVE_TOLERANCE = 0.05


def parameter(number):
    return 20000 + 2 * number


def expect_exception(code, call, *arguments):
    try:
        answer = call(*arguments)
    except ModbusException as refusal:
        assert refusal.code == code, f"{call.__name__}{arguments}: exception {refusal.code}, expected {code}"
        return
    raise AssertionError(f"{call.__name__}{arguments}: {answer}, expected exception {code}")


def expect_silence(call, *arguments):
    try:
        answer = call(*arguments)
    except Silence:
        return
    raise AssertionError(f"{call.__name__}{arguments} was answered: {answer}")


def answered(master, address):
    """The register, or None while the drive is without power, starting up or resetting."""
    try:
        return master.read(address)
    except (ModbusException, Silence):
        return None


def sample_ramp(master, target, timeout):
    """(seconds, output frequency in Hz) until the target is reached; the time is the middle of the request."""
    samples = []
    deadline = time.monotonic() + timeout
    while not samples or samples[-1][1] < target:
        asked = time.monotonic()
        value = master.read(OUTPUT_FREQUENCY)[0] / 100
        samples.append(((asked + time.monotonic()) / 2, value))
        assert samples[-1][0] < deadline, f"{target} Hz not within {timeout} s: {samples[-5:]}"
        time.sleep(0.005)
    return samples


def refusals(m):
    expect_exception(1, m.read_input, STATUS)                 # only functions 03 and 06
    expect_exception(2, m.read, 30000)                        # 8.8.1
    expect_exception(2, m.read, parameter(7) + 1)             # odd
    expect_exception(2, m.read, parameter(902))               # 8.7.1
    expect_exception(3, m.write, NET, 3)                      # 8.8.2
    expect_exception(5, m.write, COMMAND, FORWARD)            # not in NET mode
    assert m.read(parameter(1)) == [12000], "Pr.1 as delivered; reading needs no NET mode"


def configure(m):
    m.write(NET, 1)
    m.write(parameter(7), 30)
    m.write(parameter(8), 10)
    assert m.read(parameter(7), 2) == [30, 10], "two items: the second is two addresses on"
    expect_exception(3, m.write, parameter(7), 65000)         # out of range
    m.write(FREQUENCY, 4000)
    assert m.read(FREQUENCY) == [0], "what runs, not what is set (8.7.6)"


def run_up(m):
    """The ramp in its time: Pr.7 is the time from 0 to Pr.20."""
    reference_hz = m.read(parameter(20))[0] / 100
    m.write(COMMAND, FORWARD)
    samples = sample_ramp(m, 40, timeout=20)
    measured, expected = slope(samples, 5, 35), reference_hz / 3.0
    assert abs(measured / expected - 1) < LIVE_TOLERANCE, f"{measured} Hz/s, expected {expected}"
    status = wait_until(lambda: (s := m.read(STATUS)[0]) & UP_TO_FREQUENCY_BIT and s, 5, "up to frequency")
    assert status & (RUN_BIT | FORWARD_BIT | ALARM_BIT) == RUN_BIT | FORWARD_BIT, hex(status)
    frequency, current, voltage = m.read(OUTPUT_FREQUENCY, 3)
    assert frequency == 4000
    assert 80 <= current <= 380, f"{current / 100} A for a lightly loaded 1.5 kW motor"
    assert 2900 <= voltage <= 3600, f"{voltage / 10} V at 40 Hz of 400 V at 50 Hz"
    print(f"ramp {measured:.2f} Hz/s (expected {expected:.2f}, {len(samples)} samples), "
          f"{current / 100:.2f} A, {voltage / 10:.1f} V")


def load_step(m, plant):
    """Slip: the speed falls below synchronous, and more so under load; the current rises."""
    synchronous = 60 * 40 / 2

    def settled():
        before = plant.signals(DRIVE)["speed"]
        time.sleep(0.15)
        now = plant.signals(DRIVE)["speed"]
        return now if abs(now - before) < 0.5 else None

    light, light_current = wait_until(settled, 10, "steady speed"), m.read(23102)[0]
    plant.ctl(DRIVE, "load", "torque", "8 Nm")
    time.sleep(0.2)
    heavy, heavy_current = wait_until(settled, 10, "steady speed under load"), m.read(23102)[0]
    print(f"slip {synchronous - light:.1f} rpm at {light_current / 100:.2f} A, under load {synchronous - heavy:.1f} rpm "
          f"at {heavy_current / 100:.2f} A")
    assert synchronous - 40 < light < synchronous
    assert synchronous - 150 < heavy < light - 15
    assert heavy_current > light_current + 30
    assert m.read(OUTPUT_FREQUENCY) == [4000]
    plant.ctl(DRIVE, "load", "torque", "2 Nm")
    wait_until(settled, 10, "steady speed again")


def trip_and_reset(m, plant):
    """A stop in 1 s with fifteen times the motor's inertia and no brake resistor."""
    m.write(COMMAND, STOP)
    status = wait_until(lambda: (s := m.read(STATUS)[0]) & ALARM_BIT and s, 5, "the alarm bit")
    assert not status & RUN_BIT, hex(status)
    assert m.read(ALARMS)[0] == E_OV3, f"{m.read(ALARMS)[0]:04X}"
    assert m.read(OUTPUT_FREQUENCY) == [0]
    wait_until(lambda: abs(plant.signals(DRIVE)["speed"]) < 1, 30, "coasting to a stop")
    m.write(RESET, 0)
    expect_exception(4, m.read, STATUS)                       # the dead time after a reset
    status = wait_until(lambda: (s := answered(m, STATUS)) and not s[0] & ALARM_BIT and s, 10, "the end of the reset")
    assert m.read(ALARMS)[0] & 0xFF == E_OV3, "a reset keeps the history"


def run_again(m):
    m.write(NET, 1)
    m.write(parameter(8), 30)
    m.write(FREQUENCY, 1500)
    m.write(COMMAND, FORWARD)
    sample_ramp(m, 15, timeout=10)
    m.write(COMMAND, STOP)
    wait_until(lambda: not m.read(STATUS)[0] & RUN_BIT, 10, "the stop")
    assert not m.read(STATUS)[0] & ALARM_BIT
    assert m.read(ALARMS)[0] == E_OV3, "no second alarm"


def power_cycle(m, plant):
    """EEPROM values come back, values written to RAM only (Pr.342 = 1) do not. Off is silence, start-up exception 04."""
    m.write(parameter(342), 1)
    m.write(parameter(7), 77)
    assert m.read(parameter(7)) == [77]
    plant.power_off(DRIVE)
    if m.tcp:
        expect_exception(11, m.read, STATUS)                  # the gateway's answer for a device that is not there
    else:
        expect_silence(m.read, STATUS)
    plant.ctl(DRIVE, "power", "on")
    seen = set()

    def started():
        try:
            return m.read(parameter(7))
        except (ModbusException, Silence) as outcome:
            seen.add(getattr(outcome, "code", None))
            return None

    wait_until(started, 10, "the start-up")
    assert seen <= {None, 4, 11}, f"start-up answered with exceptions {seen}"
    assert m.read(parameter(7), 2) == [30, 30]


def main():
    master_name, wire = sys.argv[1:]
    recording = ["--record-ip", "wire.pcapng"] if wire == "tcp" else []
    with Plant(PLANT, *recording) as plant:
        endpoint = plant.endpoint(DRIVE, f"modbus-{wire}")
        drip = Drip(endpoint) if wire == "tcp" else None
        with MASTERS[master_name](endpoint) as m:
            refusals(m)
            configure(m)
            run_up(m)
            load_step(m, plant)
            trip_and_reset(m, plant)
            run_again(m)
            power_cycle(m, plant)
        if drip:
            drip.close()
        plant.stop()
        if wire == "tcp":
            check_recording(os.path.join(plant.folder, "wire.pcapng"), endpoint["port"], m.requests)


if __name__ == "__main__":
    main()
