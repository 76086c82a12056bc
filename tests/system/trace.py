"""trace.json and --profile of real runs: every computation is there, on one clock, and a kill leaves a readable file."""
import csv
import json
import re

from processes import *  # noqa: F403: the test's own vocabulary

CASE = ROOT / "cases" / "plate_entry.toml"
WORDS = ["run", CASE, "--set", "structure.solver=rigid", "--set", "fluid.scheme.time_step=1e-5"]


class Trace:
    def __init__(self, path):
        self.events = json.loads(path.read_text())
        named = [e for e in self.events if e["name"] == "process_name"]
        self.process = {e["args"]["name"]: e["pid"] for e in named}
        self.thread = {(e["pid"], e["args"]["name"]): e["tid"] for e in self.events if e["name"] == "thread_name"}

    def slices(self, process, name, row=None):
        pid = self.process[process]
        return [e for e in self.events if e["ph"] == "X" and e["pid"] == pid and e["name"].startswith(name)
                and (row is None or e["tid"] == self.thread[pid, row])]


def whole_run(place):
    result = strake(*WORDS, "--set", "end_time=5e-4", "--profile", cwd=place)
    expect(result.returncode == 0, f"run: exit {result.returncode} {result.stderr}")
    run = place / "runs" / "plate_entry"
    trace = Trace(run / "trace.json")
    with open(run / "iterations.csv", newline="") as file:
        iterations = [(int(float(row["window [1]"])), int(float(row["iteration [1]"]))) for row in csv.DictReader(file)]
    for side in ("fluid", "structure"):
        computed = trace.slices(side, "Advance", "solver")
        expect([(e["args"]["window"], e["args"]["iteration"]) for e in computed] == iterations,
               f"{side}: one slice for each of {len(iterations)} iterations, in order")
        awaited = trace.slices("coupler", "Advance", f"awaits {side}")
        inside = all(a["ts"] <= c["ts"] and c["ts"] + c["dur"] <= a["ts"] + a["dur"] + 0.002 for a, c in zip(awaited, computed))
        expect(len(awaited) == len(computed) and inside, f"{side}: computes while it is awaited, on one clock")
        shorter = sum(c["dur"] < a["dur"] for a, c in zip(awaited, computed))
        expect(shorter > 0.9 * len(computed), f"{side}: tells its own times")
        row = sorted((e["ts"], e["ts"] + e["dur"]) for e in computed + trace.slices(side, "waits"))
        gaps = [b[0] - a[1] for a, b in zip(row, row[1:])]
        expect(max(map(abs, gaps)) < 0.01, f"{side}: computes or waits, without a gap")
    windows = trace.slices("coupler", "window ")
    expect(len(windows) == 50 and len(trace.slices("coupler", "files")) == 50, "a slice per window, and one for its files")

    shares = dict(re.findall(r"^ +(\w+) +[\d.]+ s +([\d.]+) %", result.stdout, re.M))
    expect(set(shares) == {"fluid", "structure", "messages", "coupler", "files"}, f"--profile names the shares: {sorted(shares)}")
    expect(abs(sum(map(float, shares.values())) - 100) < 0.3, "the shares add up")
    expect(re.search(r"^ +pressure +[\d.]+ s$", result.stdout, re.M), "--profile names the stages of the fluid")


def without(place):
    result = strake(*WORDS, "--set", "end_time=2e-5", "--no-trace", "--tag", "none", cwd=place)
    expect(result.returncode == 0 and not (place / "runs" / "plate_entry-none" / "trace.json").exists(), "--no-trace writes none")
    expect("profile" not in result.stdout, "no profile unless it is asked for")


def killed_and_continued(place):
    run = place / "runs" / "plate_entry-cut"
    words = [*WORDS, "--set", "end_time=5e-4", "--tag", "cut", "--set", "run.checkpoint=0.01"]
    process = start(*words, cwd=place)
    expect(wait_until(lambda: rows(run) >= 20, 60), "kill: the run is under way")
    process.kill()
    process.communicate(timeout=30)
    seen = len(Trace(run / "trace.json").slices("coupler", "window "))
    expect(seen > 0, f"kill -9 leaves a trace that can be read, with {seen} windows")
    resumed = strake(*words, "--resume", cwd=place)
    expect(resumed.returncode == 0, f"resume: exit {resumed.returncode} {resumed.stderr}")
    kept = len(Trace(run / "trace-1.json").slices("coupler", "window "))
    rest = len(Trace(run / "trace.json").slices("coupler", "window "))
    expect(kept == seen and 0 < rest < 50, f"resume keeps the trace before it ({kept} windows) and writes its own ({rest})")


with folder() as place:
    place = pathlib.Path(place)
    whole_run(place)
    without(place)
    killed_and_continued(place)
finish()
