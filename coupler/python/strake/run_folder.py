"""A run folder as an object: what a run wrote, whole or not (proto/RESULTS.md)."""
import fcntl
import functools
import json
import os
import pathlib
import tomllib
from typing import NamedTuple, Optional

from .errors import Error, nearest
from .hdf5_files import Frames, as_dataset, read_interface
from .tables import as_frame, read_table


class Reference(NamedTuple):
    """One number that a case is compared with, and what the run came to.

    kind        theory, experiment, code or calibration; source: who gives the number
    value       the reference; measured: of this run, None where it was not reached; tolerance: relative, absolute where value = 0
    verdict     "pass", "outside" or "not reached"; "not judged" while the run has no summary
    """

    name: str
    probe: str
    metric: str
    kind: str
    source: str
    value: Optional[float]
    measured: Optional[float]
    tolerance: Optional[float]
    verdict: str

    @property
    def deviation(self):
        """(measured - value) / |value|; the difference where value = 0; None where one is not known."""
        if self.measured is None or self.value is None:
            return None
        return (self.measured - self.value) / (abs(self.value) or 1)


def open(folder):  # noqa: A001: strake.open reads like this
    """The run of that folder. Error where it is no run folder; a run that did not end is opened as far as it goes."""
    return Run(folder)


class Run:
    """What one run wrote. Tables and fields are read when they are first asked for, and then kept: `reload` forgets them."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        if not self.folder.is_dir():
            raise Error("is no folder", near_folder(self.folder), self.folder, 2)
        if not any((self.folder / name).exists() for name in ("run.json", "summary.json", "history.csv")):
            runs = sorted(path.parent.name for path in self.folder.glob("*/run.json"))
            fix = f"it holds runs: name one, such as {self.folder / runs[0]}" if runs else "name the folder that strake run printed"
            if (self.folder / "study.json").exists():
                fix = f'this is a study: strake.open_study("{self.folder}")'
            raise Error("is no run folder: it has no run.json", fix, self.folder, 2)

    def __repr__(self):
        return f"<Run {self.folder}: {self.state}>"

    def reload(self):
        """Forgets what was read, to read a run anew that goes on. Returns the run."""
        for name in [n for n in vars(self) if n != "folder"]:
            delattr(self, name)
        return self

    # ---- what it is

    @property
    def state(self):
        """"finished", "running", "stopped" (by a signal), "failed: …" with the error, or "killed": no end was recorded."""
        code = self.record.get("exit_code", self.summary.get("exit_code"))
        if code is None:
            return "running" if self.is_locked() else "killed"
        if code in (0, 1):
            return "finished"
        if code in (129, 130, 143):
            return "stopped"
        error = self.record.get("error") or {}
        return f"failed: {error.get('where', '')}: {error.get('problem', f'exit code {code}')}"

    @functools.cached_property
    def record(self):
        """run.json: how the case was run. A dict, empty where the file is missing."""
        return self.read_json("run.json")

    @functools.cached_property
    def summary(self):
        """summary.json: what the run found. A dict, empty where the run has not ended in order."""
        return self.read_json("summary.json")

    @functools.cached_property
    def case(self):
        """case.toml: the resolved case, every key with its value. A dict."""
        try:
            return tomllib.loads(self.need_file("case.toml").read_text(encoding="utf-8"))
        except tomllib.TOMLDecodeError as e:
            raise Error(f"is damaged: {e}", where=self.folder / "case.toml", exit_code=3) from None

    # ---- tables

    @functools.cached_property
    def history(self):
        """history.csv, one row per window: a DataFrame, or without pandas a dict of numpy arrays (`Table`)."""
        return as_frame(self.history_table)

    @functools.cached_property
    def iterations(self):
        """iterations.csv of a coupled run, one row per coupling iteration; as `history`."""
        return as_frame(read_table(self.need_file("iterations.csv")))

    @functools.cached_property
    def history_table(self):
        return read_table(self.need_file("history.csv"))

    @property
    def units(self):
        """Unit of each column of `history`, "1" for a pure number."""
        return self.history_table.units

    def column(self, name):
        """A column of `history` as a numpy array; Error with the nearest name where there is none of that name."""
        return self.history_table[name]

    # ---- fields

    @functools.cached_property
    def interface(self):
        """What was exchanged in each window, on the structure's mesh: an xarray Dataset, or a dict of numpy arrays.

        time [s] of each window's end, position and faces, and fields such as displacement, force: windows × points × 3.
        """
        blocks = sorted((self.folder / "interface").glob("*.h5"))
        if not blocks:
            raise Error("has no recorded interface", "only a coupled run has one, from its first window on", self.folder, 3)
        return as_dataset(read_interface(blocks))

    @functools.cached_property
    def frames(self):
        """Positions and fields by side: `frames["fluid"][-1]`, `frames["structure"].at(1e-3)` (`Frames`)."""
        sides = {}
        for path in sorted((self.folder / "frames").glob("*.h5")):
            sides.setdefault(path.stem.rpartition("-")[0], []).append(path)
        return Sides({side: Frames(paths) for side, paths in sides.items()}, self.folder)

    # ---- verdicts

    @property
    def references(self):
        """A `Reference` for each number that the case is compared with, in the order of the case."""
        if self.summary:
            return [judged(entry) for entry in self.summary.get("compare", [])]
        return self.awaited()

    @property
    def checks(self):
        """Checks of the run by name: dicts of value, grade ("good", "poor", "bad"; None without bounds), good, poor."""
        found = self.summary.get("checks", {})
        grades = found.get("grades", {})
        none = {"grade": None, "good": None, "poor": None}
        return {name: {"value": value, **none, **grades.get(name, {})} for name, value in found.items() if name != "grades"}

    @property
    def alarms(self):
        """Texts of the alarms: values that the case cannot have. Empty in a sound run."""
        return [alarm.get("text", "") for alarm in self.summary.get("alarms", [])]

    def plot(self, *columns, against="time", file=None, axes=None):
        """Draws columns of `history` with the case's references; needs matplotlib. See `plots.plot`."""
        from .plots import plot
        return plot(self, columns, against, file, axes)

    # ---- files

    def need_file(self, name):
        path = self.folder / name
        if not path.exists():
            raise Error(f"is not there: the run {self.state}" if name != "iterations.csv" else "is not there: one solver ran alone",
                        "", path, 3)
        return path

    def read_json(self, name):
        try:
            found = json.loads((self.folder / name).read_text(encoding="utf-8"))
        except FileNotFoundError:
            return {}
        except (OSError, ValueError) as e:
            raise Error(f"cannot be read: {e}", "", self.folder / name, 3) from None
        if not isinstance(found, dict):
            raise Error("is no record of a run", "", self.folder / name, 3)
        return found

    def is_locked(self):
        """Whether a process runs in this folder: the same test as of strake watch."""
        folder = os.open(self.folder, os.O_RDONLY | os.O_DIRECTORY)
        try:
            fcntl.flock(folder, fcntl.LOCK_SH | fcntl.LOCK_NB)
            return False
        except BlockingIOError:
            return True
        except OSError:
            return False  # some disks have no locks
        finally:
            os.close(folder)

    def awaited(self):
        """References of a run without a summary, as its own case file states them."""
        path = pathlib.Path(self.record.get("case", ""))
        try:
            blocks = tomllib.loads(path.read_text(encoding="utf-8")).get("compare", [])
        except (OSError, ValueError):
            return []
        return [Reference(f"{block['probe']} {metric}", block["probe"], metric, block.get("kind", "theory"), block.get("source", ""),
                          value, None, block.get("tolerance", {}).get(metric), "not judged")
                for block in blocks if isinstance(block.get("value"), dict) and not block.get("when")
                for metric, value in block["value"].items()]


class Sides(dict):
    """Frames by side; a side without frames is named in an Error."""

    def __init__(self, sides, folder):
        super().__init__(sides)
        self.folder = folder

    def __missing__(self, side):
        raise Error(f'has no frames of "{side}"; {nearest(str(side), self)}', where=self.folder, exit_code=2)


def judged(entry):
    verdict = {None: "not reached", True: "pass", False: "outside"}[entry.get("pass")]
    probe, metric = entry.get("probe", ""), entry.get("metric", "")
    return Reference(f"{probe} {metric}", probe, metric, entry.get("kind", ""), entry.get("source", ""), entry.get("reference"),
                     entry.get("value"), entry.get("tolerance"), verdict)


def near_folder(folder):
    beside = sorted(path.name for path in folder.parent.glob("*") if path.is_dir()) if folder.parent.is_dir() else []
    if not beside:
        return "a run folder is runs/<case>, below the folder in which strake run was called"
    return f"{folder.parent or '.'} holds " + ", ".join(beside[:10]) + (", …" if len(beside) > 10 else "")
