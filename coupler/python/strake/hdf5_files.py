"""Frames and archives of a run, which are HDF5 files (proto/RESULTS.md, "Frames and archives")."""
import re

import numpy as np

from .errors import Error, need, nearest

FRAME, ARCHIVE = "strake frame 1", "strake archive 1"


class Fields(dict):
    """Name -> numpy array; `units`: name -> unit, where it is known; `dimensions`: name -> names of the array's axes."""

    def __init__(self, where=""):
        super().__init__()
        self.units, self.dimensions, self.where = {}, {}, where

    def add(self, name, value, unit, *dimensions):
        self[name], self.dimensions[name] = value, dimensions
        if unit:
            self.units[name] = unit

    def __missing__(self, name):
        raise Error(f'there is no "{name}"; {nearest(str(name), self)}', where=self.where, exit_code=2)


def open_file(path, expected):
    """Opens an HDF5 file of Strake, to be used in a `with`. Error where it is none, or one of another version."""
    h5py = need("h5py", "python3-h5py")
    try:
        file = h5py.File(path, "r")
    except OSError as e:
        gone = not path.exists()
        raise Error("does not exist" if gone else f"is no HDF5 file that can be read ({str(e)[:100]})",
                    "" if gone else "it was damaged, or is being written", path, 3) from None
    found = file.attrs.get("format", b"")
    found = found.decode("utf-8", "replace") if isinstance(found, bytes) else str(found)
    if found != expected:
        file.close()
        raise Error(f'has the format "{found}", expected "{expected}"',
                    "read it with the package of the version that wrote it; the run's run.json names that version", path, 3)
    return file


def check_parts(file, path):
    """Error where a part of a frame of several ranks is missing: HDF5 would read NaN for its particles."""
    position = file["position"]
    if not position.is_virtual:
        return
    for source, size in zip(position.virtual_sources(), file["parts"][:, 0]):
        part = path.parent / source.file_name
        found = part.stat().st_size if part.is_file() else None
        if found != size:
            raise Error(f"its part {part} " + ("is missing" if found is None else f"has {found} bytes, not {size}"),
                        "a run on several ranks writes parts beside the file: copy them with it", path, 3)


def unit_of(dataset):
    unit = dataset.attrs.get("unit", "")
    return unit.decode("utf-8", "replace") if isinstance(unit, bytes) else str(unit)


def from_link_name(link):
    """A name as it is stored, with %25, %2F and %2E for '%', '/' and a leading '.'."""
    return re.sub("%(25|2F|2E)", lambda m: {"25": "%", "2F": "/", "2E": "."}[m[1]], link)


def read_frame(path):
    """One instant of a solver: position n × 3 [m], cells m × k point indices, and each field by name."""
    fields = Fields(str(path))
    with open_file(path, FRAME) as file:
        check_parts(file, path)
        fields.add("time", float(file.attrs["time"]), "s")
        fields.add("position", file["position"][()], "m", "point", "xyz")
        fields.add("cells", file["cells"][()], "", "cell", "corner")
        for group, place in (("point", "point"), ("cell", "cell")):
            for link, dataset in file.get(group, {}).items():
                name, value = from_link_name(link), dataset[()]
                name = name if name not in fields else f"{place}.{name}"
                fields.add(name, value[:, 0] if value.shape[1] == 1 else value, unit_of(dataset), place,
                           *() if value.shape[1] == 1 else ("xyz" if value.shape[1] == 3 else f"components of {name}",))
    return fields


def read_interface(blocks):
    """The recorded interface out of all its blocks: time of each window's end, mesh, and each field window by window.

    position n × 3 [m], faces m × dimension; displacement, velocity, force: windows × n × 3; other fields windows × n × k.
    """
    parts = [read_block(path) for path in blocks]
    fields = Fields(str(blocks[0].parent))
    mesh, units = parts[0]
    n = len(mesh["position"])
    time, dt = (np.concatenate([part[name] for part, _ in parts]) for name in ("time", "dt"))
    fields.add("time", time + dt, "s", "time")
    fields.add("dt", dt, "s", "time")
    fields.add("position", mesh["position"], "m", "point", "xyz")
    fields.add("faces", mesh["faces"], "", "face", "corner")
    for name in ("mass", "initial_displacement", "initial_velocity"):
        if name in mesh:
            fields.add(name, mesh[name], units.get(name, ""), "point", *() if name == "mass" else ("xyz",))
    for name in mesh:
        if name in fields or not all(name in part for part, _ in parts):
            continue
        value = np.concatenate([part[name] for part, _ in parts])
        value = value.reshape(len(time), n, value.shape[1] // n if n else 1)
        scalar = value.shape[2] == 1
        fields.add(name, value[:, :, 0] if scalar else value, units.get(name, ""), "time", "point",
                   *() if scalar else ("xyz" if value.shape[2] == 3 else f"components of {name}",))
    return fields


def read_block(path):
    """Reads one file of the record. Returns mesh, time [s], dt [s] and fields as windows × numbers; and the units."""
    with open_file(path, ARCHIVE) as file:
        real = {from_link_name(link): (dataset[()], unit_of(dataset)) for link, dataset in file["real"].items()}
        whole = {from_link_name(link): dataset[()].ravel() for link, dataset in file.get("integer", {}).items()}
    try:
        _, corners, m = whole["mesh"]
        part = {name: value.T for name, (value, _) in real.items()}
        part["faces"] = whole["faces"].reshape(m, corners) if m else np.zeros((0, max(int(corners), 2)), np.int64)
        part.update({name: part[name].ravel() for name in ("time", "dt", "mass") if name in part})
        if "position" not in part or "time" not in part or "dt" not in part:
            raise KeyError("position, time or dt is missing")
    except (KeyError, ValueError) as e:
        raise Error(f"is no interface record: {e}", where=path, exit_code=3) from None
    return part, {name: unit for name, (_, unit) in real.items()}


def as_dataset(fields):
    """Fields as an xarray Dataset, units as attribute `units` of each variable; the Fields themselves without xarray."""
    try:
        import xarray
    except ImportError:
        return fields
    variables = {name: (fields.dimensions[name], value, {"units": fields.units[name]} if name in fields.units else {})
                 for name, value in fields.items()}
    dataset = xarray.Dataset({name: v for name, v in variables.items() if name != "time"}, {"time": variables["time"]},
                             {"source": fields.where})
    return dataset.assign_coords(xyz=["x", "y", "z"]) if "xyz" in dataset.dims else dataset


class Frames:
    """The frames of one side of a run, in order of time; each is read when it is asked for.

    `frames[k]` or `frames.at(time)`: an xarray Dataset, or a dict of numpy arrays (`Fields`): time, position, cells, fields.
    `times`: array of all times [s].
    """

    def __init__(self, paths):
        self.paths, self.times = [], []
        for path in paths:
            try:
                with open_file(path, FRAME) as file:
                    self.times.append(float(file.attrs["time"]))
            except Error as e:
                if path != paths[-1] or e.exit_code != 3:
                    raise
                continue  # the last one of a run that was killed, or is under way
            self.paths.append(path)
        self.times = np.array(self.times)

    def __len__(self):
        return len(self.paths)

    def __getitem__(self, index):
        if isinstance(index, slice):
            return [self[k] for k in range(*index.indices(len(self)))]
        if not -len(self) <= index < len(self):
            raise IndexError(f"frame {index} of {len(self)}")
        return as_dataset(read_frame(self.paths[index]))

    def at(self, time):
        """The frame next to a time [s], the earlier of two as near; Error where there is none."""
        if not len(self):
            raise Error("there is no frame", "output.every of the case says when frames are written", exit_code=3)
        return self[int(np.argmin(np.abs(self.times - time)))]
