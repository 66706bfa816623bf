"""A broken client: sends one byte of an endless request each second and never reads."""
import socket
import threading


class Drip:
    def __init__(self, endpoint):
        self.connection = socket.create_connection((endpoint["host"], endpoint["port"]))
        self.stopped = threading.Event()
        # A frame as long as the header can announce: no test lives long enough to see its end.
        request = bytes([0, 1, 0, 0, 0, 254, endpoint["unit"], 16]) + bytes(252)
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
