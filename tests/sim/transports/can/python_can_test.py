#!/usr/bin/env python3
"""python-can as it is, against a bus of ours.

Usage: python_can_test.py SERVER socketcand|slcan_tcp|slcan_tty|udp_multicast
"""
import os
import subprocess
import sys
import time

import can

# A group of our own, and a hop limit of 0: this test stays on this machine and apart from others.
IPV4_GROUP = f"239.74.{os.getpid() // 256 % 256}.{os.getpid() % 256}"


def check(condition, text):
    if not condition:
        raise AssertionError(text)


def wait_for(bus, condition, seconds=10.0):
    """The first message that fulfils the condition; what comes before it is thrown away."""
    end = time.monotonic() + seconds
    while (left := end - time.monotonic()) > 0:
        message = bus.recv(left)
        if message is not None and condition(message):
            return message
    raise AssertionError("no answer in time")


def story(bus, remote, extended):
    """Requests are answered at the identifier before."""
    for data in ([], [1], [0xDE, 0xAD, 0xBE, 0xEF], list(range(8))):
        bus.send(can.Message(arbitration_id=0x601, data=data, is_extended_id=False))
        answer = wait_for(bus, lambda m: m.arbitration_id == 0x600)
        check(list(answer.data) == data and answer.dlc == len(data), f"{data} came back as {answer}")
    if remote:
        bus.send(can.Message(arbitration_id=0x605, is_remote_frame=True, dlc=1, is_extended_id=False))
        answer = wait_for(bus, lambda m: m.arbitration_id == 0x604)
        check(not answer.is_remote_frame and answer.dlc == 1, f"the remote frame was answered {answer}")
    if extended:
        bus.send(can.Message(arbitration_id=0x00000601, data=[7], is_extended_id=True))
        answer = wait_for(bus, lambda m: m.arbitration_id == 0x600 and list(m.data) == [7])
        check(answer.is_extended_id, f"the extended frame was answered {answer}")


def burst(bus, count):
    """Frames that follow each other without a pause all arrive, in order, though we read late and in pieces."""
    bus.send(can.Message(arbitration_id=0x7F0, data=[count >> 8, count & 0xFF], is_extended_id=False))
    time.sleep(1)
    for i in range(count):
        got = wait_for(bus, lambda m: m.arbitration_id == 0x7F1)
        check(got.data[0] << 8 | got.data[1] == i, f"expected number {i}, got {got}")


def two_masters(make, echoes):
    """Two clients hear each other, and neither hears itself, unless the bus is one that echoes."""
    with make() as a, make() as b:
        time.sleep(0.2)
        a.send(can.Message(arbitration_id=0x7A0, data=[1], is_extended_id=False))
        wait_for(b, lambda m: m.arbitration_id == 0x7A0)
        b.send(can.Message(arbitration_id=0x7A1, data=[2], is_extended_id=False))
        heard = []
        wait_for(a, lambda m: heard.append(m.arbitration_id) or m.arbitration_id == 0x7A1)
        check(echoes or 0x7A0 not in heard, "a client heard itself")


def multicast_is_possible(make):
    """Whether python-can itself hears another python-can here."""
    try:
        with make() as a, make() as b:
            a.send(can.Message(arbitration_id=1, data=[1], is_extended_id=False))
            return b.recv(2) is not None
    except (OSError, can.CanError):
        return False


def main():
    program, interface = sys.argv[1:3]
    multicast = interface == "udp_multicast"
    makers = {
        "socketcand": lambda: can.Bus(interface="socketcand", host="127.0.0.1", port=int(ports[0]), channel="vcan0"),
        "slcan_tcp": lambda: can.Bus(interface="slcan", channel=f"socket://127.0.0.1:{ports[1]}", bitrate=125000,
                                     sleep_after_open=0.2),
        "slcan_tty": lambda: can.Bus(interface="slcan", channel=ports[2], bitrate=125000, sleep_after_open=0.2),
        "udp_multicast": lambda: can.Bus(interface="udp_multicast", channel=IPV4_GROUP, hop_limit=0),
    }
    make = makers[interface]
    possible = not multicast or multicast_is_possible(make)
    server = subprocess.Popen([program] + ([IPV4_GROUP] if multicast else []), stdin=subprocess.PIPE,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        line = server.stdout.readline()
        if not possible:
            # A machine without a route for multicast: ours must not do better than say so, or find a way.
            check(line or "multicast" in server.stderr.read(), "neither a bus nor a reason")
            return
        ports = line.split()
        check(len(ports) == 3, f"the server did not start: {line}")
        with make() as bus:
            # python-can 4.1 sends neither through socketcand.
            story(bus, remote=interface != "socketcand", extended=interface != "socketcand")
            burst(bus, 100 if multicast else 500)  # what the receive buffer of a socket holds
        if interface != "slcan_tty":
            two_masters(make, echoes=multicast)
    finally:
        server.stdin.close()
        check(server.wait(10) == 0 or not possible, "the server failed")


main()
