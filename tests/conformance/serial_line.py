"""The serial line, by masters that do it wrong: another unit, another speed, a broken CRC, broadcast. Silence each time."""

import serial

from masters import Libmodbus, Mbpoll, Pymodbus
from plant import Plant, wait_until
from story import COMMAND, FORWARD, FREQUENCY, NET, RUN_BIT, STATUS, STOP, expect_silence, parameter

PLANT = """
name: line
networks:
  can0: {can: virtual, socketcand: "127.0.0.1:0"}
  field: {serial: pty}
drives:
  - name: left
    board: {node: 5, modbus_rtu: field, modbus_tcp: none}
  - name: right
    board: {node: 6, modbus_rtu: field, modbus_tcp: none}
"""
READ_STATUS_OF_5 = bytes.fromhex("05 03 5D C0 00 01")


def crc16(data):
    crc = 0xFFFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ (0xA001 if crc & 1 else 0)
    return crc.to_bytes(2, "little")


def exchange(path, frame, wait=0.5):
    with serial.Serial(path, 9600, timeout=wait) as line:
        line.reset_input_buffer()
        line.write(frame)
        return line.read(256)


def units(endpoint):
    for unit in (5, 6):
        with Pymodbus(endpoint, unit=unit) as m:
            assert m.read(parameter(1)) == [12000]
    for master in (Pymodbus, Mbpoll, Libmodbus):
        with master(endpoint, unit=7) as m:
            expect_silence(m.read, STATUS)


def speeds(endpoint, plant):
    for master in (Pymodbus, Libmodbus):
        with master(endpoint, baud=19200) as m:
            expect_silence(m.read, STATUS)
        with master(endpoint) as m:
            m.read(STATUS)
    with Mbpoll(endpoint, baud=38400) as m:
        expect_silence(m.read, STATUS)
    # Pr.347 = 5: 19200 bit/s, from the next power-on.
    with Pymodbus(endpoint) as m:
        m.write(NET, 1)
        m.write(parameter(347), 5)
    plant.power_off("left")
    plant.power_on("left")
    with Pymodbus(endpoint) as m:
        expect_silence(m.read, STATUS)
    with Pymodbus(endpoint, unit=6) as m:
        m.read(STATUS)  # the other drive on the line has kept its speed
    with Libmodbus(endpoint, baud=19200) as m:
        m.read(STATUS)
        m.write(NET, 1)
        m.write(parameter(347), 4)
    plant.power_off("left")
    plant.power_on("left")
    with Pymodbus(endpoint) as m:
        m.read(STATUS)


def frames(endpoint):
    path = endpoint["path"]
    good = READ_STATUS_OF_5 + crc16(READ_STATUS_OF_5)
    answer = exchange(path, good)
    assert answer[:3] == bytes([5, 3, 2]) and crc16(answer[:-2]) == answer[-2:], answer.hex(" ")
    assert exchange(path, good[:-1] + bytes([good[-1] ^ 1])) == b"", "wrong CRC"
    assert exchange(path, good[:5]) == b"", "half a frame"
    assert exchange(path, bytes(range(256)) * 2) == b"", "noise"
    assert exchange(path, good) == answer, "the line is fine after all that"


def broadcast(endpoint):
    """Unit 0: both drives obey, none answers."""
    path = endpoint["path"]
    for address, value in ((NET, 1), (FREQUENCY, 3000), (COMMAND, FORWARD)):
        frame = bytes([0, 6]) + address.to_bytes(2, "big") + value.to_bytes(2, "big")
        assert exchange(path, frame + crc16(frame), wait=0.3) == b""
    for unit in (5, 6):
        with Pymodbus(endpoint, unit=unit) as m:
            wait_until(lambda: m.read(STATUS)[0] & RUN_BIT, 5, f"unit {unit} runs")
            m.write(COMMAND, STOP)
def main():
    with Plant(PLANT) as plant:
        endpoint = plant.endpoint("left", "modbus-rtu")
        assert endpoint["path"] == plant.endpoint("right", "modbus-rtu")["path"]
        units(endpoint)
        frames(endpoint)
        broadcast(endpoint)
        speeds(endpoint, plant)


if __name__ == "__main__":
    main()
