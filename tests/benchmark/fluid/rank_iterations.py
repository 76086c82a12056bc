"""Iterations of the pressure's conjugate gradients on ranks: a column that collapses, a box that enters water, in the plane and in space.

usage: rank_iterations.py PROGRAM [--ranks 1 2 4 8] [--particles 10000 100000 1000000] [--dimensions 2 3]
PROGRAM is build/tests/fluid_mpi_ranks. No times: iterations are counts, so that any number of processors will do. 1e6 particles in space
need 7 GiB on eight ranks. Each line is one flow; a cell has the iterations of its first five steps. Wanted: at most one more or less than
one rank in each step. Exit 1 where it is more."""
import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile

parser = argparse.ArgumentParser()
parser.add_argument("program", type=pathlib.Path)
parser.add_argument("--ranks", type=int, nargs="+", default=[1, 2, 4, 8])
parser.add_argument("--particles", type=float, nargs="+", default=[1e4, 1e5, 1e6])
parser.add_argument("--dimensions", type=int, nargs="+", default=[2, 3])
options = parser.parse_args()
ENV = dict(os.environ, OMP_NUM_THREADS="1", OMPI_MCA_rmaps_base_oversubscribe="1", OMPI_MCA_hwloc_base_binding_policy="none",
           OMPI_MCA_mpi_yield_when_idle="1", OMPI_MCA_btl_vader_single_copy_mechanism="none", OMPI_ALLOW_RUN_AS_ROOT="1",
           OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
worst = 0
with tempfile.TemporaryDirectory(prefix="strake-ranks-") as folder:
    print(f"{'flow':16}{'particles':>10}" + "".join(f"{f'{ranks} ranks':>22}" for ranks in options.ranks), flush=True)
    for dimension in options.dimensions:
        for name in ("column", "entry"):
            for particles in options.particles:
                found = []
                for ranks in options.ranks:
                    subprocess.run(["mpirun", "-n", str(ranks), options.program.resolve(), folder, name, str(dimension), str(particles)],
                                   env=ENV, check=True)
                    found.append(json.loads(pathlib.Path(folder, f"{ranks}.json").read_text()))
                counts = [of["iterations"] for of in found]
                worst = max([worst] + [abs(a - b) for steps in counts for a, b in zip(steps, counts[0])])
                print(f"{name + f', {dimension}-D':16}{found[0]['particles']:10d}"
                      + "".join(f"{' '.join(map(str, steps)):>22}" for steps in counts), flush=True)
print(f"largest difference from {options.ranks[0]} ranks: {worst}")
sys.exit(worst > 1)
