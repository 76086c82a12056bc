"""Class `Participant` with the methods of preCICE's Python bindings 3.x, carried out by Strake's libprecice.so.3."""
import ctypes
import os

import numpy as np

from .errors import Error
from .library import library, python_name


def get_version_information():
    return library().call("getVersionInformation", result=ctypes.c_char_p)


class Participant:
    """One solver. Its calls mean what they mean under preCICE; what Strake does not have raises `Error` by name."""

    def __init__(self, solver_name, configuration_file_name, solver_process_index, solver_process_size, communicator=None):
        if not os.environ.get("STRAKE_CONNECT"):
            raise Error("Participant(): STRAKE_CONNECT is not set. This module precice belongs to Strake, whose coupler starts the solver: "
                        "strake run CASE. For preCICE itself take this module's folder out of PYTHONPATH")
        self._library, self._finalized = library(), False
        self._call("createParticipant", str(solver_name), str(configuration_file_name), int(solver_process_index), int(solver_process_size))

    # ---- steering

    def initialize(self):
        self._call("initialize")

    def advance(self, computed_timestep_length):
        self._call("advance", float(computed_timestep_length))

    def finalize(self):
        self._call("finalize")
        self._finalized = True

    # ---- status

    def get_mesh_dimensions(self, mesh_name):
        return self._call("getMeshDimensions", mesh_name)

    def get_data_dimensions(self, mesh_name, data_name):
        return self._call("getDataDimensions", mesh_name, data_name)

    def is_coupling_ongoing(self):
        return bool(self._call("isCouplingOngoing"))

    def is_time_window_complete(self):
        return bool(self._call("isTimeWindowComplete"))

    def get_max_time_step_size(self):
        return self._call("getMaxTimeStepSize", result=ctypes.c_double)

    def requires_initial_data(self):
        return bool(self._call("requiresInitialData"))

    def requires_writing_checkpoint(self):
        return bool(self._call("requiresWritingCheckpoint"))

    def requires_reading_checkpoint(self):
        return bool(self._call("requiresReadingCheckpoint"))

    # ---- mesh

    def requires_mesh_connectivity_for(self, mesh_name):
        return bool(self._call("requiresMeshConnectivityFor", mesh_name))

    def set_mesh_vertex(self, mesh_name, position):
        return self._call("setMeshVertex", mesh_name, rows(position, 1, self._width("setMeshVertex", mesh_name), "set_mesh_vertex(): the position"))

    def set_mesh_vertices(self, mesh_name, positions):
        n = len(positions)
        points = rows(positions, n, self._width("setMeshVertices", mesh_name), "set_mesh_vertices(): the positions")
        ids = np.empty(n, np.int32)
        self._call("setMeshVertices", mesh_name, n, points, ids)
        return ids

    def get_mesh_vertex_size(self, mesh_name):
        return self._call("getMeshVertexSize", mesh_name)

    def get_mesh_vertex_ids_and_coordinates(self, mesh_name):
        n = self.get_mesh_vertex_size(mesh_name)
        ids, coordinates = np.empty(n, np.int32), np.empty((n, self.get_mesh_dimensions(mesh_name)))
        self._call("getMeshVertexIDsAndCoordinates", mesh_name, n, ids, coordinates)
        return ids, coordinates

    def set_mesh_edge(self, mesh_name, first_vertex_id, second_vertex_id):
        self._call("setMeshEdge", mesh_name, int(first_vertex_id), int(second_vertex_id))

    def set_mesh_edges(self, mesh_name, vertices):
        self._connect("setMeshEdges", mesh_name, vertices, 2)

    def set_mesh_triangle(self, mesh_name, first_vertex_id, second_vertex_id, third_vertex_id):
        self._call("setMeshTriangle", mesh_name, int(first_vertex_id), int(second_vertex_id), int(third_vertex_id))

    def set_mesh_triangles(self, mesh_name, vertices):
        self._connect("setMeshTriangles", mesh_name, vertices, 3)

    def set_mesh_quad(self, mesh_name, first_vertex_id, second_vertex_id, third_vertex_id, fourth_vertex_id):
        self._call("setMeshQuad", mesh_name, int(first_vertex_id), int(second_vertex_id), int(third_vertex_id), int(fourth_vertex_id))

    def set_mesh_quads(self, mesh_name, vertices):
        self._connect("setMeshQuads", mesh_name, vertices, 4)

    def set_mesh_tetrahedron(self, mesh_name, first_vertex_id, second_vertex_id, third_vertex_id, fourth_vertex_id):
        self._call("setMeshTetrahedron", mesh_name, int(first_vertex_id), int(second_vertex_id), int(third_vertex_id), int(fourth_vertex_id))

    def set_mesh_tetrahedra(self, mesh_name, vertices):
        self._connect("setMeshTetrahedra", mesh_name, vertices, 4)

    # ---- data

    def write_data(self, mesh_name, data_name, vertex_ids, values):
        ids = whole_numbers(vertex_ids, "write_data").ravel()
        width = self._width("writeData", mesh_name, data_name, function="getDataDimensions")
        array = rows(values, len(ids), width, f'write_data("{mesh_name}", "{data_name}"): the values')
        self._call("writeData", mesh_name, data_name, len(ids), ids, array)

    def read_data(self, mesh_name, data_name, vertex_ids, relative_read_time):
        ids = whole_numbers(vertex_ids, "read_data").ravel()
        width = self._width("readData", mesh_name, data_name, function="getDataDimensions")
        values = np.empty((len(ids), width))
        self._call("readData", mesh_name, data_name, len(ids), ids, float(relative_read_time), values)
        return values if width > 1 else values[:, 0]

    # ---- profiling

    def start_profiling_section(self, event_name):
        self._call("startProfilingSection", event_name)

    def stop_last_profiling_section(self):
        self._call("stopLastProfilingSection")

    # ---- what Strake does not have: the library refuses it before it looks at arrays

    def requires_gradient_data_for(self, mesh_name, data_name):
        return bool(self._call("requiresGradientDataFor", mesh_name, data_name))

    def write_gradient_data(self, mesh_name, data_name, vertex_ids, gradients):
        self._call("writeGradientData", mesh_name, data_name, 0, NOTHING, NOTHING)

    def set_mesh_access_region(self, mesh_name, bounding_box):
        self._call("setMeshAccessRegion", mesh_name, NOTHING)

    def write_and_map_data(self, mesh_name, data_name, coordinates, values):
        self._call("writeAndMapData", mesh_name, data_name, 0, NOTHING, NOTHING)

    def map_and_read_data(self, mesh_name, data_name, coordinates, relative_read_time):
        self._call("mapAndReadData", mesh_name, data_name, 0, NOTHING, 0.0, NOTHING)

    def reset_mesh(self, mesh_name):
        self._call("resetMesh", mesh_name)

    # ---- inside

    def _call(self, function, *arguments, **result):
        if self._finalized:
            raise Error(f"{python_name(function)}(): was called after finalize()")
        return self._library.call(function, *arguments, **result)

    def _width(self, caller, *names, function="getMeshDimensions"):
        """What a function says of a mesh or its data; an error names the caller."""
        try:
            return self._call(function, *names)
        except Error as e:
            raise Error(str(e).replace(python_name(function), python_name(caller), 1)) from None

    def _connect(self, function, mesh_name, vertices, corners):
        ids = whole_numbers(vertices, python_name(function))
        if ids.size % corners or (ids.ndim == 2 and ids.shape[1] != corners):
            raise Error(f"{python_name(function)}(): ids of the shape {ids.shape}, expected {corners} in a row")
        self._call(function, mesh_name, ids.size // corners, ids)


NOTHING = np.zeros(0)


def rows(values, n, width, what):
    """Values as n rows of float64; Error where they are no numbers, or not as many."""
    try:
        array = np.ascontiguousarray(values, float)
    except (TypeError, ValueError):
        raise Error(f"{what} are no numbers") from None
    if array.size != n * width or (array.ndim == 2 and array.shape[1] != width and array.size):
        raise Error(f"{what} have the shape {array.shape}, expected {n} × {width}")
    return array


def whole_numbers(ids, function):
    array = np.asarray(ids)
    if array.size and array.dtype.kind not in "iu":
        raise Error(f"{function}(): ids are whole numbers, not {array.dtype}")
    return np.ascontiguousarray(array, np.int32)
