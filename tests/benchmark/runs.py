"""Functions that the scripts of this folder share: commands, runs of `strake` in a temporary folder, tables, sums over series."""
import argparse
import concurrent.futures
import csv
import json
import math
import os
import pathlib
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
# Threads that wait must sleep: two runs at a time would otherwise take the processor from one another.
ENVIRONMENT = {"OMP_WAIT_POLICY": "passive", "OPENBLAS_NUM_THREADS": "1", "GOMP_SPINCOUNT": "2000"}


def command(description, keeps=False):
    """The parser of a script that runs cases: BIN_DIR, --set, and --keep where there is something to keep."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bin_dir", nargs="?", type=pathlib.Path, default=ROOT / "build" / "bin", help="default: build/bin")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="for every run")
    if keeps:
        parser.add_argument("--keep", type=pathlib.Path, metavar="DIR", help="where tables (CSV) and pictures (SVG) go")
    return parser


class Run:
    """What a run left: `summary`, and the columns of its history by name, without the unit."""

    def __init__(self, folder):
        self.summary = json.loads((folder / "summary.json").read_text())
        with (folder / "history.csv").open() as file:
            lines = csv.reader(line for line in file if not line.startswith("#"))
            names = [name.split(" [")[0] for name in next(lines)]
            cells = list(zip(*lines))
        self._columns = {name: [float(c) if c else math.nan for c in column] for name, column in zip(names, cells)}

    def __getitem__(self, name):
        return self._columns[name]

    def probe(self, name, metric):
        """A number of summary.json; nan where it is not known."""
        value = self.summary["probes"][name][metric]
        return math.nan if value is None else value


def run(bin_dir, case, sets=(), environment=None):
    """Runs a case, a path or the text of one, and returns its Run; the environment is this program's own by default."""
    with tempfile.TemporaryDirectory() as place:
        path = case if isinstance(case, pathlib.Path) else pathlib.Path(place) / "benchmark.toml"
        if path is not case:
            path.write_text(case)
        program = bin_dir.resolve() / "strake"
        if not program.is_file():
            raise SystemExit(f"{bin_dir}: expected the folder of the program strake\n  fix: build it (tests/run.sh), or name its folder as BIN_DIR")
        words = [str(program), "run", str(path), "--quiet"]
        for pair in sets:
            words += ["--set", pair]
        done = subprocess.run(words, cwd=place, stdout=subprocess.DEVNULL, env={**ENVIRONMENT, **(environment or os.environ)})
        if done.returncode != 0:
            raise SystemExit(f"{' '.join(words[1:])}: ended with exit code {done.returncode}, its own message is above")
        return Run(pathlib.Path(place) / "runs" / path.stem)


def run_all(bin_dir, jobs, at_once):
    """Runs (case, sets) pairs, so many at a time; yields their results in the order of the jobs."""
    with concurrent.futures.ThreadPoolExecutor(at_once) as pool:
        yield from pool.map(lambda job: run(bin_dir, *job), jobs)


def fit_slope(times, values):
    """Slope of the least-squares line."""
    mt, mv = sum(times) / len(times), sum(values) / len(values)
    return sum((t - mt) * (v - mv) for t, v in zip(times, values)) / sum((t - mt) ** 2 for t in times)


def slope_error(times, values):
    """Standard error of that slope, if the deviations from the line are random from sample to sample."""
    slope, mt, mv = fit_slope(times, values), sum(times) / len(times), sum(values) / len(values)
    left = sum((v - mv - slope * (t - mt)) ** 2 for t, v in zip(times, values)) / (len(times) - 2)
    return math.sqrt(left / sum((t - mt) ** 2 for t in times))


def off(value, reference):
    """Relative deviation in per cent, for a table."""
    return f"{100 * (value / reference - 1):+.1f} %" if math.isfinite(value) else "unknown"


class Table:
    """Rows of text under a line of names, printed as they come; `keep` writes them as CSV too."""

    def __init__(self, columns):
        self._names, self._widths = [c[0] for c in columns], [max(c[1], len(c[0])) for c in columns]
        self._rows = []
        self._show(self._names)

    def row(self, *cells):
        self._rows.append([str(c) for c in cells])
        self._show(self._rows[-1])

    def keep(self, folder, name):
        if folder is None:
            return
        folder.mkdir(parents=True, exist_ok=True)
        with (folder / name).open("w", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows([self._names, *self._rows])

    def _show(self, cells):
        print("  ".join(c.ljust(w) for c, w in zip(cells, self._widths)).rstrip(), flush=True)
