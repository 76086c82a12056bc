"""The conversation of a solver that calls: questions of the coupler become answers to the solver's own questions."""
import atexit
import os
import sys

import numpy as np

from strake.arrays import Mesh, field_header, nothing_left, spread, take_fields, take_mesh, wrong_message
from strake.connection import Connection
from strake.errors import Error as StrakeError
from strake.messages import pb
from strake.participant import error_of

from .errors import Error
from .waveform import SAME

open_sessions = []  # of this process; each leaves the list when it has ended


class Session:
    """One participant between initialize() and finalize().

    t, dt      begin [s] and length [s] of the window; now: where the solver is in it; left: to its end
    samples    pairs of time [s] and dict of fields that the partner gives for the window
    ongoing    whether a window is to be computed; complete: whether the last call of `step` ended one
    is_again   the window is computed again; must_read: and the solver has not been told yet
    """

    def __init__(self, solver, mesh, initial, histories):
        self.solver, self.initial, self.histories = solver, initial, histories
        self.mesh = Mesh(mesh.name, mesh.dimensions, mesh.points, mesh.faces)
        self.unused = mesh.unused
        self.connection = Connection(**connection_data(), solver=solver, version="precice")
        self.t = self.now = self.dt = 0.0
        self.samples, self.sent = [], []
        self.ongoing, self.complete = True, False
        self.has_written, self.is_again, self.must_read = False, False, False
        self.asked_history, self.asked_history_now = False, False
        open_sessions.append(self)

    @property
    def left(self):
        return max(0.0, self.t + self.dt - self.now)

    def step(self, dt, fields):
        """Notes a time step of the solver with what it wrote. True: it reached the window's end, and the next window is there."""
        self.complete = False
        self.now += dt
        at_end = self.left <= SAME * self.dt
        if at_end:
            self.now = self.t + self.dt
        self.sent.append((self.now, fields))
        if not at_end:
            return False
        headers = [field_header(quantity, self.mesh.n) for quantity, _ in self.initial]
        advanced, arrays = pb.Advanced(fields=headers, dt_limit=np.inf), list(fields)
        if self.asked_history or self.asked_history_now:
            for time, values in self.sent:
                advanced.history.append(pb.Sample(time=time, fields=headers))
                arrays += values
        self.connection.reply(pb.Reply(advanced=advanced), arrays)
        self.next_window()
        return True

    def ask_to_write(self):
        """Whether the solver shall save its state: at the begin of each window that is computed for the first time."""
        due = self.ongoing and self.now == self.t and not self.is_again
        self.has_written |= due
        return due

    def ask_to_read(self):
        """Whether the solver shall return to its saved state: after a window that is computed again."""
        due, self.must_read = self.ongoing and self.is_again and self.now == self.t, False
        return due

    # ---- the coupler's questions

    def next_window(self):
        """Answers questions until a window is to be computed or the run ends."""
        while True:
            request, frames = self.connection.ask()
            what = request.WhichOneof("what")
            if what == "setup":
                self.answer_setup(request.setup, frames)
            elif what == "checkpoint":
                self.answer_checkpoint(request.checkpoint)
            elif what == "advance":
                self.take_window(request.advance, frames)
                return
            elif what == "stop":
                self.complete, self.ongoing = self.complete or request.stop.commit, False
                return
            else:
                raise wrong_message("the coupler asked what this module does not know")

    def answer_setup(self, setup, frames):
        take_mesh(setup.partner_mesh, frames)
        take_fields(setup.partner_initial, frames)
        nothing_left(frames)
        self.asked_history = setup.history
        for function, count in self.unused.items():
            print(f"{self.solver}: {count} connections by {function}() are not used: the interface is its {self.mesh.dimension}-point faces",
                  file=sys.stderr)
        arrays = []
        for quantity, values in self.initial:
            more = quantity.components - values.shape[1]
            arrays.append(spread(np.pad(values, ((0, 0), (0, max(0, more)))), self.mesh.n, quantity.components, quantity.name))
        ready = pb.Ready(mesh=self.mesh.header(), dt_limit=np.inf, history=self.histories,
                         initial=[field_header(quantity, self.mesh.n) for quantity, _ in self.initial],
                         lines=[f"{self.solver}, by the names of preCICE   {self.mesh.n} vertices of {self.mesh.name}"])
        for wish in ("cannot_resume", "partner_initial"):  # messages of an older version have no such fields
            if wish in pb.Ready.DESCRIPTOR.fields_by_name:
                setattr(ready, wish, True)
        self.connection.reply(pb.Reply(ready=ready), [*self.mesh.frames(), *arrays])

    def answer_checkpoint(self, ask):
        if ask.resume:
            raise StrakeError("a solver by the names of preCICE cannot be resumed: it has no way to save its state",
                              "run it again with --force", self.solver, 2)
        self.settle(ask.before)
        self.connection.reply(pb.Reply(done=pb.Done()))

    def take_window(self, ask, frames):
        self.settle(ask.before)
        self.asked_history_now = getattr(ask, "wants_history", False)
        self.samples = [(sample.time, take_fields(sample.fields, frames)) for sample in ask.samples]
        nothing_left(frames)
        self.t, self.dt, self.now, self.sent = ask.t, ask.dt, ask.t, []

    def settle(self, before):
        """What the coupler decided of the window before: accepted, or to be computed again."""
        if before == pb.Advance.COMMIT:
            self.complete, self.is_again = True, False
        elif before == pb.Advance.REWIND:
            if not self.has_written:
                raise Error("advance(): the window is to be computed again, and the solver saves no state: it never asked "
                            "requires_writing_checkpoint(). Under explicit coupling (coupling.surface.converged.max_iterations = 1) it need not")
            self.is_again = self.must_read = True

    # ---- the end

    def finish(self):
        """Carries out finalize(), the answer to Stop. Before the end of the run it is a fault, which ends the run at once."""
        if self.ongoing:
            self.fail(StrakeError(f"called finalize() at t = {self.now:g} s, before the end of the run",
                                  "end_time of the case and the end time of the solver must be one", self.solver))
        elif self in open_sessions:
            open_sessions.remove(self)
            self.connection.reply(pb.Reply(done=pb.Done()))
            self.connection.close()

    def fail(self, error):
        """An exception that nobody caught: the coupler is told, and the run ends."""
        if self in open_sessions:
            open_sessions.remove(self)
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
    if isinstance(problem, StrakeError):
        error = problem
    elif isinstance(problem, Error):
        cause = problem.__cause__  # of the connection: it has an exit code of its own
        error = cause if isinstance(cause, StrakeError) else StrakeError(str(problem), "its traceback stands in the solver's log")
    else:
        error = error_of(problem)
    for session in list(open_sessions):
        session.fail(error)
    previous_hook(kind, problem, trace)


def on_exit():
    for session in list(open_sessions):
        if session.ongoing:
            session.fail(StrakeError(f"ended at t = {session.now:g} s without finalize()", "see the solver's log", session.solver))
        else:
            session.finish()


previous_hook, sys.excepthook = sys.excepthook, on_exception
atexit.register(on_exit)
