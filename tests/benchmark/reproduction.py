"""Results of twenty-four short runs, recorded, and compared to the byte with those of another build.

They take every solver, both presets, both couplings, two and three dimensions, one and two threads, a replay and a resumed
run. Kept of each: history.csv, iterations.csv, and summary.json without wall clock, memory and versions.

    tests/benchmark/reproduction.py record DIR [BIN_DIR] [--only NAME]…    runs them and keeps what they gave
    tests/benchmark/reproduction.py compare DIR_A DIR_B                     exits 1 where a byte differs, and says where
"""
import argparse
import concurrent.futures
import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import time

import runs

MEETS_WATER = ["end_time=2.5e-3"]  # of plate_entry, which meets it at 1.9 ms
VOLUME = ["structure.solver=particle", "coupling.interface=volume"]
# name: (case, what is set)
RUNS = {
    "plate fem": ("plate_entry", MEETS_WATER),
    "plate particle": ("plate_entry", [*MEETS_WATER, "structure.solver=particle"]),
    "plate rigid": ("plate_entry", [*MEETS_WATER, "structure.solver=rigid"]),
    "plate rigid, two threads": ("plate_entry", [*MEETS_WATER, "structure.solver=rigid", "run.threads=2"]),
    "plate ccx": ("plate_entry", ["structure.solver=ccx", "structure.fem.refinement=1", "end_time=1.95e-3"]),
    "plate volume": ("plate_entry", [*VOLUME, "end_time=2.2e-3"]),
    "plate paper": ("plate_entry", ["preset=paper", "structure.solver=rigid", "end_time=2.2e-3"]),
    "plate paper volume": ("plate_entry", ["preset=paper", *VOLUME, "end_time=2.2e-3"]),
    "plate incompressible": ("plate_entry", ["structure.solver=rigid", "fluid.sound_speed=inf", "fluid.scheme.time_step=5e-5",
                                             "coupling.surface.window=5e-5", "end_time=5e-3"]),
    "plate aitken": ("plate_entry", [*MEETS_WATER, "structure.solver=particle", "coupling.surface.accelerator.kind=aitken"]),
    "plate parallel": ("plate_entry", [*MEETS_WATER, "coupling.surface.scheme=parallel"]),
    "plate radial-basis": ("plate_entry", [*MEETS_WATER, "coupling.surface.mapping.kind=radial-basis"]),
    "plate failure": ("plate_failure", ["end_time=1.8e-3"]),
    "box": ("box_entry", ["end_time=1e-3"]),
    "hydrostatic plate": ("hydrostatic_plate", ["end_time=0.05"]),
    "gate": ("elastic_gate", ["end_time=0.01"]),
    "wedge": ("wedge_entry", ["end_time=6e-3"]),
    "wedge drop": ("wedge_drop", ["end_time=6e-3"]),
    "dam break": ("dam_break", ["end_time=0.15"]),
    "rolling tank": ("rolling_tank", ["end_time=0.2"]),
    "cantilever": ("cantilever", []),
    "flag": ("flag_gravity", []),
    "clamped panel": ("clamped_panel", []),
    "stiffened panel": ("stiffened_panel", ["structure.analysis=modal"]),
    "sphere 3-D": ("sphere_entry_3d", ["end_time=2e-3"]),
    "dam break 3-D": ("dam_break_3d", ["end_time=0.05"]),
}
KEPT = ("history.csv", "iterations.csv")
NOT_COMPARED = ("seconds", "ranks", "peak_memory_bytes", "strake", "commit")


def strake(bin_dir, place, *words):
    done = subprocess.run([str(bin_dir / "strake"), *map(str, words)], cwd=place, capture_output=True, text=True,
                          env={**runs.ENVIRONMENT, **os.environ})
    if done.returncode != 0:
        raise SystemExit(f"strake {' '.join(map(str, words))}: exit code {done.returncode}\n{done.stderr}")


def keep(run, folder):
    folder.mkdir(parents=True, exist_ok=True)
    for name in KEPT:
        if (run / name).exists():
            shutil.copyfile(run / name, folder / name)
    summary = json.loads((run / "summary.json").read_text())
    for key in NOT_COMPARED:
        summary.pop(key, None)
    (folder / "summary.json").write_text(json.dumps(summary, indent=1) + "\n")


def record(name, bin_dir, into):
    case, sets = RUNS[name]
    begin = time.monotonic()
    with tempfile.TemporaryDirectory() as place:
        words = ["run", runs.ROOT / "cases" / f"{case}.toml", "--quiet", "--no-trace"]
        options = [word for pair in sets for word in ("--set", pair)]
        strake(bin_dir, place, *words, *options)
        run = pathlib.Path(place) / "runs" / case
        keep(run, into / name)
        if name == "plate rigid":  # what builds on a run: the same cut in two, and its load on another structure
            cut = ["--set", "run.checkpoint_windows=50", "--tag", "cut"]
            strake(bin_dir, place, *words, *options, *cut, "--set", "end_time=2.2e-3")
            strake(bin_dir, place, *words, *options, *cut, "--resume")
            keep(run.parent / f"{case}-cut", into / "plate resumed")
            strake(bin_dir, place, "replay", run, "--onto", words[1], "--quiet", "--tag", "replay", "--set", MEETS_WATER[0])
            keep(run.parent / f"{case}-replay", into / "plate replayed")
    return f"{name:28s} {time.monotonic() - begin:6.1f} s"


def differences(a, b):
    names = sorted({path.relative_to(folder) for folder in (a, b) for path in folder.rglob("*") if path.is_file()})
    for name in names:
        if not (a / name).exists() or not (b / name).exists():
            yield f"{name}: only in {a if (a / name).exists() else b}"
        elif (a / name).read_bytes() != (b / name).read_bytes():
            one, other = (a / name).read_text().splitlines(), (b / name).read_text().splitlines()
            line = next((i for i, (x, y) in enumerate(zip(one, other), 1) if x != y), min(len(one), len(other)) + 1)
            yield f"{name}: differs from line {line} on"
    if not names:
        yield "nothing is recorded in either folder"


parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
ways = parser.add_subparsers(dest="way", required=True)
recording = ways.add_parser("record")
recording.add_argument("folder", type=pathlib.Path)
recording.add_argument("bin_dir", nargs="?", type=pathlib.Path, default=runs.ROOT / "build" / "bin")
recording.add_argument("--only", action="append", choices=RUNS, metavar="NAME")
recording.add_argument("--jobs", type=int, default=2)
comparing = ways.add_parser("compare")
comparing.add_argument("a", type=pathlib.Path)
comparing.add_argument("b", type=pathlib.Path)
options = parser.parse_args()
if options.way == "record":
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for line in pool.map(lambda name: record(name, options.bin_dir.resolve(), options.folder), options.only or RUNS):
            print(line, flush=True)
else:
    found = list(differences(options.a, options.b))
    print("\n".join(found) or "the same to the byte")
    raise SystemExit(1 if found else 0)
