"""Finite elements on 1, 2 and 3 ranks: a block, a bar that parts, a plate of solid shells; conjugate gradients and factors.
Iterations, displacement, damage, frames, checkpoints, refusals, bytes of a second run.
fem_ranks.py PROGRAM"""
import array
import filecmp
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile

PROGRAM = sys.argv[1]
ENV = dict(os.environ, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1", OMPI_MCA_rmaps_base_oversubscribe="1",
           OMPI_MCA_hwloc_base_binding_policy="none", OMPI_MCA_mpi_yield_when_idle="1",
           OMPI_MCA_btl_vader_single_copy_mechanism="none", OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
failures = []


def expect(condition, what):
    print(("ok    " if condition else "FAIL  ") + what, flush=True)
    failures.extend([] if condition else [what])


def run(ranks, refinement, folder, *more):
    pathlib.Path(folder).mkdir(exist_ok=True)
    subprocess.run(["mpirun", "-n", str(ranks), PROGRAM, str(refinement), str(folder), *more], env=ENV, check=True,
                   timeout=250)
    return json.loads(pathlib.Path(folder, f"{ranks}.json").read_text())


def values(path):
    return array.array("d", path.read_bytes())


def difference(a, b):
    """‖a − b‖/‖a‖."""
    if len(a) != len(b) or len(a) == 0:
        return math.inf
    return math.dist(a, b) / math.hypot(*a)


with tempfile.TemporaryDirectory(prefix="strake-test-") as scratch:
    scratch = pathlib.Path(scratch)
    one = run(1, 1, scratch, "all")
    names = sorted(path.name[2:] for path in scratch.glob("1.*") if path.suffix != ".json")
    expect({"static", "steps", "surface", "archive", "frame_stress", "frame_cells", "failing_frame_damage",
            "failing_onset", "shells_static"} <= set(names), " ".join(names))
    expect(one["failing.failure.cells"] == 4 and "failing.failure.parted.x" in one, "the notched bar parts")
    expect("joints" in one["shells.line"], one["shells.line"])
    expect("holds as much elastic energy" in one["wide"] and "cell 0 at" in one["no_shell"], one["no_shell"])
    for ranks in (2, 3):
        other = run(ranks, 1, scratch, "all")
        for name in names:
            off = difference(values(scratch / f"1.{name}"), values(scratch / f"{ranks}.{name}"))
            expect(off <= 1e-9, f"{ranks} ranks, {name}: {off:.1e} from one rank")
        for name, value in one.items():
            if name.startswith(("seconds", "bytes", "ranks", "iterations")):
                continue
            if isinstance(value, str):
                expect(other[name] == value, f"{ranks} ranks, {name}: {other[name]}")
                continue
            off = abs(other[name] - value) / (abs(value) or 1)
            expect(off <= 1e-9, f"{ranks} ranks, {name}: {off:.1e} from one rank")
        expect(other["failing.resumed_off"] == 0, f"{ranks} ranks: the bar is resumed with the same bytes")
    run(2, 1, scratch / "again", "all")
    same = all(filecmp.cmp(scratch / f"2.{name}", scratch / f"again/2.{name}", shallow=False) for name in names)
    expect(same, "2 ranks again: the same bytes")

    systems = [run(ranks, 2, scratch / "finer") for ranks in (1, 2, 3)]
    count = [system["iterations"] for system in systems]
    expect(all(abs(n / count[0] - 1) <= 0.1 for n in count), f"{systems[0]['unknowns']} unknowns: {count} iterations")
    for ranks in (2, 3):
        off = difference(values(scratch / "finer/1.solution"), values(scratch / f"finer/{ranks}.solution"))
        expect(off <= 1e-9, f"{ranks} ranks: the solution is {off:.1e} from that of one")
print(f"{len(failures)} failed")
sys.exit(bool(failures))
