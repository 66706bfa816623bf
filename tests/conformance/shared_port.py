"""Several drives behind one Modbus/TCP port, by unit identifier: each is itself, and a unit that is nobody says so."""
from masters import Libmodbus, Pymodbus
from plant import Plant, wait_until
from story import COMMAND, FORWARD, FREQUENCY, NET, OUTPUT_FREQUENCY, STATUS, STOP, expect_exception, parameter

PLANT = """
name: shared
networks:
  can0: {can: virtual, socketcand: "127.0.0.1:0"}
  office: {modbus_tcp: "127.0.0.1:0"}
drives:
  - {name: a, board: {node: 1, modbus_rtu: none, modbus_tcp: office}}
  - {name: b, board: {node: 2, modbus_rtu: none, modbus_tcp: office}}
  - {name: c, board: {node: 30, modbus_rtu: none, modbus_tcp: office}}
"""


def main():
    with Plant(PLANT) as plant:
        endpoint = plant.endpoint("a", "modbus-tcp")
        assert all(plant.endpoint(d, "modbus-tcp")["port"] == endpoint["port"] for d in "bc")
        masters = {unit: Pymodbus(endpoint, unit=unit) for unit in (1, 2, 30)}
        for m in masters.values():
            m.open()
        for unit, m in masters.items():
            m.write(NET, 1)
            m.write(parameter(7), 2 + unit)
        for unit, m in masters.items():
            assert m.read(parameter(7)) == [2 + unit]
        masters[2].write(FREQUENCY, 1000)
        masters[2].write(COMMAND, FORWARD)
        wait_until(lambda: masters[2].read(OUTPUT_FREQUENCY) == [1000], 10, "unit 2 at 10 Hz")
        for unit in (1, 30):
            assert masters[unit].read(OUTPUT_FREQUENCY) == [0]
        masters[2].write(COMMAND, STOP)
        for m in masters.values():
            m.close()
        with Libmodbus(endpoint, unit=9) as nobody:
            expect_exception(11, nobody.read, STATUS)


if __name__ == "__main__":
    main()
