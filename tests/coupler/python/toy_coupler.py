"""A coupler for one participant, in the test's own process. It asks what the test tells it to ask."""
import os
import pathlib
import subprocess
import sys
import tempfile
import time

import numpy as np
import zmq

import coupling_pb2 as pb

PATIENCE = 10  # [s] for every answer
TOKEN, HASH = "00" * 16, "11" * 32


class ToyCoupler:
    """Binds a socket; `environment` leads a participant to it. `start` runs a script as one. keys: public and secret of the coupler."""

    def __init__(self, name="structure", keys=None):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="strake-test-"))
        self.name, self.peer, self.sequence, self.process, self.working, self.over = name, None, 0, None, [], False
        self.context = zmq.Context()
        self.socket = self.context.socket(zmq.ROUTER)
        self.socket.linger = 0
        if keys:
            self.socket.curve_server, (self.socket.curve_publickey, self.socket.curve_secretkey) = True, keys
        self.endpoint = f"ipc://{self.folder}/hub"
        self.socket.bind(self.endpoint)
        self.environment = {"STRAKE_CONNECT": self.endpoint, "STRAKE_NAME": name, "STRAKE_CASE_HASH": HASH, "STRAKE_TOKEN": TOKEN}

    def start(self, script, *options, case=None, **environment):
        program = self.folder / "solver.py"
        program.write_text(script)
        words = ["--case", str(self.folder / "case.toml")] if case is not None else []
        if case is not None:
            (self.folder / "case.toml").write_text(case)
        self.process = subprocess.Popen([sys.executable, "-B", str(program), *words, *options], stdout=subprocess.PIPE,
                                        stderr=subprocess.STDOUT, text=True,
                                        env=dict(os.environ, PYTHONPATH=":".join(sys.path), **{**self.environment, **environment}))

    def receive(self):
        """The next reply and its arrays as bytes. What it says of its work is kept apart."""
        end = time.monotonic() + PATIENCE
        while True:
            while not self.socket.poll(50):
                if self.over or time.monotonic() > end:
                    raise TimeoutError(f"no answer within {PATIENCE} s" + self.printed())
            self.peer, header, *arrays = self.socket.recv_multipart()
            reply = pb.Reply.FromString(header)
            if reply.WhichOneof("what") != "working":
                return reply, arrays
            self.working.append(reply.working)

    def hello(self):
        return self.receive()[0].hello

    def ask(self, *frames, **what):
        """One question, such as setup=pb.Setup(); returns the reply and its arrays."""
        self.send(*frames, **what)
        reply, arrays = self.receive()
        assert reply.sequence == self.sequence, (reply.sequence, self.sequence)
        return reply, arrays

    def send(self, *frames, **what):
        self.sequence += 1
        self.socket.send_multipart([self.peer, pb.Request(sequence=self.sequence, **what).SerializeToString(),
                                    *(frame if isinstance(frame, bytes) else np.ascontiguousarray(frame).tobytes() for frame in frames)])

    def setup(self, **more):
        """Setup with an empty mesh of the partner, which is one frame of 0 bytes."""
        return self.ask(b"", setup=pb.Setup(run_folder=str(self.folder), interface="surface", partner_mesh=pb.Mesh(dimension=2), **more))

    def advance(self, t, dt, load, before="NOTHING", quantity="force", history=()):
        """One window; load: points × 3, of the window; history: pairs of time and load before its end."""
        samples, frames = [], []
        for time, values in [*history, (t + dt, load)]:
            values = np.asarray(values, "<f8")
            field = pb.Field(quantity=quantity, unit="N", components=values.shape[1], conservative=True, n_points=len(values))
            samples.append(pb.Sample(time=time, fields=[field]))
            frames.append(values)
        return self.ask(*frames, advance=pb.Advance(before=getattr(pb.Advance, before), t=t, dt=dt, iteration=1, samples=samples))

    def stop(self, commit=True):
        return self.ask(stop=pb.Stop(commit=commit))

    def printed(self):
        """How the participant ended, and what it printed."""
        if not self.process:
            return ""
        try:
            text = self.process.communicate(timeout=PATIENCE)[0]
        except subprocess.TimeoutExpired:
            self.process.kill()
            text = self.process.communicate()[0] + "\n(it did not end)"
        return text

    def close(self):
        if self.process and self.process.poll() is None:
            self.process.kill()
            self.process.communicate()
        self.socket.close()
        self.context.term()
        for path in self.folder.iterdir():
            path.unlink()
        self.folder.rmdir()
