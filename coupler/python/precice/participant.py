"""Class `Participant` with the methods of preCICE's Python bindings 3.x, carried out by Strake's messages."""
import numpy as np

from strake.arrays import spread
from strake.errors import Error as StrakeError

from .config import read_configuration
from .errors import Error, refuse
from .names import quantity_of, read_names
from .session import Session, connection_data
from .vertices import Vertices, numbers
from .waveform import SAME, Waveform, check_time

VERSION = b"3.4.1-strake; pure Python; coupled by Strake"
BEFORE, DURING, AFTER = "initialize", "advance", "finalize"  # what a participant has still to be asked


def get_version_information():
    return VERSION


class Participant:
    """One solver. Its calls mean what they mean under preCICE; what Strake does not have raises `Error` by name."""

    def __init__(self, solver_name, configuration_file_name, solver_process_index, solver_process_size, communicator=None):
        if (solver_process_index, solver_process_size) != (0, 1):
            raise Error(f"Participant(): process {solver_process_index} of {solver_process_size}: Strake couples a solver in one process")
        connection_data()
        self._name = str(solver_name)
        self._config = read_configuration(configuration_file_name, self._name)
        self._names = read_names()
        self._meshes = {name: Vertices(name, self._config.meshes[name].dimensions) for name in self._config.provided}
        self._stage = BEFORE
        self._asked_initial = False
        self._written, self._read, self._session = {}, {}, None

    # ---- steering

    def initialize(self):
        self._expect(BEFORE, "initialize")
        missing = [data for _, data in self._config.write if data in self._config.initial and not self._asked_initial]
        if missing:
            raise Error(f'initialize(): "{missing[0]}" has a value at the begin (exchange initialize="true"); '
                        "ask requires_initial_data() first, and write it")
        mesh = self._own_mesh()
        written = {data: self._buffer(mesh, data) for owner, data in self._config.write if owner == mesh.name}
        initial = [(self._quantity(mesh, data), values) for data, values in written.items()]
        self._session = self._carry_out(Session, self._name, mesh, initial, self._config.histories)
        self._read = {data: Waveform(np.zeros((len(mesh), self._quantity(mesh, data).components)), self._config.data[data].degree)
                      for owner, data in self._config.read if owner == mesh.name}
        self._stage = DURING
        self._carry_out(self._session.next_window)
        self._take_samples(mesh)

    def advance(self, computed_timestep_length):
        self._expect(DURING, "advance")
        session, dt = self._session, float(computed_timestep_length)
        if not session.ongoing:
            raise Error("advance(): the coupling has ended; ask is_coupling_ongoing() before")
        if not np.isfinite(dt) or dt <= 0:
            raise Error(f"advance(): a time step of {dt:g} s, expected more than 0")
        if dt > session.left * (1 + SAME) + SAME * session.dt:
            raise Error(f"advance(): a time step of {dt:g} s, but the window ends in {session.left:g} s; get_max_time_step_size() tells it")
        if session.must_read:
            raise Error("advance(): the window is to be computed again, and requires_reading_checkpoint() was not asked: "
                        "the solver must return to its checkpoint")
        mesh = self._own_mesh()
        fields = [spread(self._padded(mesh, data, values), len(mesh), self._quantity(mesh, data).components, data)
                  for data, values in self._written.items()]
        if self._carry_out(session.step, dt, fields):
            if session.complete:
                for waveform in self._read.values():
                    waveform.accept()
            if session.ongoing:
                self._take_samples(mesh)

    def finalize(self):
        if self._stage == AFTER:
            raise Error("finalize(): was called before")
        self._stage = AFTER
        if self._session:
            self._carry_out(self._session.finish)

    # ---- status

    def get_mesh_dimensions(self, mesh_name):
        self._expect_not_after("get_mesh_dimensions")
        if mesh_name in self._config.received:
            return self._config.meshes[mesh_name].dimensions
        return self._config.mesh(mesh_name, "get_mesh_dimensions").dimensions

    def get_data_dimensions(self, mesh_name, data_name):
        self._expect_not_after("get_data_dimensions")
        data = self._config.data_of(mesh_name, data_name, "get_data_dimensions", self._config.read + self._config.write, "reads and writes")
        return self._config.meshes[mesh_name].dimensions if data.is_vector else 1

    def is_coupling_ongoing(self):
        self._expect(DURING, "is_coupling_ongoing")
        return self._session.ongoing

    def is_time_window_complete(self):
        self._expect(DURING, "is_time_window_complete")
        return self._session.complete

    def get_max_time_step_size(self):
        self._expect(DURING, "get_max_time_step_size")
        return self._session.left if self._session.ongoing else 0.0

    def requires_initial_data(self):
        self._expect(BEFORE, "requires_initial_data")
        self._asked_initial = True
        return any(data in self._config.initial for _, data in self._config.write)

    def requires_writing_checkpoint(self):
        self._expect(DURING, "requires_writing_checkpoint")
        return self._session.ask_to_write()

    def requires_reading_checkpoint(self):
        self._expect(DURING, "requires_reading_checkpoint")
        return self._session.ask_to_read()

    # ---- mesh

    def requires_mesh_connectivity_for(self, mesh_name):
        self._expect_not_after("requires_mesh_connectivity_for")
        self._config.mesh(mesh_name, "requires_mesh_connectivity_for")
        return True  # the water of Strake needs faces, and no mapping minds them

    def set_mesh_vertex(self, mesh_name, position):
        return int(self._mesh(mesh_name, "set_mesh_vertex").add([position], "set_mesh_vertex")[0])

    def set_mesh_vertices(self, mesh_name, positions):
        return self._mesh(mesh_name, "set_mesh_vertices").add(positions, "set_mesh_vertices")

    def get_mesh_vertex_size(self, mesh_name):
        self._expect_not_after("get_mesh_vertex_size")
        self._config.mesh(mesh_name, "get_mesh_vertex_size")
        return len(self._meshes[mesh_name])

    def set_mesh_edge(self, mesh_name, first_vertex_id, second_vertex_id):
        self._mesh(mesh_name, "set_mesh_edge").connect([first_vertex_id, second_vertex_id], 2, "set_mesh_edge")

    def set_mesh_edges(self, mesh_name, vertices):
        self._mesh(mesh_name, "set_mesh_edges").connect(vertices, 2, "set_mesh_edges")

    def set_mesh_triangle(self, mesh_name, first_vertex_id, second_vertex_id, third_vertex_id):
        self._mesh(mesh_name, "set_mesh_triangle").connect([first_vertex_id, second_vertex_id, third_vertex_id], 3, "set_mesh_triangle")

    def set_mesh_triangles(self, mesh_name, vertices):
        self._mesh(mesh_name, "set_mesh_triangles").connect(vertices, 3, "set_mesh_triangles")

    def set_mesh_quad(self, mesh_name, first_vertex_id, second_vertex_id, third_vertex_id, fourth_vertex_id):
        ids = [first_vertex_id, second_vertex_id, third_vertex_id, fourth_vertex_id]
        self._mesh(mesh_name, "set_mesh_quad").connect(ids, 4, "set_mesh_quad")

    def set_mesh_quads(self, mesh_name, vertices):
        self._mesh(mesh_name, "set_mesh_quads").connect(vertices, 4, "set_mesh_quads")

    def set_mesh_tetrahedron(self, mesh_name, first_vertex_id, second_vertex_id, third_vertex_id, fourth_vertex_id):
        ids = [first_vertex_id, second_vertex_id, third_vertex_id, fourth_vertex_id]
        self._mesh(mesh_name, "set_mesh_tetrahedron").connect(ids, 4, "set_mesh_tetrahedron")

    def set_mesh_tetrahedra(self, mesh_name, vertices):
        self._mesh(mesh_name, "set_mesh_tetrahedra").connect(vertices, 4, "set_mesh_tetrahedra")

    # ---- data

    def write_data(self, mesh_name, data_name, vertex_ids, values):
        self._expect_not_after("write_data")
        data = self._config.data_of(mesh_name, data_name, "write_data", self._config.write, "writes")
        mesh = self._meshes[mesh_name]
        ids = mesh.known(vertex_ids, "write_data").ravel()
        array = numbers(values, f'write_data("{mesh_name}", "{data_name}"): the values')
        width = mesh.dimensions if data.is_vector else 1
        if array.size != len(ids) * width or (array.ndim == 2 and array.shape[1] != width):
            raise Error(f'write_data(): "{data_name}" has values of the shape {array.shape}, expected {len(ids)} × {width}')
        self._buffer(mesh, data_name)[ids] = array.reshape(len(ids), width)

    def read_data(self, mesh_name, data_name, vertex_ids, relative_read_time):
        self._expect(DURING, "read_data")
        data = self._config.data_of(mesh_name, data_name, "read_data", self._config.read, "reads")
        mesh, session = self._meshes[mesh_name], self._session
        ids = mesh.known(vertex_ids, "read_data").ravel()
        waveform = self._read[data_name]
        if not session.ongoing:
            check_time("read_data", relative_read_time, 0, session.dt)
            found = waveform.begin
        else:
            check_time("read_data", relative_read_time, session.left, session.dt)
            found = waveform.at(session.now + relative_read_time)
        return found[ids, :mesh.dimensions].copy() if data.is_vector else found[ids, 0].copy()

    # ---- what Strake does not have

    def requires_gradient_data_for(self, mesh_name, data_name):
        return False

    def start_profiling_section(self, event_name):
        """Not recorded: trace.json holds the windows of every solver."""

    def stop_last_profiling_section(self):
        """See start_profiling_section."""

    def write_gradient_data(self, mesh_name, data_name, vertex_ids, gradients):
        refuse("write_gradient_data", "no mapping of it takes gradients; requires_gradient_data_for() says so")

    def set_mesh_access_region(self, mesh_name, bounding_box):
        refuse("set_mesh_access_region", "a solver sees its own mesh alone")

    def get_mesh_vertex_ids_and_coordinates(self, mesh_name):
        refuse("get_mesh_vertex_ids_and_coordinates", "a solver sees its own mesh alone")

    def write_and_map_data(self, mesh_name, data_name, coordinates, values):
        refuse("write_and_map_data", "values are mapped from the points of a mesh; use set_mesh_vertices and write_data")

    def map_and_read_data(self, mesh_name, data_name, coordinates, relative_read_time):
        refuse("map_and_read_data", "values are mapped onto the points of a mesh; use set_mesh_vertices and read_data")

    def reset_mesh(self, mesh_name):
        refuse("reset_mesh", "a mesh stays as it is for the whole run")

    # ---- inside

    def _carry_out(self, step, *arguments):
        """Calls a part of the conversation; its errors become errors of this module."""
        try:
            return step(*arguments)
        except StrakeError as e:
            raise Error(str(e)) from e

    def _expect_not_after(self, function):
        if self._stage == AFTER:
            raise Error(f"{function}(): was called after finalize()")

    def _expect(self, stage, function):
        self._expect_not_after(function)
        if self._stage != stage:
            raise Error(f"{function}(): was called {'before' if stage == DURING else 'after'} initialize()")

    def _mesh(self, name, function):
        self._expect_not_after(function)
        if self._stage != BEFORE:
            raise Error(f"{function}(): was called after initialize(); a mesh stays as it is for the whole run")
        self._config.mesh(name, function)
        return self._meshes[name]

    def _own_mesh(self):
        """The one mesh that is coupled."""
        used = [mesh for mesh in self._meshes.values() if len(mesh)] or list(self._meshes.values())
        if len(used) != 1:
            raise Error(f"initialize(): {self._name} provides {len(used)} meshes ({', '.join(m.name for m in used) or 'none'}); "
                        "Strake couples one mesh of each solver")
        if not len(used[0]):
            raise Error(f'initialize(): the mesh "{used[0].name}" has no vertices')
        return used[0]

    def _quantity(self, mesh, data):
        return quantity_of(self._config.data[data], mesh.dimensions, mesh.name in self._config.conservative, self._names)

    def _buffer(self, mesh, data):
        """What was written last, vertices × components of the data; 0 where nothing was."""
        width = mesh.dimensions if self._config.data[data].is_vector else 1
        have = self._written.get(data)
        if have is None or len(have) < len(mesh):
            new = np.zeros((len(mesh), width))
            if have is not None:
                new[:len(have)] = have
            self._written[data] = have = new
        return have

    def _padded(self, mesh, data, values):
        """Values with the components that the quantity has: z = 0 in two dimensions."""
        more = self._quantity(mesh, data).components - values.shape[1]
        return np.concatenate([values, np.zeros((len(values), more))], 1) if more > 0 else values

    def _take_samples(self, mesh):
        session = self._session
        if not session.ongoing:
            return
        for data, waveform in self._read.items():
            name = self._quantity(mesh, data).name
            samples = [(time, fields[name]) for time, fields in session.samples if name in fields]
            if not samples:
                sent = sorted({name for _, fields in session.samples for name in fields})
                raise Error(f'initialize(): the partner sends {", ".join(sent) or "nothing"}, and "{data}" is read as {name}; '
                            "STRAKE_PRECICE_NAMES says which quantity a data is")
            waveform.take(session.t, session.dt, samples)
