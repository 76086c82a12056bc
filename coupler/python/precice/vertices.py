"""The mesh that a solver gives: vertices, and what connects them."""
import numpy as np

from .errors import Error


class Vertices:
    """Vertices of one mesh in the order in which they came, and the faces of its interface.

    A face is an edge in two dimensions and a triangle in three. Other connections are counted and not used.
    """

    def __init__(self, name, dimensions):
        self.name, self.dimensions = name, dimensions
        self.points, self.faces, self.unused = [], [], {}

    def __len__(self):
        return len(self.points)

    def add(self, positions, function):
        """Ids of new vertices; positions n × dimensions [m]."""
        array = numbers(positions, f"{function}(): the positions")
        if array.size == 0:
            return np.zeros(0, np.int32)
        if array.ndim != 2 or array.shape[1] != self.dimensions:
            raise Error(f'{function}(): positions of the shape {array.shape}, the mesh "{self.name}" has {self.dimensions} dimensions')
        first = len(self.points)
        self.points.extend(array.tolist())
        return np.arange(first, len(self.points), dtype=np.int32)

    def connect(self, ids, corners, function):
        """Adds edges (2 corners), triangles (3), quads or tetrahedra (4, by the function's name)."""
        array = self.known(ids, function)
        if array.size % corners or (array.ndim == 2 and array.shape[1] != corners):
            raise Error(f"{function}(): ids of the shape {array.shape}, expected {corners} in a row")
        rows = array.reshape(-1, corners).tolist()
        for row in rows:
            if len(set(row)) < corners:
                raise Error(f"{function}(): the ids {row} name a vertex twice")
        if corners == self.dimensions:
            self.faces.extend(rows)
        elif self.dimensions == 3 and "quad" in function:
            for row in rows:
                self.faces.extend(self.halves(row))
        elif rows:
            self.unused[function] = self.unused.get(function, 0) + len(rows)

    def halves(self, quad):
        """Two triangles of a quad, cut along its shorter diagonal; both go round as the quad does."""
        a, b, c, d = quad
        x = {i: np.array(self.points[i]) for i in quad}
        if np.linalg.norm(x[a] - x[c]) <= np.linalg.norm(x[b] - x[d]):
            return [[a, b, c], [a, c, d]]
        return [[a, b, d], [b, c, d]]

    def known(self, ids, function):
        """Ids as an array; Error with one that is none of this mesh."""
        array = np.asarray(ids)
        if array.size and array.dtype.kind not in "iu":
            raise Error(f"{function}(): ids are whole numbers, not {array.dtype}")
        if array.size and (array.min() < 0 or array.max() >= len(self)):
            wrong = array.max() if array.max() >= len(self) else array.min()
            raise Error(f'{function}(): there is no vertex {wrong} in "{self.name}"; it has {len(self)}')
        return array.astype(np.int64)


def joined(meshes):
    """Points and faces of all meshes, one after the other, and of each its first point, number of points and first face by name."""
    points, faces, places = [], [], {}
    for mesh in meshes:
        places[mesh.name] = (len(points), len(mesh), len(faces))
        faces += [[i + len(points) for i in face] for face in mesh.faces]
        points += mesh.points
    return points, faces, places


def numbers(values, what):
    """Values as float64; Error where one is no number or not finite."""
    try:
        array = np.asarray(values, float)
    except (TypeError, ValueError):
        raise Error(f"{what} are no numbers") from None
    if not np.isfinite(array).all():
        wrong = np.argwhere(~np.isfinite(array))[0]
        raise Error(f"{what} are not finite: {array[tuple(wrong)]} in row {wrong[0] if len(wrong) else 0}")
    return array
