"""CANopen and Modbus at the same time on one inverter: whose mode change counts, who commands, what the other one sees.

NMT and register 26000 both set the operation mode: at standstill the last one wins (OI-FR-E5NCO manual, 4.2 and 8.7.12).
"""
from canopen_master import IS_OPERATIONAL, Node, PRE_OPERATIONAL, START
from canopen_plant import CanPlant
import canopen_steps as steps
from masters import ModbusException, Pymodbus
from plant import wait_until
from story import COMMAND, FORWARD, FREQUENCY, NET, OUTPUT_FREQUENCY, STATUS, STOP, expect_exception, parameter

NOT_IN_NET, RUNNING_BIT = 5, 1


def mode_at_standstill(node, m):
    """Each of the two changes the mode for both."""
    for _ in range(2):
        steps.goes_operational(node)
        m.write(parameter(7), 20)
        m.write(NET, 0)
        wait_until(lambda: not steps.is_remote(node), 10, "the end of NET mode by Modbus")
        assert node.read(0x1001) == 0
        node.expect_abort(steps.NO_LOCAL_CONTROL, node.parameter, 7, 30)
        expect_exception(NOT_IN_NET, m.write, COMMAND, FORWARD)
        m.write(NET, 1)
        wait_until(lambda: steps.is_remote(node), 10, "NET mode by Modbus")
        node.parameter(7, 20)
        node.nmt(PRE_OPERATIONAL)
        wait_until(lambda: not steps.is_remote(node), 10, "the end of NET mode by NMT")
        expect_exception(NOT_IN_NET, m.write, COMMAND, FORWARD)


def parameters_are_common(node, m):
    steps.goes_operational(node)
    for i in range(10):
        node.parameter(7, 20 + i)
        assert m.read(parameter(7)) == [20 + i]
        m.write(parameter(8), 30 + i)
        assert node.read(0x3008) == 30 + i
    node.parameter(7, 5)
    m.write(parameter(8), 5)


def can_commands_modbus_watches(line, node, m):
    steps.command(line, node, steps.BIT_STF, 3000)
    wait_until(lambda: m.read(OUTPUT_FREQUENCY) == [3000], 10, "30 Hz on Modbus")
    assert m.read(STATUS)[0] & RUNNING_BIT
    # While the motor runs nobody changes the mode.
    try:
        m.write(NET, 0)
        raise AssertionError("NET mode ended with a running motor")
    except ModbusException as refusal:
        print(f"26000 = 0 while running: {refusal}")
    assert steps.is_remote(node)
    # In NET mode either of them commands: the last one wins.
    m.write(FREQUENCY, 2000)
    wait_until(lambda: node.read(steps.OUTPUT_FREQUENCY) == 2000, 10, "20 Hz on CANopen")
    m.write(COMMAND, STOP)
    wait_until(lambda: not node.read(steps.COMMAND) & steps.BIT_RUN, 10, "the stop on CANopen")


def modbus_commands_can_watches(line, node, m, told):
    node.nmt(PRE_OPERATIONAL)
    wait_until(lambda: not steps.is_remote(node), 10, "the end of NET mode")
    m.write(NET, 1)
    m.write(FREQUENCY, 2500)
    m.write(COMMAND, FORWARD)
    wait_until(lambda: node.read(steps.OUTPUT_FREQUENCY) == 2500, 10, "25 Hz on CANopen")
    # OPERATIONAL in NET mode changes nothing, and begins the PDOs.
    since = line.now()
    node.nmt(START)
    status, _ = line.wait(told, since, what="the watched PDO")
    assert steps.words(status)[1] == 2500 and steps.words(status)[3] & steps.REMOTE
    # A command that takes NET mode away waits for the standstill.
    node.nmt(PRE_OPERATIONAL)
    assert steps.is_remote(node) and m.read(STATUS)[0] & RUNNING_BIT
    m.write(COMMAND, STOP)
    wait_until(lambda: not steps.is_remote(node), 10, "the end of NET mode after the stop")
    expect_exception(NOT_IN_NET, m.write, COMMAND, FORWARD)


def refused_while_it_runs_from_outside(line, node, m, plant):
    """OPERATIONAL while the terminals run the motor: EMCY 24H, and the mode stays."""
    plant.ctl(plant.first, "terminal", "STF=on", "RH=on")
    wait_until(lambda: m.read(OUTPUT_FREQUENCY)[0] > 500, 10, "a motor that runs by the terminals")
    since = line.now()
    node.nmt(START)
    emergency, _ = node.wait_emergency(since)
    assert bytes(emergency.data[3:6]) == bytes([21, 0x24, IS_OPERATIONAL]), emergency.data.hex()
    assert not steps.is_remote(node)
    try:
        m.write(NET, 1)
        raise AssertionError("NET mode with a motor that the terminals run")
    except ModbusException as refusal:
        print(f"26000 = 1 while the terminals run the motor: {refusal}")
    plant.ctl(plant.first, "terminal", "STF=off", "RH=off")
    wait_until(lambda: not m.read(STATUS)[0] & RUNNING_BIT, 10, "the stop by the terminals")
    steps.goes_operational(node)


def main():
    with CanPlant([5], modbus_tcp="127.0.0.1:0") as plant:
        with plant.line("socketcand") as line, Pymodbus(plant.endpoint("n5", "modbus-tcp")) as m:
            node = Node(line, 5)
            told = steps.watches(node)
            mode_at_standstill(node, m)
            parameters_are_common(node, m)
            can_commands_modbus_watches(line, node, m)
            modbus_commands_can_watches(line, node, m, told)
            refused_while_it_runs_from_outside(line, node, m, plant)


if __name__ == "__main__":
    main()
