"""Carries bytes between one TCP client and a serial line, unchanged. Prints the port it listens on.

Usage: byte_pipe.py PATH BAUD
"""
import select
import socket
import sys

import serial

listener = socket.create_server(("127.0.0.1", 0))
print(listener.getsockname()[1], flush=True)
with serial.Serial(sys.argv[1], int(sys.argv[2]), timeout=0) as line:
    connection, _ = listener.accept()
    connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    while True:
        readable, _, _ = select.select([connection, line], [], [])
        if connection in readable:
            received = connection.recv(4096)
            if not received:
                break
            line.write(received)
        if line in readable:
            connection.sendall(line.read(4096))
