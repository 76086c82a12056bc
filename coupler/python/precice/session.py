"""The conversation of a solver that calls: questions of the coupler become answers to the solver's own questions."""
import atexit
import contextlib
import os
import sys
import time

import numpy as np

from strake.arrays import Mesh, field_header, nothing_left, spread, take_fields, take_mesh, wrong_message
from strake.connection import Connection
from strake.errors import Error as StrakeError
from strake.messages import pb
from strake.participant import error_of

from .errors import Error
from .vertices import joined
from .waveform import SAME

TO_RECEIVE = 1.0  # [s] for the first question of the coupler, to answer it with a fault
open_sessions = []  # of this process; each leaves the list when it has ended


class Session:
    """One participant between its constructor and finalize().

    t, dt      begin [s] and length [s] of the window; now: where the solver is in it; left: to its end
    samples    pairs of time [s] and dict of fields that the partner gives for the window
    ongoing    whether a window is to be computed; complete: whether the last call of `step` ended one
    duties     "write" and "read": whether the solver must save its state, or return to it, and has not asked yet
    """

    def __init__(self, solver, is_implicit):
        self.solver, self.is_implicit = solver, is_implicit
        data = connection_data()
        self.side = data["name"]
        self.connection = Connection(**data, solver=solver, version="precice")
        self.t = self.now = self.dt = 0.0
        self.samples, self.sent, self.monitor, self.sections = [], [], {}, []
        self.begun, self.ongoing, self.complete, self.is_again, self.asked_history = False, True, False, False, False
        self.required, self.duties = set(), set()
        open_sessions.append(self)

    @property
    def place(self):
        return f'{self.side}, preCICE participant "{self.solver}"'

    @property
    def left(self):
        return max(0.0, self.t + self.dt - self.now)

    def begin(self, meshes, written, initial, taken, histories):
        """Answers Setup with the meshes and values at t = 0, and waits for the first window.

        written, taken: pairs of quantity and name of its mesh. initial: the values of what is written.
        histories: whether the partner's samples inside a window are wanted.
        """
        points, faces, self.places = joined(meshes)
        self.mesh = Mesh(meshes[0].name if len(meshes) == 1 else self.solver, meshes[0].dimensions, points, faces)
        self.written, self.taken = written, taken
        for mesh in meshes:
            for function, count in mesh.unused.items():
                print(f"{self.solver}: {count} connections by {function}() are not used: a face has {mesh.dimensions} points", file=sys.stderr)
        request, frames = self.connection.ask()
        if request.WhichOneof("what") != "setup":
            raise wrong_message("the coupler did not begin with Setup")
        self.answer_setup(request.setup, frames, self.arrays(initial), histories)
        self.begun = True
        self.next_window()

    def step(self, dt, values):
        """Notes a time step of the solver with what it wrote. True: it reached the window's end, and the next window is there."""
        self.complete = False
        self.now += dt
        self.required, self.duties = set(), set()
        if self.left > SAME * self.dt:
            self.sent.append((self.now, self.arrays(values)))
            self.connection.working((self.now - self.t) / self.dt, "time steps inside the window")
            return False
        self.now = self.t + self.dt
        self.sent.append((self.now, self.arrays(values)))
        headers = self.headers()
        advanced = pb.Advanced(fields=headers, dt_limit=np.inf, monitor=self.monitor)
        arrays = list(self.sent[-1][1])
        for time_, sampled in self.sent if self.asked_history else ():
            advanced.history.append(pb.Sample(time=time_, fields=headers))
            arrays += sampled
        self.connection.reply(pb.Reply(advanced=advanced), arrays)
        self.next_window()
        return True

    def ask_duty(self, duty):
        """Whether the solver must "write" its state now, or "read" it back; both once in a window."""
        self.duties.discard(duty)
        return duty in self.required

    def arrays(self, values):
        """Values of what is written, on all points and with all components: 0 on other meshes, z = 0 in two dimensions."""
        made = []
        for (q, mesh), own in zip(self.written, values):
            first, n, _ = self.places[mesh]
            wide = np.pad(own, ((first, self.mesh.n - first - n), (0, max(0, q.components - own.shape[1]))))
            made.append(spread(wide, self.mesh.n, q.components, q.name))
        return made

    def headers(self):
        return [field_header(quantity, self.mesh.n) for quantity, _ in self.written]

    def on_mesh(self, values, mesh):
        """The rows of one mesh out of an array for all points."""
        first, n, _ = self.places[mesh]
        if len(values) != self.mesh.n:
            raise wrong_message(f"the coupler sent a field for {len(values)} points, expected {self.mesh.n}")
        return values[first:first + n]

    def start_section(self, name):
        self.sections.append((name, time.monotonic()))

    def stop_section(self):
        """Ends the last section: its seconds go into timing.csv."""
        if not self.sections:
            raise Error("stop_last_profiling_section(): none is open; start_profiling_section() opens one")
        name, since = self.sections.pop()
        key = f"seconds.{name}"
        self.monitor[key] = self.monitor.get(key, 0.0) + time.monotonic() - since

    # ---- the coupler's questions

    def next_window(self):
        """Answers questions until a window is to be computed or the run ends."""
        while True:
            request, frames = self.connection.ask()
            what = request.WhichOneof("what")
            if what == "checkpoint":
                self.answer_checkpoint(request.checkpoint)
            elif what == "advance":
                self.take_window(request.advance, frames)
                return
            elif what == "stop":
                self.complete, self.ongoing = self.complete or request.stop.commit, False
                return
            else:
                raise wrong_message("the coupler asked what this module does not know")

    def answer_setup(self, setup, frames, initial, histories):
        self.partner_points = take_mesh(setup.partner_mesh, frames)[0]
        self.partner_initial = take_fields(setup.partner_initial, frames)
        nothing_left(frames)
        if setup.interface == "volume":
            raise StrakeError('cannot take part where coupling.interface = "volume"', 'coupling.interface = "surface"', self.place, 3)
        self.asks_always = setup.history
        meshes = "".join(f'   mesh "{name}", {n} points' for name, (_, n, _) in self.places.items())
        ready = pb.Ready(mesh=self.mesh.header(), dt_limit=np.inf, history=histories, initial=self.headers(),
                         lines=[f'preCICE participant "{self.solver}"{meshes}'])
        self.name_meshes(ready)
        for wish in ("cannot_resume", "partner_initial"):  # messages of an older version have no such fields
            if wish in pb.Ready.DESCRIPTOR.fields_by_name:
                setattr(ready, wish, True)
        self.connection.reply(pb.Reply(ready=ready), [*self.mesh.frames(), *initial])

    def name_meshes(self, ready):
        """Tells where each of several meshes stands in the joined one, and which fields live on it."""
        if len(self.places) == 1:
            return
        for name, (point, _, face) in self.places.items():
            ready.mesh.meshes.add(name=name, first_point=point, first_face=face)
        for listed, places in ((self.written, ready.sent_on), (self.taken, ready.taken_on)):
            for quantity, mesh in listed:
                places.add(quantity=quantity.name, mesh=mesh)

    def first_value(self, quantity, mesh):
        """What the partner sends at t = 0, points × components; 0 where its points are others, or it does not tell."""
        found, points = self.partner_initial.get(quantity.name), self.on_mesh(self.mesh.points, mesh)
        if found is not None and found.shape == (len(points), quantity.components) and np.allclose(self.partner_points, points, 1e-9, 1e-9):
            return found
        return np.zeros((len(points), quantity.components))

    def answer_checkpoint(self, ask):
        if ask.resume:
            raise StrakeError("cannot resume: preCICE has no function that saves a solver's state", "run it again with --force", self.place, 3)
        self.settle(ask.before)
        self.connection.reply(pb.Reply(done=pb.Done()))

    def take_window(self, ask, frames):
        self.settle(ask.before)
        self.samples = [(sample.time, take_fields(sample.fields, frames)) for sample in ask.samples]
        nothing_left(frames)
        self.asked_history = self.asks_always or getattr(ask, "wants_history", False)
        self.t, self.dt, self.now, self.sent = ask.t, ask.dt, ask.t, []
        self.required = {"read" if self.is_again else "write"} if self.is_implicit else set()
        self.duties = set(self.required)

    def settle(self, before):
        """What the coupler decided of the window before: accepted, or to be computed again."""
        if before == pb.Advance.COMMIT:
            self.complete, self.is_again = True, False
        elif before == pb.Advance.REWIND:
            self.is_again = True
            if not self.is_implicit:
                raise StrakeError("has an explicit scheme in precice-config.xml, and a window is to be computed again",
                                  "make the scheme implicit there, or set coupling.surface.converged.max_iterations = 1", self.place, 3)

    # ---- the end

    def finish(self):
        """Carries out finalize(), the answer to Stop. Before the end of the run it is a fault, which ends the run at once."""
        if self.ongoing:
            self.fail(StrakeError(f"called finalize() at t = {self.now:g} s, before the end of the run",
                                  "end_time of the case and the end time of the solver must be one", self.place))
        elif self in open_sessions:
            open_sessions.remove(self)
            self.connection.reply(pb.Reply(done=pb.Done()))
            self.connection.close()

    def fail(self, error):
        """Tells the coupler why there will be no answer to its question. The run ends."""
        if self not in open_sessions:
            return
        open_sessions.remove(self)
        with contextlib.suppress(StrakeError):  # the connection cannot carry it: the end of the process tells
            if not self.begun and not self.connection.sequence:
                self.connection.ask(TO_RECEIVE)
            self.connection.fault(error)
        self.connection.close()


def connection_data():
    """Returns endpoint, name, hash, token and key file: of the environment, else of the options on the command line."""
    given = dict(zip(sys.argv[1::2], sys.argv[2::2]))
    found = {name: os.environ.get(variable) or given.get(option, "")
             for name, variable, option in (("endpoint", "STRAKE_CONNECT", "--connect"), ("name", "STRAKE_NAME", "--name"),
                                            ("case_hash", "STRAKE_CASE_HASH", "--case-hash"))}
    missing = [variable for variable, name in (("STRAKE_CONNECT", "endpoint"), ("STRAKE_NAME", "name")) if not found[name]]
    if missing:
        raise Error(f"Participant(): {missing[0]} is not set. This module precice belongs to Strake, whose coupler starts the solver: "
                    "strake run CASE. For preCICE itself take this module's folder out of PYTHONPATH")
    return {**found, "token": os.environ.get("STRAKE_TOKEN", ""), "key_file": os.environ.get("STRAKE_KEY", "")}


def on_exception(kind, problem, trace):
    """Tells the coupler of an exception that nobody caught, before Python prints it."""
    for session in list(open_sessions):
        session.fail(fault_of(problem, session.place))
    previous_hook(kind, problem, trace)


def fault_of(problem, place):
    if isinstance(problem, Error):
        cause = problem.__cause__  # of the connection: it has an exit code of its own
        return cause if isinstance(cause, StrakeError) else StrakeError(str(problem), "its traceback stands in the solver's log", place)
    error = error_of(problem)
    return error if isinstance(problem, StrakeError) else StrakeError(error.problem, error.fix, f"{place}, {error.where}", error.exit_code)


def on_exit():
    for session in list(open_sessions):
        if session.ongoing:
            session.fail(StrakeError(f"ended at t = {session.now:g} s without finalize()", "see the solver's log", session.place))
        else:
            session.finish()


previous_hook, sys.excepthook = sys.excepthook, on_exception
atexit.register(on_exit)
