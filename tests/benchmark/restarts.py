"""Runs that are interrupted at random windows and resumed, against the same run uninterrupted, bit by bit.

The plate meets the water inside its 200 windows, coupled with fem and with particle. It is interrupted by Ctrl-C, SIGTERM
and kill -9 of each of the three processes, with a checkpoint every window, every 7 and every 31, and some runs more than
once. Compared: history.csv, iterations.csv, interface/, frames/, the .xdmf files, and summary.json without its seconds and
bytes. Prints a table and exits 1 when anything differs.

    tests/benchmark/restarts.py [BIN_DIR] [--trials 50] [--windows 200] [--solver fem|particle] [--seed 1]
"""
import json
import os
import pathlib
import random
import signal
import subprocess
import tempfile
import time

import runs

CASE = runs.ROOT / "cases" / "plate_entry.toml"
WINDOW = 4e-5  # s
# 300 particles and a soft plate, so that a run takes seconds. At 6.26 m/s over 24 mm it touches the water after 96
# windows.
COARSE = ["fluid.spacing=0.02", "fluid.tank=[[-0.3,-0.2,0],[0.3,0.3,0]]", "fluid.water=[[-0.3,-0.2,0],[0.3,0,0]]",
          f"coupling.surface.window={WINDOW}", "structure.plate.bottom=[0,0.024,0]", "structure.plate.length=0.2",
          "structure.material.young=5e9", "output.probe[0].at=[0,0.024,0]", "output.probe[1].at=[0,0.024,0]",
          "output.probe[1].diameter=0.04", f"output.every={10 * WINDOW}", "run.threads=1"]
STRIKES = {"Ctrl-C": ("strake", signal.SIGINT), "SIGTERM": ("strake", signal.SIGTERM), "kill -9 strake": ("strake", signal.SIGKILL),
           "kill -9 fluid": ("fluid", signal.SIGKILL), "kill -9 structure": ("structure", signal.SIGKILL)}
SAVED = ("Ctrl-C", "SIGTERM")  # these leave a checkpoint of their own


def children(pid):
    """fluid, structure → pid."""
    found = {}
    for entry in pathlib.Path("/proc").iterdir():
        try:
            if entry.name.isdigit() and int((entry / "stat").read_text().rsplit(")", 1)[1].split()[1]) == pid:
                program = pathlib.Path((entry / "cmdline").read_bytes().split(b"\0")[0].decode()).name
                found["fluid" if program.startswith("strake-fluid") else "structure"] = int(entry.name)
        except (OSError, IndexError):
            continue
    return found


def rows(folder):
    try:
        return max(0, (folder / "history.csv").read_bytes().count(b"\n") - 1)
    except OSError:
        return 0


def contents(folder):
    """What must be equal: name → bytes."""
    found = {name: (folder / name).read_bytes() for name in ("history.csv", "iterations.csv", "fluid.xdmf", "structure.xdmf")}
    for part in ("interface", "frames"):
        found |= {f"{part}/{file.name}": file.read_bytes() for file in (folder / part).iterdir()}
    summary = json.loads((folder / "summary.json").read_text())
    for key in ("seconds", "ranks", "peak_memory_bytes", "tag"):
        del summary[key]
    found["summary.json"] = json.dumps(summary, indent=1).encode()
    return found


def differences(one, other):
    return sorted(name for name in one.keys() | other.keys() if one.get(name) != other.get(name))


class Runner:
    def __init__(self, options, place, solver):
        self.program = options.bin_dir.resolve() / "strake"
        self.place, self.keep, self.n_windows = place, options.keep, options.windows
        self.sets = [*COARSE, f"structure.solver={solver}", f"end_time={options.windows * WINDOW!r}", *options.set]
        self.environment = {**runs.ENVIRONMENT, "NO_COLOR": "1", **os.environ}

    def folder(self, tag):
        return self.place / "runs" / f"plate_entry-{tag}"

    def start(self, tag, every=None, resume=False):
        words = [str(self.program), "run", str(CASE), "--quiet", "--tag", tag]
        for pair in self.sets + ([f"run.checkpoint_windows={every}"] if every else []):
            words += ["--set", pair]
        return subprocess.Popen(words + ["--resume"] * resume, cwd=self.place, env=self.environment,
                                stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)

    def strike(self, process, tag, how, window, delay):
        """Waits for that window and strikes; returns the window it met, and what was said."""
        while rows(self.folder(tag)) < window and process.poll() is None:
            time.sleep(0.002)
        time.sleep(delay)
        who, number = STRIKES[how]
        pids = children(process.pid)
        met = rows(self.folder(tag))
        try:
            os.kill(process.pid if who == "strake" else pids[who], number)
        except (ProcessLookupError, KeyError):
            pass  # it ended by itself meanwhile
        said = process.communicate(timeout=60)[1]
        for pid in pids.values():  # a killed coupler's participants end by themselves, a little later
            while pathlib.Path(f"/proc/{pid}").exists():
                time.sleep(0.002)
        return met, said


def trial(runner, reference, seconds_per_window, number, chance):
    tag = f"trial{number}"
    every = chance.choice([1, 7, 31])
    strikes, row = [], {"every": every}
    process, first = runner.start(tag, every), 0
    for _ in range(chance.choice([1, 1, 1, 2])):
        how = chance.choice(list(STRIKES))
        earliest = max(first + 1, 0 if how in SAVED else every)
        if earliest >= runner.n_windows:
            break
        window = chance.randrange(earliest, runner.n_windows)
        met, said = runner.strike(process, tag, how, window, chance.uniform(0, 2 * seconds_per_window))
        code, first = process.returncode, met
        strikes.append(f"{how} at {met}" + (f" (exit {code})" if code >= 0 else ""))
        if code == 0:
            break  # the run was over before it was struck
        process = runner.start(tag, every, resume=True)
    said = process.communicate(timeout=600)[1]
    row["strikes"], row["code"] = ", ".join(strikes), process.returncode
    if process.returncode == 0:
        row["differ"] = differences(reference, contents(runner.folder(tag)))
    else:
        row["differ"] = ["resume: " + said.strip().replace("\n", " | ")]
    return row


def main():
    parser = runs.command(__doc__, keeps=True)
    parser.add_argument("--trials", type=int, default=50, help="of each solver")
    parser.add_argument("--windows", type=int, default=200)
    parser.add_argument("--solver", choices=["fem", "particle", "rigid"], action="append", help="default: fem and particle")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    failed = 0
    for solver in options.solver or ["fem", "particle"]:
        chance = random.Random(f"{options.seed} {solver}")
        with tempfile.TemporaryDirectory(prefix="strake-restarts-") as place:
            runner = Runner(options, pathlib.Path(place), solver)
            began = time.monotonic()
            process = runner.start("whole")
            said = process.communicate(timeout=600)[1]
            if process.returncode != 0:
                raise SystemExit(f"the uninterrupted run ended with {process.returncode}\n{said}")
            seconds = time.monotonic() - began
            reference = contents(runner.folder("whole"))
            iterations = json.loads((runner.folder("whole") / "summary.json").read_text())["iterations"]
            print(f"{solver}: {rows(runner.folder('whole'))} windows in {seconds:.1f} s, {iterations['mean']:.2f} iterations per "
                  f"window, {len(reference)} files compared", flush=True)
            if rows(runner.folder("whole")) != runner.n_windows:
                raise SystemExit("the uninterrupted run does not have the windows asked for")
            for number in range(options.trials):
                row = trial(runner, reference, seconds / options.windows, number, chance)
                failed += bool(row["differ"])
                verdict = "equal" if not row["differ"] else "DIFFERS: " + ", ".join(row["differ"][:6])
                print(f"  {number + 1:3}  checkpoint every {row['every']:2}  {row['strikes']:60}  {verdict}", flush=True)
                if row["differ"] and options.keep:
                    options.keep.mkdir(parents=True, exist_ok=True)
                    for tag in ("whole", f"trial{number}"):
                        subprocess.run(["cp", "-r", runner.folder(tag), options.keep], check=False)
                subprocess.run(["rm", "-r", runner.folder(f"trial{number}")], check=False)
    print(f"{failed} differ")
    raise SystemExit(bool(failed))


if __name__ == "__main__":
    main()
