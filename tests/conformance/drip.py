"""A broken client: sends one byte of an endless request each second and never reads."""
import socket
import threading


class Drip:
    def __init__(self, endpoint):
        self.connection = socket.create_connection((endpoint["host"], endpoint["port"]))
        self.stopped = threading.Event()
        # A read request for this unit, byte by byte; the story ends before the request does.
        request = bytes([0, 1, 0, 0, 0, 6, endpoint["unit"], 3, 0x5A, 0x3C, 0, 1])
        self.thread = threading.Thread(target=self.run, args=(request,), daemon=True)
        self.thread.start()

    def run(self, request):
        for byte in request:
            self.connection.sendall(bytes([byte]))
            if self.stopped.wait(1):
                return

    def close(self):
        self.stopped.set()
        self.thread.join()
        self.connection.close()
