"""Column files (proto/RESULTS.md, "Column files"), as a pandas DataFrame or a dict of numpy arrays."""
import re

import numpy as np

from .errors import Error, nearest


class Table(dict):
    """Name of a column -> numpy array. `units`: name -> unit, "1" for a pure number. A wrong name is answered with the nearest."""

    def __init__(self, values, units, where=""):
        super().__init__(values)
        self.units, self.where = units, where

    def __missing__(self, name):
        raise Error(f'no column is named "{name}"; {nearest(str(name), self)}', where=self.where, exit_code=2)


def read_table(path):
    """A column file as a Table. An empty cell is nan; a last line that was cut off does not count.

    A column with texts becomes an array of str. Error where the file is not there or a line does not fit its header.
    """
    try:
        text = path.read_bytes().decode("utf-8")
    except (OSError, UnicodeDecodeError) as e:
        raise Error(f"cannot be read: {getattr(e, 'strerror', e)}", where=path, exit_code=3) from None
    lines = [(number, line.strip()) for number, line in enumerate(text[:text.rfind("\n") + 1].split("\n"), 1)]
    lines = [(number, line) for number, line in lines if line and not line.startswith("#")]
    if not lines:
        raise Error("holds no columns", "the first line of a column file is like: time [s],force.y [N]", path, 3)
    names, units = [], {}
    for cell in lines[0][1].split(","):
        found = re.fullmatch(r"\s*(.*?)\s*(?:\[([^\]]*)\])?\s*", cell)
        names.append(found[1])
        units[found[1]] = found[2] or "1"
    rows = []
    for number, line in lines[1:]:
        rows.append(line.split(","))
        if len(rows[-1]) != len(names):
            raise Error(f"{len(rows[-1])} values in a table of {len(names)} columns",
                        "each row holds one value for each name of the first line", f"{path}:{number}", 3)
    return Table({name: array_of([row[k] for row in rows]) for k, name in enumerate(names)}, units, str(path))


def array_of(cells):
    try:
        return np.array([float(cell) if cell.strip() else np.nan for cell in cells])
    except ValueError:
        return np.array(cells)


def as_frame(table):
    """A Table as a DataFrame whose `attrs["units"]` are the units; the Table itself where pandas is not installed."""
    try:
        import pandas
    except ImportError:
        return table
    frame = pandas.DataFrame(dict(table))
    frame.attrs["units"] = dict(table.units)
    return frame
