"""Water on 1, 2, 3, 4 and 8 processes: iterations, pressure and velocity of a step, ghosts, balance, bytes of a second run.
fluid_ranks.py PROGRAM"""
import array
import filecmp
import json
import os
import pathlib
import subprocess
import sys
import tempfile

PROGRAM = sys.argv[1]
ENV = dict(os.environ, OMP_NUM_THREADS="1", OMPI_MCA_rmaps_base_oversubscribe="1", OMPI_MCA_hwloc_base_binding_policy="none",
           OMPI_MCA_mpi_yield_when_idle="1", OMPI_MCA_btl_vader_single_copy_mechanism="none", OMPI_ALLOW_RUN_AS_ROOT="1",
           OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
failures = []


def expect(condition, what):
    print(("ok    " if condition else "FAIL  ") + what, flush=True)
    failures.extend([] if condition else [what])


def run(ranks, folder):
    folder.mkdir(exist_ok=True)
    subprocess.run(["mpirun", "-n", str(ranks), PROGRAM, str(folder)], env=ENV, check=True, timeout=200)
    return json.loads((folder / f"{ranks}.json").read_text())


def values(path):
    return array.array("d", path.read_bytes())


with tempfile.TemporaryDirectory(prefix="strake-test-") as scratch:
    scratch = pathlib.Path(scratch)
    one = run(1, scratch)
    for ranks in (2, 3, 4, 8):
        other = run(ranks, scratch)
        for name, width in (("column", 3), ("box", 4)):
            a, b = values(scratch / f"1.{name}"), values(scratch / f"{ranks}.{name}")
            expect(len(a) == len(b), f"{ranks} ranks, {name}: all particles")
            off = max(abs(x - y) for x, y in zip(a[::width], b[::width])) / one[name]["scale"]
            expect(off <= 1e-6, f"{ranks} ranks, {name}: pressure {off:.1e} of rho (gH + U^2) from one rank")
            of, count = one[name]["iterations"], other[name]["iterations"]
            expect(abs(of - count) <= 1, f"{ranks} ranks, {name}: {count} iterations, one rank {of}")
            expect(other[name]["imbalance"] <= 1.15, f"{ranks} ranks, {name}: imbalance {other[name]['imbalance']}, "
                   f"ghosts {100 * other[name]['ghosts']:.0f} %, {other[name]['bytes']:.0f} B a ghost and step")
    run(3, scratch / "again")
    same = all(filecmp.cmp(scratch / f"3.{name}", scratch / f"again/3.{name}", shallow=False) for name in ("column", "box"))
    expect(same, "3 ranks again: the same bytes")
print(f"{len(failures)} failed")
sys.exit(bool(failures))
