"""A study's folder as an object: its table and its runs (proto/STUDY_FILE.md)."""
import functools
import json
import pathlib

from .errors import Error, nearest
from .run_folder import Run
from .tables import as_frame, read_table


def open_study(folder):
    """The study of that folder; Error where it holds no study.json."""
    return Study(folder)


class Study:
    """What `strake study` wrote: table, checks, and the runs by name."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        path = self.folder / "study.json"
        try:
            self.record = json.loads(path.read_text(encoding="utf-8"))
        except FileNotFoundError:
            raise Error("is no study: it has no study.json", "strake study writes it when its last run has ended", self.folder, 2) from None
        except (OSError, ValueError) as e:
            raise Error(f"cannot be read: {e}", "", path, 3) from None

    def __repr__(self):
        return f"<Study {self.folder}: {len(self.record.get('runs', []))} runs>"

    @functools.cached_property
    def table(self):
        """study.csv, one row per run: a DataFrame, or without pandas a dict of numpy arrays (`Table`)."""
        return as_frame(read_table(self.folder / "study.csv"))

    @property
    def checks(self):
        """Checks of the study as dicts: title, run, against, value, reference, deviation, tolerance, pass."""
        return self.record.get("checks", [])

    @property
    def runs(self):
        """Runs by name, as `Run`; those that were not done are left out."""
        found = {}
        for run in self.record.get("runs", []):
            folder = self.folder / run.get("folder", "")
            if (folder / "run.json").exists():
                found[run["name"]] = Run(folder)
        return found

    def run(self, name):
        """One run by its name; Error with the nearest name where there is none."""
        runs = self.runs
        if name not in runs:
            raise Error(f'has no run "{name}"; {nearest(name, runs)}', where=self.folder, exit_code=2)
        return runs[name]
