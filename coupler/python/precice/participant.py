"""Class `Participant` with the methods of preCICE's Python bindings 3.x, carried out by Strake's messages."""
import numpy as np

from strake.errors import Error as StrakeError, nearest

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
        connection_data()  # an error of its own before one of the file
        self._name = str(solver_name)
        self._config = read_configuration(configuration_file_name, self._name)
        self._names = read_names()
        self._meshes = {name: Vertices(name, self._config.meshes[name].dimensions) for name in self._config.provided}
        self._writes, self._reads = ([(mesh, data) for mesh, data in listed if mesh in self._meshes]
                                     for listed in (self._config.write, self._config.read))
        self._stage = BEFORE
        self._asked_initial = False
        self._written, self._read = {}, {}  # by mesh and data
        self._session = self._carry_out(Session, self._name, self._config.is_implicit)

    # ---- steering

    def initialize(self):
        self._expect(BEFORE, "initialize")
        missing = [data for _, data in self._config.write if data in self._config.initial and not self._asked_initial]
        if missing:
            raise Error(f'initialize(): "{missing[0]}" has a value at the begin (exchange initialize="true"); '
                        "ask requires_initial_data() first, and write it")
        meshes = self._coupled_meshes()
        written, taken = (self._quantities(listed, verb, len(meshes))
                          for listed, verb in ((self._writes, "writes"), (self._reads, "reads")))
        self._carry_out(self._session.begin, meshes, written, self._buffers(), taken, self._config.histories)
        self._stage = DURING
        for (mesh, data), (quantity, _) in zip(self._reads, taken):
            self._read[mesh, data] = Waveform(self._session.first_value(quantity, mesh), self._config.data[data].degree)
        self._after_step()

    def advance(self, computed_timestep_length):
        self._expect(DURING, "advance")
        session, dt = self._session, float(computed_timestep_length)
        if not session.ongoing:
            raise Error("advance(): the coupling has ended; ask is_coupling_ongoing() before")
        if not np.isfinite(dt) or dt <= 0:
            raise Error(f"advance(): a time step of {dt:g} s, expected more than 0")
        if dt > session.left + SAME * session.dt:
            raise Error(f"advance(): a time step of {dt:g} s, but the window ends in {session.left:g} s; get_max_time_step_size() tells it")
        if "write" in session.duties:
            raise Error("advance(): requires_writing_checkpoint() was not asked; the window may be computed again, and the solver must save its state")
        if "read" in session.duties:
            raise Error("advance(): requires_reading_checkpoint() was not asked; the window is computed again, and the solver must return to its state")
        if self._carry_out(session.step, dt, self._buffers()) and session.complete:
            for waveform in self._read.values():
                waveform.accept()
        self._after_step()

    def finalize(self):
        if self._stage == AFTER:
            raise Error("finalize(): was called before")
        self._stage = AFTER
        self._carry_out(self._session.finish)

    # ---- status

    def get_mesh_dimensions(self, mesh_name):
        self._expect_not_after("get_mesh_dimensions")
        return self._config.used_mesh(mesh_name, "get_mesh_dimensions").dimensions

    def get_data_dimensions(self, mesh_name, data_name):
        self._expect_not_after("get_data_dimensions")
        mesh = self._config.used_mesh(mesh_name, "get_data_dimensions")
        if data_name not in mesh.data:
            raise Error(f'get_data_dimensions(): the mesh "{mesh_name}" has no data "{data_name}"; {nearest(data_name, mesh.data)}')
        return mesh.dimensions if self._config.data[data_name].is_vector else 1

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
        return self._session.ask_duty("write")

    def requires_reading_checkpoint(self):
        self._expect(DURING, "requires_reading_checkpoint")
        return self._session.ask_duty("read")

    # ---- mesh

    def requires_mesh_connectivity_for(self, mesh_name):
        self._expect_not_after("requires_mesh_connectivity_for")
        self._config.mesh(mesh_name, "requires_mesh_connectivity_for")
        # The coupler projects onto a structure's faces, and Strake's water needs them.
        return self._session.side == "structure" or mesh_name in self._config.projects

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
        if not self._session.ongoing:
            raise Error("write_data(): the run has ended")
        data = self._config.data_of(mesh_name, data_name, "write_data", self._config.write, "writes")
        mesh = self._meshes[mesh_name]
        ids = mesh.known(vertex_ids, "write_data").ravel()
        array = numbers(values, f'write_data("{mesh_name}", "{data_name}"): the values')
        width = mesh.dimensions if data.is_vector else 1
        if array.size != len(ids) * width or (array.ndim == 2 and array.shape[1] != width):
            raise Error(f'write_data(): "{data_name}" has values of the shape {array.shape}, expected {len(ids)} × {width}')
        self._buffer(mesh_name, data_name)[ids] = array.reshape(len(ids), width)

    def read_data(self, mesh_name, data_name, vertex_ids, relative_read_time):
        self._expect(DURING, "read_data")
        data = self._config.data_of(mesh_name, data_name, "read_data", self._config.read, "reads")
        mesh, session = self._meshes[mesh_name], self._session
        ids = mesh.known(vertex_ids, "read_data").ravel()
        waveform = self._read[mesh_name, data_name]
        if not session.ongoing:
            check_time("read_data", relative_read_time, 0, session.dt)
            found = waveform.begin
        else:
            check_time("read_data", relative_read_time, session.left, session.dt)
            found = waveform.at(session.now + relative_read_time)
        return found[ids, :mesh.dimensions].copy() if data.is_vector else found[ids, 0].copy()

    # ---- profiling

    def start_profiling_section(self, event_name):
        self._expect_not_after("start_profiling_section")
        self._session.start_section(event_name)

    def stop_last_profiling_section(self):
        self._expect_not_after("stop_last_profiling_section")
        self._session.stop_section()

    # ---- what Strake does not have

    def requires_gradient_data_for(self, mesh_name, data_name):
        return False

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

    def _coupled_meshes(self):
        """The meshes that have data: at least one, in one space, all with vertices."""
        names = self._config.coupled() or self._config.provided[:1]
        if not names:
            raise Error(f"initialize(): {self._name} provides no mesh")
        meshes = [self._meshes[name] for name in names]
        for mesh in meshes:
            if not len(mesh):
                raise Error(f'initialize(): the mesh "{mesh.name}" has no vertices; set_mesh_vertices() sets them')
            if mesh.dimensions != meshes[0].dimensions:
                raise Error(f'initialize(): the mesh "{mesh.name}" has {mesh.dimensions} dimensions, "{meshes[0].name}" has '
                            f"{meshes[0].dimensions}; all meshes of a participant lie in one space")
        return meshes

    def _quantities(self, listed, verb, n_meshes):
        """Pairs of quantity and name of its mesh. With several meshes each quantity stands on one of them."""
        pairs = [(self._quantity(mesh, data), mesh) for mesh, data in listed]
        seen = {}
        for (quantity, mesh), (_, data) in zip(pairs, listed):
            if quantity.name in seen and n_meshes > 1:
                raise Error(f'initialize(): {self._name} {verb} "{data}" on "{mesh}" and {seen[quantity.name]}: both are {quantity.name}; '
                            "STRAKE_PRECICE_NAMES gives data names of their own")
            seen[quantity.name] = f'"{data}" on "{mesh}"'
        return pairs

    def _quantity(self, mesh, data):
        return quantity_of(self._config.data[data], self._config.meshes[mesh].dimensions,
                           self._config.is_conservative(mesh, data), self._names)

    def _buffers(self):
        return [self._buffer(mesh, data) for mesh, data in self._writes]

    def _buffer(self, mesh, data):
        """What was written last, vertices × components of the data; 0 where nothing was."""
        n, width = len(self._meshes[mesh]), self._config.meshes[mesh].dimensions if self._config.data[data].is_vector else 1
        have = self._written.get((mesh, data))
        if have is None or len(have) < n:
            new = np.zeros((n, width))
            if have is not None:
                new[:len(have)] = have
            self._written[mesh, data] = have = new
        return have

    def _after_step(self):
        """What was written is 0 again, as in preCICE; at the begin of a window the partner's samples are taken."""
        session, self._written = self._session, {}
        if not session.ongoing or session.now != session.t:
            return
        for (mesh, data), waveform in self._read.items():
            name = self._quantity(mesh, data).name
            samples = [(time, self._carry_out(session.on_mesh, fields[name], mesh)) for time, fields in session.samples if name in fields]
            if not samples:
                sent = sorted({name for _, fields in session.samples for name in fields})
                raise Error(f'initialize(): the partner sends {", ".join(sent) or "nothing"}, and "{data}" is read as {name}; '
                            "STRAKE_PRECICE_NAMES says which quantity a data is")
            waveform.take(session.t, session.dt, samples)
