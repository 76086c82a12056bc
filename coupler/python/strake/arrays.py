"""Arrays of the wire: frames of little-endian numbers behind a header, and the checks of both directions."""
import numpy as np

from .errors import Error
from .messages import pb
from .quantities import Quantity

LARGEST = 256 << 20  # bytes of one frame (proto/WIRE.md)


def wrong_message(problem):
    return Error(problem, "coupler and solver must be of one version of Strake", exit_code=5)


def take(frames, kind, rows, columns, what):
    """The next frame as rows × columns numbers; Error where it is not there or has another size."""
    frame = next(frames, None)
    if frame is None:
        raise wrong_message(f"the coupler sent no frame for {what}")
    expected = rows * columns * np.dtype(kind).itemsize
    if len(frame) != expected:
        raise wrong_message(f"the coupler sent {len(frame)} bytes for {what}, expected {expected}")
    return np.frombuffer(frame, kind).reshape(rows, columns)


def take_fields(headers, frames):
    """Fields of a message by quantity: arrays points × components, float64."""
    return {field.quantity: take(frames, "<f8", field.n_points, field.components, f"the field {field.quantity}")
            for field in headers}


def take_mesh(mesh, frames):
    """Position n × 3 [m] and faces m × dimension of a partner's mesh; the faces are None where it has none."""
    position = take(frames, "<f8", mesh.n_points, 3, "the partner's points")
    faces = take(frames, "<i4", mesh.n_faces, mesh.dimension, "the partner's faces") if mesh.n_faces else None
    if mesh.has_mass:
        take(frames, "<f8", mesh.n_points, 1, "the partner's masses")
    return position, faces


def nothing_left(frames):
    if next(frames, None) is not None:
        raise wrong_message("the coupler sent more frames than its header announces")


def spread(values, n, components, what):
    """Values as n × components float64: one row for all points, or one for each. Two components get z = 0.

    A number alone is a row of one component; of a vector only 0 says all of its components. Error where the values do not
    fit, or are not finite.
    """
    try:
        if values is None or isinstance(values, (str, bytes)):  # numpy takes them for nan, and for numbers
            raise TypeError
        array = np.asarray(values, "<f8")
    except (TypeError, ValueError):
        raise Error(f"{what} is {type(values).__name__}, expected numbers") from None
    if components == 1 and array.shape == (n,):
        array = array[:, None]
    if components == 3 and array.ndim and array.shape[-1] == 2:
        array = np.concatenate([array, np.zeros((*array.shape[:-1], 1))], -1)
    try:
        one_for_all = components > 1 and (array.ndim == 0 or array.shape[-1] == 1)  # along which axis, nobody said
        if one_for_all and np.isfinite(array).all() and array.any():
            raise ValueError
        array = np.ascontiguousarray(np.broadcast_to(array, (n, components)), "<f8")
    except ValueError:
        raise Error(f"{what} has the shape {np.shape(values)}, expected {(n, components)}",
                    "give a row for each point, or one row for all") from None
    if not np.isfinite(array).all():
        row, column = np.argwhere(~np.isfinite(array))[0]
        raise Error(f"{what} is {array[row, column]} at point {row}", "the solver gives a value that is not finite")
    if array.nbytes > LARGEST:
        raise Error(f"{what} has {array.nbytes} bytes, at most {LARGEST} go into one message")
    return array


def field_header(quantity: Quantity, n):
    return pb.Field(quantity=quantity.name, unit=quantity.unit, components=quantity.components,
                    conservative=quantity.conservative, n_points=n)


class Mesh:
    """The interface of one participant: points n × 3 [m] and faces m × dimension, indices of points.

    Without faces the points are those of the solid itself (`coupling.interface = "volume"`), with mass [kg] where given.
    A normal points into the fluid: proto/WIRE.md, "Quantities and units". Error where faces or points do not fit.
    """

    def __init__(self, name, dimension, points, faces=None, mass=None):
        try:
            n = len(points)
        except TypeError:
            raise Error("the points of the interface are not given", "set self.points in build(): a row for each point") from None
        self.name, self.dimension, self.n = name, dimension, n
        self.points = spread(points, n, 3, "self.points") if n else np.zeros((0, 3))
        self.faces = self.checked(faces)
        self.mass = None if mass is None else spread(mass, n, 1, "the mass of the points")

    def checked(self, faces):
        if faces is None or len(faces) == 0:
            return None
        array = np.asarray(faces)
        shape = f"{len(array)} faces of {self.dimension} points"
        if array.ndim != 2 or array.shape[1] != self.dimension or array.dtype.kind not in "iu":
            raise Error(f"the faces have the shape {array.shape} of {array.dtype}, expected {shape}, whole numbers")
        if array.min() < 0 or array.max() >= self.n:
            wrong = array.max() if array.max() >= self.n else array.min()
            raise Error(f"a face names point {wrong}, the points are 0 to {self.n - 1}")
        return np.ascontiguousarray(array, "<i4")

    def header(self):
        return pb.Mesh(name=self.name, dimension=self.dimension, n_points=self.n,
                       n_faces=0 if self.faces is None else len(self.faces), has_mass=self.mass is not None)

    def frames(self):
        return [a for a in (self.points, self.faces, self.mass) if a is not None]
