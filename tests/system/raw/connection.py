"""The connection of a participant to its coupler: Hello, questions and answers (proto/WIRE.md).

It survives a suspended coupler or participant, and ends the process when the coupler has ended. Copy it beside your solver.
"""
import os
import sys
import time

import zmq
from zmq.utils.monitor import recv_monitor_message

import coupling_pb2 as pb  # made of proto/coupling.proto by the build; strake puts its folder on PYTHONPATH

GONE = 5  # exit code of a solver whose coupler has ended
LOOK = 100  # [ms] between two tests of the connection while no request comes


class Connection:
    def __init__(self, endpoint, name, case_hash, solver, version):
        """case_hash: hexadecimal, as --case-hash gives it. The token is in STRAKE_TOKEN."""
        self.hello = pb.Hello(protocol=1, name=name, solver=solver, version=version, case_hash=bytes.fromhex(case_hash),
                              token=bytes.fromhex(os.environ["STRAKE_TOKEN"]))
        self.parent, self.name = os.getppid(), name
        self.sequence, self.answer = 0, None  # of the last question, and to it
        self.lost, self.reachable, self.greeted = time.monotonic(), True, False
        self.socket = zmq.Context().socket(zmq.DEALER)
        self.monitor = self.socket.get_monitor_socket(
            zmq.EVENT_CONNECTED | zmq.EVENT_DISCONNECTED | zmq.EVENT_HANDSHAKE_SUCCEEDED)
        self.socket.connect(endpoint)
        self.say_hello()

    def ask(self):
        """The next question: its message, and the arrays behind it as bytes. A question that comes twice is answered twice."""
        while True:
            while not self.socket.poll(LOOK):
                self.look()
            header, *arrays = self.socket.recv_multipart()
            request = pb.Request.FromString(header)
            if request.WhichOneof("what") == "refused":
                sys.exit(f"{self.name}: {request.refused.problem}")
            if request.sequence != self.sequence:
                self.sequence, self.answer = request.sequence, None
                return request, arrays
            if self.answer:
                self.socket.send_multipart(self.answer)

    def reply(self, reply, arrays=()):
        """Answers the last question. arrays: numpy arrays as little-endian float64, faces as int32."""
        reply.sequence = self.sequence
        self.look()
        self.answer = [reply.SerializeToString(), *(array.tobytes() for array in arrays)]
        self.socket.send_multipart(self.answer)

    def say_hello(self):
        self.socket.send(pb.Reply(sequence=self.sequence, hello=self.hello).SerializeToString())

    def look(self):
        """Processes the events of the connection. On a new one the coupler identifies us only after a Hello."""
        while self.monitor.poll(0):
            event = recv_monitor_message(self.monitor)["event"]
            if event == zmq.EVENT_CONNECTED:
                self.reachable = True
            elif event == zmq.EVENT_DISCONNECTED:
                self.lost, self.reachable = time.monotonic(), False
            elif self.greeted:
                self.lost = None
                self.say_hello()
                if self.answer:
                    self.socket.send_multipart(self.answer)
            else:
                self.lost, self.greeted = None, True
        # The kernel of a coupler that is only suspended accepts connections; that of a dead one refuses them.
        patience = 10 if self.reachable else 2  # [s]
        if os.getppid() != self.parent or (self.lost and time.monotonic() - self.lost > patience):
            print(f"{self.name}: the coupler is gone", file=sys.stderr)
            sys.exit(GONE)
