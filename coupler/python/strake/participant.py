"""A solver of one's own in Python: a class with a mesh and a time step, derived from `Participant`."""
import copy
import pathlib
import sys
import traceback
import types

import numpy as np

from . import quantities
from .arrays import Mesh, field_header, nothing_left, spread, take_fields, take_mesh, wrong_message
from .connection import Connection
from .errors import Error, RetrySmallerStep
from .faults import error_of
from .messages import pb
from .options import Options

MONITOR_PREFIXES = ("seconds", "count", "check", "memory", "alarm")  # of names that are no columns


class Participant:
    """One solver of a run. Derive from it, write `build` and `advance`, and call `main` at the end of the program.

    What `build` sets:
      points      a row for each point of the interface, two or three components [m], reference configuration
      faces       a row of point indices for each face, the normal into the fluid; none: the solid's own points (volume)
      mass        kg for each point; only for `coupling.interface = "volume"`
      state       all that changes in time: an array, a number, or a dict of them. `advance` changes it as it likes: before
                  it is called, the base class brings the last accepted state back
      sends       names of the quantities that `advance` returns, or a dict: name -> values at t = 0;
                  not set: displacement of a structure, force of a fluid, 0 at t = 0
      columns     dict: name -> unit of columns of history.csv, whose values `advance` puts into `monitor`
      lines       texts for the head of the run's console
      dt_limit    longest window that the solver accepts [s]
    What it may read:
      side        "structure", "fluid" or "attachment"; dimension: 2 or 3; case: the case file as a dict; run_folder
      partner     position n × 3 [m] and faces of the partner's mesh; no points for the side that is set up first. Of an
                  attachment: the points of the structure that it is attached to, which are its `points` too
      partner_initial   what the partner sends, at t = 0: dict of arrays
    """

    version = "1"     # of the solver; run.json names it
    history = False   # True: `samples` holds the load at every step of the fluid, not its mean alone
    can_resume = True  # False: the solver cannot save its state, so the run writes no checkpoints

    points = faces = mass = state = sends = connection = None
    dt_limit = np.inf

    def __init__(self, options):
        self.options, self.side, self.name = options, options.side, options.stem
        self.columns, self.lines, self.monitor, self.samples, self.sent = {}, [], {}, [], []
        self.committed, self.wants_history = None, False

    # ---- what a solver writes

    def build(self, key):
        """Sets mesh and state. key: the table [structure.<program>] of the case, of bodies and attachments its own, with every --set."""
        raise NotImplementedError(f"{type(self).__name__} has no build(self, key)")

    def advance(self, t, dt, load):
        """Computes the window [t, t + dt] from `state`, which it changes to that of the window's end.

        load      dict: quantity -> points × components; force: mean over the window [N, 2-D: N/m]; motion, which a fluid
                  and an attachment receive: at its end
        returns   what `sends` names, points × components or one row for all points; a dict where it names several
        """
        raise NotImplementedError(f"{type(self).__name__} has no advance(self, t, dt, load)")

    def rewind(self):
        """Called before a window is computed again; for what is not in `state`."""

    def commit(self, write_output):
        """Called once a window is accepted. write_output: a field frame is due."""

    def write_checkpoint(self, folder):
        """Writes the accepted state into the folder of a checkpoint; overridden where `state` does not hold all of it."""
        np.savez(self.checkpoint_file(folder), **self.arrays_of_state())

    def read_checkpoint(self, folder):
        """Reads what `write_checkpoint` wrote, and sets `state`."""
        with np.load(self.checkpoint_file(folder)) as file:
            found = {name: file[name] for name in file.files}
        expected = self.arrays_of_state()
        for name in expected.keys() | found.keys():
            shapes = [arrays[name].shape if name in arrays else None for arrays in (found, expected)]
            if shapes[0] != shapes[1]:
                raise Error(f"{name} has the shape {shapes[0]}, expected {shapes[1]}", "run it again with --force", folder, 3)
        found = {name: array if array.ndim else array.item() for name, array in found.items()}
        self.state = found if isinstance(self.state, dict) else found.get("state")

    def close(self):
        """Called at the end of a run that went well: writes what is still to be written."""

    # ---- what a solver may call

    def working(self, fraction, what):
        """Tells the coupler how far a long computation is, 0 to 1. A solver that is silent for long is given up."""
        if self.connection:
            self.connection.working(fraction, what)

    def sample(self, time, values):
        """Adds values at a time inside the window to the history that the partner receives, where it asked for one."""
        if self.wants_history:
            self.sent.append((time, self.checked(values)))

    @classmethod
    def main(cls, arguments=None):
        """Takes part in a run until its end, and ends the program with an exit code of proto/README.md."""
        sys.stdout.reconfigure(line_buffering=True)  # a log is read while it is written
        try:
            solver = cls(Options(arguments))
            solver.connection = Connection(solver.options.endpoint, solver.options.name, solver.options.case_hash, solver.options.token,
                                           solver.name, str(cls.version), solver.options.key_file)
        except Error as e:
            sys.exit(report(e))
        sys.exit(solver.serve())

    @classmethod
    def alone(cls, key, side="structure", dimension=2):
        """A solver without a coupler, for a test: built from the keys given, checked, and ready for `advance`."""
        solver = cls(types.SimpleNamespace(name=side, side=side, stem=cls.__name__.lower()))
        solver.case, solver.dimension, solver.partner, solver.partner_initial = {}, dimension, (np.zeros((0, 3)), None), {}
        solver.make(key)
        return solver

    # ---- the conversation

    def serve(self):
        try:
            while True:
                request, frames = self.connection.ask()
                what = request.WhichOneof("what")
                answer = getattr(self, f"on_{what}", None)
                if answer is None:
                    raise wrong_message("the coupler asked what this package does not know")
                answer(getattr(request, what), frames)
                if what == "stop":
                    self.connection.close()
                    return 0
        except Error as e:
            code = report(e)
            self.connection.fault(e)
        except BaseException as e:  # whatever a solver raises ends the run at once and is named
            traceback.print_exc()
            self.connection.fault(error_of(e))
            code = 4
        self.connection.close()
        return code

    def on_setup(self, setup, frames):
        self.partner = take_mesh(setup.partner_mesh, frames)
        self.partner_initial = take_fields(setup.partner_initial, frames)
        nothing_left(frames)
        self.run_folder, self.asked_history = setup.run_folder, setup.history
        self.case = self.options.read_case()
        self.dimension = int(self.case.get("fluid", {}).get("dimension", 2))
        initial = self.make(self.options.own_keys(self.case))
        columns = [pb.Column(name=name, unit=unit) for name, unit in self.columns.items()]
        ready = pb.Ready(mesh=self.mesh.header(), dt_limit=self.dt_limit, columns=columns, lines=self.lines, history=self.history,
                         initial=[field_header(quantity, self.mesh.n) for quantity, _ in initial])
        if not self.can_resume and "cannot_resume" in pb.Ready.DESCRIPTOR.fields_by_name:
            ready.cannot_resume = True
        self.connection.reply(pb.Reply(ready=ready), [*self.mesh.frames(), *(values for _, values in initial)])

    def make(self, key):
        """Builds the solver and checks what it set; returns what it sends at t = 0."""
        if self.side == "attachment":
            self.points = self.partner[0]
        self.build(key)
        self.lines = self.lines or [f"{self.name} {self.version}   {len(self.points) if self.points is not None else 0} points"]
        self.mesh = Mesh(self.name, self.dimension, self.points, self.faces, self.mass)
        self.committed = copy.deepcopy(self.state)
        return self.initial_fields()

    def on_advance(self, ask, frames):
        self.settle(ask.before, ask.write_output)
        self.wants_history = self.asked_history or getattr(ask, "wants_history", False)
        self.samples = [(sample.time, take_fields(sample.fields, frames)) for sample in ask.samples]
        nothing_left(frames)
        self.check_load()
        self.state, self.sent = copy.deepcopy(self.committed), []
        load = self.samples[-1][1] if self.samples else self.no_load()
        try:
            values = self.checked(self.advance(ask.t, ask.dt, load))
            self.check_monitor()
        except RetrySmallerStep as e:
            self.state = copy.deepcopy(self.committed)
            advanced = pb.Advanced(dt_limit=e.limit, retry_smaller_dt=True, why=e.why, fix=e.fix)
            return self.connection.reply(pb.Reply(advanced=advanced))
        headers = [field_header(quantity, self.mesh.n) for quantity in self.exchanged]
        advanced = pb.Advanced(fields=headers, dt_limit=self.dt_limit, monitor={k: float(v) for k, v in self.monitor.items()})
        arrays = list(values)
        if self.wants_history:
            end = ask.t + ask.dt
            for time, sampled in [*(sample for sample in self.sent if sample[0] < end), (end, values)]:
                advanced.history.append(pb.Sample(time=time, fields=headers))
                arrays += sampled
        return self.connection.reply(pb.Reply(advanced=advanced), arrays)

    def on_checkpoint(self, ask, frames):
        self.settle(ask.before, ask.write_output)
        if ask.resume:
            self.read_checkpoint(ask.folder)
            self.committed = copy.deepcopy(self.state)
        else:
            self.state = copy.deepcopy(self.committed)
            self.write_checkpoint(ask.folder)
        self.connection.reply(pb.Reply(done=pb.Done()))

    def on_stop(self, ask, frames):
        if ask.commit:
            self.settle(pb.Advance.COMMIT, ask.write_output)
        self.close()
        self.connection.reply(pb.Reply(done=pb.Done()))

    def settle(self, before, write_output):
        if before == pb.Advance.COMMIT:
            self.committed = copy.deepcopy(self.state)
            self.commit(write_output)
        elif before == pb.Advance.REWIND:
            self.state = copy.deepcopy(self.committed)
            self.rewind()

    # ---- checks

    def initial_fields(self):
        """Pairs of quantity and values at t = 0, in the order in which they are sent."""
        sends = self.sends or (quantities.SENT_BY[self.side],)
        if isinstance(sends, str):
            sends = (sends,)
        initial = sends if isinstance(sends, dict) else {name: 0 for name in sends}
        pairs = [(quantities.quantity(name), values) for name, values in initial.items()]
        self.exchanged = [quantity for quantity, _ in pairs]
        return [(q, spread(values, self.mesh.n, q.components, f"{q.name} at t = 0")) for q, values in pairs]

    def checked(self, values):
        """What `advance` returned, as arrays in the order of `exchanged`."""
        if values is None:
            raise Error(f"advance() returned None, expected {', '.join(q.name for q in self.exchanged)}", "end it with return and the values at all points")
        if not isinstance(values, dict):
            if len(self.exchanged) > 1:
                raise Error(f"advance() returned one array, expected a dict of {', '.join(q.name for q in self.exchanged)}")
            values = {self.exchanged[0].name: values}
        missing = [q.name for q in self.exchanged if q.name not in values]
        if missing or len(values) > len(self.exchanged):
            raise Error(f"advance() returned {', '.join(values) or 'nothing'}, expected {', '.join(q.name for q in self.exchanged)}")
        return [spread(values[q.name], self.mesh.n, q.components, q.name) for q in self.exchanged]

    def no_load(self):
        """Zeros of what the side receives, for a solver without a partner: `fluid.solver = "none"`."""
        received = quantities.RECEIVED_BY.get(self.side, ())
        return {name: np.zeros((self.mesh.n, quantities.quantity(name).components)) for name in received}

    def check_monitor(self):
        """A value that neither a column nor a prefix of proto/WIRE.md ("Names in `monitor`") takes would be lost."""
        for name in self.monitor:
            if name not in self.columns and ":" not in name and name.split(".")[0] not in MONITOR_PREFIXES:
                raise Error(f'self.monitor["{name}"] is no column, its values would be lost',
                            f'name it in build(): self.columns = {{"{name}": "1"}}, with its unit')

    def check_load(self):
        for _, fields in self.samples:
            for name, values in fields.items():
                if len(values) != self.mesh.n:
                    raise wrong_message(f"the coupler sent {name} at {len(values)} points, the mesh has {self.mesh.n}")

    def checkpoint_file(self, folder):
        return pathlib.Path(folder) / f"{self.options.name}.npz"

    def arrays_of_state(self):
        state = {} if self.state is None else self.state if isinstance(self.state, dict) else {"state": self.state}
        arrays = {name: np.asarray(value) for name, value in state.items()}
        odd = [name for name, array in arrays.items() if array.dtype.kind not in "biufc"]
        if odd:
            raise Error(f"the state {odd[0]} is {type(state[odd[0]]).__name__}, which no checkpoint can hold",
                        "make it an array, or override write_checkpoint(folder) and read_checkpoint(folder)")
        return arrays


def report(error):
    sys.stderr.write(f"{error}\n")
    return error.exit_code
