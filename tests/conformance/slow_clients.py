"""Clients that dawdle, never read, or talk nonsense do not delay a well-behaved one, nor the simulation."""
import os
import socket
import time

from drip import Drip
from masters import Pymodbus
from plant import Plant
from ramp import slope
from story import COMMAND, DRIVE, FORWARD, FREQUENCY, LIVE_TOLERANCE, NET, PLANT, parameter, sample_ramp

REQUESTS = 200
# A server that waited for any of the others would take a second and more.
PATIENCE = 0.5


def connect(endpoint):
    return socket.create_connection((endpoint["host"], endpoint["port"]))


def never_reads(endpoint):
    """Asks until the server no longer takes it, and reads no answer. A disconnect is the server's good right."""
    connection = connect(endpoint)
    connection.setblocking(False)
    request = bytes([0, 1, 0, 0, 0, 6, endpoint["unit"], 3, 0x5A, 0x3C, 0, 3]) * 1000
    deadline = time.monotonic() + 2
    try:
        while time.monotonic() < deadline:
            try:
                connection.send(request)
            except BlockingIOError:
                break
    except OSError:
        pass
    return connection


def nonsense(endpoint):
    connection = connect(endpoint)
    try:
        connection.sendall(b"GET / HTTP/1.1\r\nHost: inverter\r\n\r\n" + os.urandom(2000))
    except OSError:
        pass
    return connection


def main():
    with Plant(PLANT) as plant:
        endpoint = plant.endpoint(DRIVE, "modbus-tcp")
        drips = [Drip(endpoint) for _ in range(8)]
        others = [never_reads(endpoint), nonsense(endpoint), connect(endpoint)]
        with Pymodbus(endpoint) as m:
            longest = 0
            for _ in range(REQUESTS):
                asked = time.monotonic()
                assert m.read(parameter(1)) == [12000]
                longest = max(longest, time.monotonic() - asked)
            assert longest < PATIENCE, f"an answer took {longest} s"
            m.write(NET, 1)
            m.write(parameter(7), 20)
            m.write(FREQUENCY, 3000)
            reference_hz = m.read(parameter(20))[0] / 100
            m.write(COMMAND, FORWARD)
            measured = slope(sample_ramp(m, 30, timeout=20), 3, 27)
            assert abs(measured / (reference_hz / 2.0) - 1) < LIVE_TOLERANCE, f"{measured} Hz/s"
        for drip in drips:
            drip.close()
        for connection in others:
            connection.close()
        print(f"longest answer {longest * 1e3:.1f} ms, ramp {measured:.2f} Hz/s")


if __name__ == "__main__":
    main()
