"""The connection of a participant to its coupler: Hello, questions and answers (proto/WIRE.md).

It survives a suspended coupler or participant, and ends the process when the coupler has ended.
"""
import time

from . import liveness
from .errors import Error, need
from .keys import read_keys
from .messages import pb

zmq = need("zmq", "python3-zmq")

PROTOCOL = 1
LOOK = 100       # [ms] between two tests of the connection while no question comes
TO_ANSWER = 30   # [s] until a coupler must have answered the first connection
TO_THAW = 10     # [s] that a coupler which accepts connections may be suspended, for a solver started by hand
TO_RETURN = 2    # [s] that a coupler which accepts none may be away, likewise
REFUSED = 5, 5.0  # greetings in a row, and seconds, after which failure is taken to be final
LINGER = 2000    # [ms] that the last answer may take to leave the process


class Connection:
    """One participant's socket. `ask` waits for a question, `reply` answers it."""

    def __init__(self, endpoint, name, case_hash, token, solver, version, key_file=""):
        """case_hash and token: hexadecimal, as --case-hash and STRAKE_TOKEN give them. key_file: of STRAKE_KEY, or empty."""
        from zmq.utils.monitor import recv_monitor_message  # an error of zmq comes before one of its parts
        self.read_event = recv_monitor_message
        self.name, self.endpoint = name, endpoint
        self.hello = pb.Hello(protocol=PROTOCOL, name=name, solver=solver, version=version,
                              case_hash=from_hexadecimal(case_hash, "the case's hash"), token=from_hexadecimal(token, "STRAKE_TOKEN"))
        self.sequence, self.answer, self.received = 0, None, 0  # of the last question, and to it; [ns] when it came
        self.told = 0.0  # when Working was sent last
        self.lost, self.reachable, self.greeted, self.failed = time.monotonic(), False, False, []
        keys = read_keys(key_file, name)
        self.launched = liveness.watch(name)
        self.context = zmq.Context()
        self.socket = self.context.socket(zmq.DEALER)
        self.socket.linger = LINGER
        if keys:
            self.socket.curve_publickey, self.socket.curve_secretkey = keys["public"], keys["secret"]
            self.socket.curve_serverkey = keys["coupler"]
        self.monitor = self.socket.get_monitor_socket(
            zmq.EVENT_CONNECTED | zmq.EVENT_DISCONNECTED | zmq.EVENT_HANDSHAKE_SUCCEEDED | zmq.EVENT_HANDSHAKE_FAILED_AUTH
            | zmq.EVENT_HANDSHAKE_FAILED_PROTOCOL | zmq.EVENT_HANDSHAKE_FAILED_NO_DETAIL)
        try:
            self.socket.connect(endpoint)
        except zmq.ZMQError as e:
            self.close()
            raise Error(f"is no endpoint that can be reached: {e}", "the coupler's console and its run.json tell it", endpoint, 2) from None
        self.say_hello()

    def ask(self):
        """The next question: its header, and an iterator over the frames behind it. One that comes twice is answered twice.

        Error where the coupler refuses this participant, or sends what is no question.
        """
        while True:
            while not self.socket.poll(LOOK):
                self.look()
            header, *frames = self.socket.recv_multipart()
            received = time.monotonic_ns()
            try:
                request = pb.Request.FromString(header)
            except Exception:  # protobuf's own error has a place that changes between its versions
                raise Error("the coupler sent what is no message", exit_code=5) from None
            if request.WhichOneof("what") == "refused":
                self.hello = None  # nobody listens to a Fault
                raise Error(f"the coupler refused this participant: {request.refused.problem}", request.refused.fix, exit_code=5)
            if request.sequence != self.sequence:
                self.sequence, self.answer, self.received = request.sequence, None, received
                return request, iter(frames)
            if self.answer:
                self.socket.send_multipart(self.answer)

    def reply(self, reply, arrays=()):
        """Answers the last question. arrays: numpy arrays, little-endian float64, faces int32, in the header's order."""
        reply.sequence = self.sequence
        reply.times.received, reply.times.answered = self.received, time.monotonic_ns()
        self.look()
        self.answer = [reply.SerializeToString(), *(array.tobytes() for array in arrays)]
        self.socket.send_multipart(self.answer)

    def fault(self, error):
        """Answers the last question with what went wrong: the run ends with the error's exit code."""
        if self.hello is None or not self.sequence or self.answer:
            return  # refused, not asked yet, or answered
        self.reply(pb.Reply(fault=pb.Fault(where=error.where or self.name, problem=error.problem, fix=error.fix,
                                           exit_code=error.exit_code)))

    def working(self, fraction, what):
        """Tells the coupler that the question is being worked on; at most once a second, more calls do nothing."""
        if time.monotonic() - self.told < 1:
            return
        self.told = time.monotonic()
        self.look()
        self.socket.send(pb.Reply(sequence=self.sequence, working=pb.Working(fraction=fraction, what=what)).SerializeToString())

    def close(self):
        """Sends what is still to be sent, for at most LINGER, and closes the socket."""
        self.socket.disable_monitor()
        self.monitor.close()
        self.socket.close()
        self.context.term()

    def say_hello(self):
        self.socket.send(pb.Reply(sequence=self.sequence, hello=self.hello).SerializeToString())

    def look(self):
        """Processes the events of the connection. On a new one the coupler identifies us only after a Hello."""
        while self.monitor.poll(0):
            event = self.read_event(self.monitor)["event"]
            if event == zmq.EVENT_CONNECTED:
                self.reachable = True
            elif event == zmq.EVENT_DISCONNECTED:
                self.lost, self.reachable = self.lost or time.monotonic(), False
            elif event == zmq.EVENT_HANDSHAKE_SUCCEEDED:
                self.greet()
            elif not self.greeted:
                self.judge(event)
        silent = time.monotonic() - self.lost if self.lost else 0
        if not self.greeted and silent > TO_ANSWER:
            raise Error(f"no coupler answers there for {TO_ANSWER} s", "the coupler's console and its run.json tell the endpoint",
                        self.endpoint, 5)
        # The kernel of a coupler that is only suspended accepts connections; that of a dead one refuses them.
        if self.greeted and not self.launched and silent > (TO_THAW if self.reachable else TO_RETURN):
            liveness.end(self.name)

    def judge(self, event):
        """A greeting has failed: Error where the coupler will never accept this participant."""
        if event == zmq.EVENT_HANDSHAKE_FAILED_NO_DETAIL:  # may happen once when a network is cut
            self.failed.append(time.monotonic())
            if len(self.failed) < REFUSED[0] or self.failed[-1] - self.failed[0] < REFUSED[1]:
                return
        self.hello = None
        raise Error("what answers there does not accept this participant's key, or asks for one",
                    "STRAKE_KEY must name the participant's key file if the case has coupling.keys, and only then", self.endpoint, 2)

    def greet(self):
        if self.greeted:
            self.say_hello()
            if self.answer:
                self.socket.send_multipart(self.answer)
        self.lost, self.greeted = None, True


def from_hexadecimal(text, what):
    try:
        return bytes.fromhex(text)
    except ValueError:
        raise Error(f"{what} is not hexadecimal: {text[:80]!r}", "give the solver what the coupler printed", exit_code=2) from None
