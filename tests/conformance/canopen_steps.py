"""What a master does with an OI-FR-E5NCO on CANopen, step by step, as the stories over each wire put it together.

OI-FR-E5NCO manual: 4.2 operation modes, 6 communication profile, 7 device profile.
"""
import struct

from canopen_master import (Abort, IS_OPERATIONAL, IS_PRE_OPERATIONAL, IS_STOPPED, NOT_VALID, PRE_OPERATIONAL,
                            RESET_COMMUNICATION, START, STOP)
from plant import wait_until
from ramp import slope

COMMAND, RESET_INVERTER, NEWEST_ALARMS = 0x4000, 0x2107, 0x3400
OUTPUT_FREQUENCY, OUTPUT_CURRENT = 0x2000, 0x2001
CONTROLWORD, STATUSWORD, TARGET_VELOCITY, ABORT_OPTION = 0x6040, 0x6041, 0x6042, 0x6007
GUARD_TIME, LIFE_TIME_FACTOR = 0x100C, 0x100D
BIT_STOP, BIT_STF, BIT_RUN, BIT_FORWARD, BIT_UP_TO_FREQUENCY, BIT_ALARM = 1, 2, 1, 2, 8, 0x80
REMOTE, TARGET_REACHED = 1 << 9, 1 << 10
STATE_MASK = 0x6F
SWITCH_ON_DISABLED, READY_TO_SWITCH_ON, SWITCHED_ON, OPERATION_ENABLED, QUICK_STOP_ACTIVE, FAULT = (
    0x40, 0x21, 0x23, 0x27, 0x07, 0x08)
SHUTDOWN, SWITCH_ON, ENABLE_OPERATION, QUICK_STOP = 6, 7, 0xF, 2
E_OV3 = 0x22
NO_LOCAL_CONTROL, NOT_NOW = 0x08000021, 0x08000022
EMERGENCY_DELAY = 0.040  # seconds; 7.1.1


def words(message):
    return struct.unpack(f"<{len(message.data) // 2}H", bytes(message.data))


def is_remote(node):
    return bool(node.read(STATUSWORD) & REMOTE)


def boots(line, node, plant, drive):
    """Found by its boot-up, at power-on and when NMT asks for it."""
    since = line.now()
    plant.power_off(drive)
    plant.power_on(drive)
    node.wait_boot_up(since)
    since = line.now()
    node.nmt(RESET_COMMUNICATION)
    node.wait_boot_up(since)
    assert node.read(0x1000) == 0x10192, "a frequency converter by DSP-402"
    assert node.read(0x100B) == node.number
    assert node.read_bytes(0x1008) == b"E5NC"


def is_refused_outside_net(node):
    """The command right is not the network's yet."""
    assert not is_remote(node)
    node.expect_abort(NO_LOCAL_CONTROL, node.parameter, 7, 20)
    node.expect_abort(NO_LOCAL_CONTROL, node.write, COMMAND, 0, BIT_STF)


def watches(node, inhibit=50, watched=2):
    """TPDO `watched` tells status, output frequency, current and the statusword whenever one of them changes."""
    return node.map_pdo("transmit", watched, [(COMMAND, 0, 16), (OUTPUT_FREQUENCY, 0, 16), (OUTPUT_CURRENT, 0, 16),
                                              (STATUSWORD, 0, 16)], 255, inhibit)


def goes_operational(node):
    node.nmt(START)
    wait_until(lambda: is_remote(node), 10, "NET mode")


def sets_ramps(node, up_s, down_s):
    node.parameter(7, round(up_s * 10))
    node.parameter(8, round(down_s * 10))
    assert (node.read(0x3007), node.read(0x3008)) == (round(up_s * 10), round(down_s * 10))


def command(line, node, bits, raw_hz):
    """RPDO1 as delivered."""
    line.send(0x200 + node.number, struct.pack("<HHHH", bits, raw_hz, 0, 0))


def runs_by_pdo(line, node, told, seconds_to_reference, raw_hz=4000):
    """Runs forward; the ramp goes from 0 to Pr.20 in Pr.7. Returns its slope as a part of what it should be."""
    reference_hz = node.read(0x3000 + 20) / 100
    since = line.now()
    command(line, node, BIT_STF, raw_hz)
    done, _ = line.wait(lambda m: m.arbitration_id == told and words(m)[0] & BIT_UP_TO_FREQUENCY
                        and words(m)[1] == raw_hz, since, timeout=30, what="up to frequency")
    assert words(done)[0] & (BIT_RUN | BIT_FORWARD | BIT_ALARM) == BIT_RUN | BIT_FORWARD
    return ramp(line, told, since, reference_hz / seconds_to_reference, raw_hz / 100)


def ramp(line, told, since, expected, top_hz):
    """The slope between 10 and 90 % as a part of the expected one, which is in Hz/s, negative for a deceleration."""
    samples = [(m.timestamp, words(m)[1] / 100) for m in line.frames[since:] if m.arbitration_id == told]
    measured = slope(samples, 0.1 * top_hz, 0.9 * top_hz)
    print(f"ramp {measured:.2f} Hz/s, expected {expected:.2f}, {len(samples)} samples")
    return measured / expected


def is_about(value, expected, tolerance):
    """tolerance: as a part of what is expected."""
    return abs(value / expected - 1) < tolerance


def trips(line, node, told):
    """A stop too short for the inertia: E.OV3, told at once in the status and 40 ms later by the emergency. Returns the
    seconds between the two."""
    since = line.now()
    command(line, node, BIT_STOP, 0)
    status, _ = line.wait(lambda m: m.arbitration_id == told and words(m)[0] & BIT_ALARM, since, what="the alarm bit")
    emergency, _ = node.wait_emergency(since)
    assert bytes(emergency.data) == bytes([0x10, 0x32, 0x05, 0, E_OV3, IS_OPERATIONAL, 0, 0]), emergency.data.hex()
    assert node.read(NEWEST_ALARMS) & 0xFF == E_OV3
    assert node.read(0x1001) == 0x05
    assert node.read(STATUSWORD) & STATE_MASK == FAULT
    assert words(status)[3] & STATE_MASK == FAULT
    return emergency.timestamp - status.timestamp


def coasts_down(plant, drive):
    """The motor comes to a stop without the inverter, which a heavy load hastens."""
    plant.ctl(drive, "load", "torque", "12 Nm")
    wait_until(lambda: abs(plant.signals(drive)["speed"]) < 1, 30, "coasting to a stop")
    plant.ctl(drive, "load", "torque", "1 Nm")


def is_reset(line, node, newest=E_OV3):
    """By 2107H; a reset ends NET mode, so NMT has to start the node again."""
    since = line.now()
    node.write(RESET_INVERTER, 0, 0)
    emergency, _ = node.wait_emergency(since)
    assert bytes(emergency.data) == bytes([0, 0, 0, 0, 0, IS_OPERATIONAL, 0, 0]), emergency.data.hex()
    wait_until(lambda: node.read(STATUSWORD) & STATE_MASK == SWITCH_ON_DISABLED, 10, "the end of the fault")
    wait_until(lambda: readable(node, NEWEST_ALARMS), 10, "the end of the reset")
    assert node.read(NEWEST_ALARMS) & 0xFF == newest, "a reset keeps the history"
    assert node.read(0x1001) == 0


def readable(node, index):
    try:
        node.read(index)
    except Abort as refusal:
        assert refusal.code == NOT_NOW, refusal
        return False
    return True


def runs_by_velocity_mode(line, node, told, rpm, up_s, quick_stop_s):
    """Controlword and target velocity in RPDO2, the DSP-402 states, the quick stop over the second function. Returns the
    slopes of the two ramps as parts of what they should be."""
    cob_id = node.map_pdo("receive", 2, [(CONTROLWORD, 0, 16), (TARGET_VELOCITY, 0, 16)], 255)
    node.write(0x6048, 2, round(up_s))
    node.write(0x604A, 2, round(quick_stop_s))
    node.parameter(180, 3)
    reference_hz = node.read(0x3000 + 20) / 100
    top_hz = rpm * 4 / 120  # Pr.144 as delivered

    def controlword(word, state, velocity=0):
        since = line.now()
        line.send(cob_id, struct.pack("<Hh", word, velocity))
        line.wait(lambda m: m.arbitration_id == told and words(m)[3] & STATE_MASK == state, since,
                  what=f"state {state:02X} after controlword {word:04X}")
        return since

    controlword(SHUTDOWN, READY_TO_SWITCH_ON)
    controlword(SWITCH_ON, SWITCHED_ON)
    since = controlword(ENABLE_OPERATION, OPERATION_ENABLED, rpm)
    line.wait(lambda m: m.arbitration_id == told and words(m)[3] & TARGET_REACHED and words(m)[1] == round(top_hz * 100),
              since, timeout=30, what="target reached")
    up = ramp(line, told, since, reference_hz / up_s, top_hz)
    assert node.read(0x6043, signed=True) == node.read(0x6044, signed=True) == rpm
    since = controlword(QUICK_STOP, QUICK_STOP_ACTIVE, rpm)
    line.wait(lambda m: m.arbitration_id == told and words(m)[3] & STATE_MASK == SWITCH_ON_DISABLED, since, timeout=30,
              what="the end of the quick stop")
    down = ramp(line, told, since, -reference_hz / quick_stop_s, top_hz)
    assert not node.read(COMMAND) & (BIT_RUN | BIT_ALARM)
    return up, down


def leaves_net(line, node):
    node.nmt(PRE_OPERATIONAL)
    wait_until(lambda: not is_remote(node), 10, "the end of NET mode")
    since = line.now()
    node.nmt(STOP)
    line.send(0x600 + node.number, b"\x40\x00\x10\x00\0\0\0\0")
    line.expect_silence(0x580 + node.number, since, 0.2)


def guards(node):
    """Answers with the state and a toggle bit that starts at 0 with the boot-up."""
    since = node.line.now()
    node.nmt(RESET_COMMUNICATION)
    node.wait_boot_up(since)
    seen = [node.guard() for _ in range(3)]
    for state in (START, STOP, PRE_OPERATIONAL):
        node.nmt(state)
        seen.append(node.guard())
    assert seen == [(0, IS_PRE_OPERATIONAL), (1, IS_PRE_OPERATIONAL), (0, IS_PRE_OPERATIONAL), (1, IS_OPERATIONAL),
                    (0, IS_STOPPED), (1, IS_PRE_OPERATIONAL)], seen


def answers_remote_frames(line, node):
    """TPDO1 is delivered as type 253: sent on request. Type 252: what the last SYNC found."""
    goes_operational(node)
    since = line.now()
    told = 0x180 + node.number

    def asked(since):
        line.request(told, 8)
        return line.wait(lambda m: m.arbitration_id == told and not m.is_remote_frame, since, what="the requested PDO")

    line.expect_silence(told, since, 0.1)
    answer, since = asked(since)
    status, frequency, current, alarms = words(answer)
    assert status == node.read(COMMAND) and frequency == 0 and current == 0 and alarms == node.read(NEWEST_ALARMS)
    node.write(0x1800, 1, NOT_VALID | told, 4)
    line.request(told, 8)
    line.expect_silence(lambda m: m.arbitration_id == told and not m.is_remote_frame, since, 0.1)
    node.set_tpdo1_type(252)
    since = line.now()
    line.request(told, 8)
    emergency, _ = node.wait_emergency(since)
    assert bytes(emergency.data[:4]) == bytes([0x00, 0x82, 0x00, 44]), emergency.data.hex()
    line.sync()
    line.expect_silence(lambda m: m.arbitration_id == told and not m.is_remote_frame, since, 0.1)
    answer, since = asked(since)
    assert words(answer)[1] == 0
    node.set_tpdo1_type(253)


def stops_when_guarding_ends(line, nodes, inhibit=100, guard_ms=200, factor=5):
    """nodes: by 6007H. All of them run and are guarded; when that ends each does what its 6007H says."""
    watched = {}
    for option, node in nodes.items():
        watched[option] = watches(node, inhibit)
        goes_operational(node)
        sets_ramps(node, 0.5, 2.0)
        node.parameter(20, 5000)
        node.parameter(180, 3)
        node.parameter(45, 25)
        node.write(ABORT_OPTION, 0, option)
        node.write(GUARD_TIME, 0, guard_ms)
        node.write(LIFE_TIME_FACTOR, 0, factor, 1)
    for node in nodes.values():
        node.guard()  # from the first time on it is expected
    since = line.now()
    for node in nodes.values():
        command(line, node, BIT_STF, 2000)
    for option, node in nodes.items():
        # Guarding goes on meanwhile.
        def is_up():
            for other in nodes.values():
                other.guard()
            return any(m.arbitration_id == watched[option] and words(m)[0] & BIT_UP_TO_FREQUENCY
                       for m in line.frames[since:])
        wait_until(is_up, 30, f"node {node.number} up to frequency")
    assert not [m for m in line.frames[since:] if 0x80 < m.arbitration_id < 0x100], "guarding was lost before its end"
    started = line.now()
    for node in nodes.values():
        emergency, _ = node.wait_emergency(started)
        assert bytes(emergency.data) == bytes([0x30, 0x81, 0x11, 31, 0, IS_OPERATIONAL, 0, 0]), emergency.data.hex()
    return watched, started


def life_time(line, node, guard_ms=100, factor=5):
    """Seconds from the last guarding to the emergency, as a part of what they should be."""
    node.write(GUARD_TIME, 0, guard_ms)
    node.write(LIFE_TIME_FACTOR, 0, factor, 1)
    since = line.now()
    node.guard()
    last, since = line.wait(lambda m: m.arbitration_id == 0x700 + node.number and not m.is_remote_frame, since)
    emergency, _ = node.wait_emergency(since, 0x8130)
    node.guard()
    node.write(LIFE_TIME_FACTOR, 0, 0, 1)
    return (emergency.timestamp - last.timestamp) / (guard_ms * factor / 1000)


def reactions_to_lost_guarding(line, nodes, watched, since):
    """6007H: 0 runs on, 2 output off, 3 quick stop in Pr.45. Then the master is back: the error ends. Returns the slope of
    the quick stop as a part of what it should be."""
    for option in (2, 3):
        line.wait(lambda m: m.arbitration_id == watched[option] and not words(m)[0] & BIT_RUN, since, timeout=30,
                  what=f"the stop with 6007H = {option}")
    told = {option: [(m.timestamp, words(m)[1] / 100) for m in line.frames[since:] if m.arbitration_id == cob_id]
            for option, cob_id in watched.items()}
    assert not any(0 < hz < 19 for _, hz in told[2]), "the output goes off at once"
    assert nodes[0].read(OUTPUT_FREQUENCY) == 2000 and nodes[0].read(COMMAND) & BIT_RUN
    for option, node in nodes.items():
        since = line.now()
        assert node.read(0x1001) == 0x11
        assert node.guard()[1] == IS_OPERATIONAL
        emergency, _ = node.wait_emergency(since)
        assert bytes(emergency.data[:3]) == bytes(3), emergency.data.hex()
        assert node.read(0x1001) == 0
        node.write(LIFE_TIME_FACTOR, 0, 0, 1)
        command(line, node, BIT_STOP, 0)
    return slope(told[3], 2, 18) / -20
