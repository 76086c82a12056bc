"""Instructions of a step on ranks, by what they are for: of one rank and of several with the same still water.

usage: rank_instructions.py PROGRAM [--ranks 1 4] [--particles 20000] [--dimensions 2 3] [--top N]
PROGRAM is fluid_mpi_ranks of a build with -DSTRAKE_NATIVE=OFF (valgrind knows no 512-bit vectors). callgrind counts each of five steps apart;
printed is the mean of three, summed over ranks, in millions, by library; what MPI calls in the C library is counted there. Counts do not depend on
what else the machine does, but waiting in MPI does. Wanted: 4 ranks outside MPI <= 1.15 of one.
--top: functions with the largest difference from the first number of ranks."""
import argparse
import collections
import json
import os
import pathlib
import re
import subprocess
import tempfile

parser = argparse.ArgumentParser()
parser.add_argument("program", type=pathlib.Path)
parser.add_argument("--ranks", type=int, nargs="+", default=[1, 4])
parser.add_argument("--particles", type=float, default=20000)
parser.add_argument("--dimensions", type=int, nargs="+", default=[2, 3])
parser.add_argument("--top", type=int, default=0)
options = parser.parse_args()
ENV = dict(os.environ, OMP_NUM_THREADS="1", OMPI_MCA_rmaps_base_oversubscribe="1", OMPI_MCA_hwloc_base_binding_policy="none",
           OMPI_MCA_mpi_yield_when_idle="1", OMPI_MCA_btl_vader_single_copy_mechanism="none", OMPI_ALLOW_RUN_AS_ROOT="1",
           OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
STEPS = (3, 4, 5)  # parts of callgrind's output, one for each step
MPI = ("libmpi", "libopen-", "mca_", "libpmix", "libevent", "libhwloc")


def is_mpi(library):
    return os.path.basename(library).startswith(MPI)


class Profile:
    """Instructions of each function, without what it calls, in the files of several ranks and steps."""

    def __init__(self):
        self.own = collections.Counter()

    def read(self, path):
        names = {"fn": {}, "ob": {}}
        library = function = ""
        calls = False

        def name(kind, text):
            number, rest = re.match(r"\((\d+)\)(?: (.*))?$", text).groups()
            if rest is not None:
                names[kind][number] = rest
            return names[kind][number]

        for line in path.open(errors="replace"):
            key, _, text = line.rstrip("\n").partition("=")
            if line[0] in "0123456789+-*":
                if not calls:
                    self.own[library, function] += int(line.split()[1])
                calls = False
            elif key == "ob":
                library = name("ob", text)
            elif key == "fn":
                function = name("fn", text)
            elif key in ("cob", "cfn"):
                name(key[1:], text)
            elif key == "calls":
                calls = True

    def groups(self):
        """Instructions in the libraries of each group."""
        found = collections.Counter()
        for (library, _), cost in self.own.items():
            group = "MPI" if is_mpi(library) else "hypre" if "HYPRE" in library else "C library" if "libc.so" in library else "program"
            found[group] += cost
        return found


with tempfile.TemporaryDirectory(prefix="strake-ranks-") as name:
    folder = pathlib.Path(name)
    for dimension in options.dimensions:
        first = None
        for ranks in options.ranks:
            profile = Profile()
            for old in folder.glob("callgrind.*"):
                old.unlink()
            subprocess.run(["mpirun", "-n", str(ranks), "valgrind", "--tool=callgrind", "--dump-before=*Simulation<*>::step*",
                            f"--callgrind-out-file={folder}/callgrind.%p", options.program.resolve(), folder, "still", str(dimension),
                            str(options.particles)], env=ENV, check=True, stderr=subprocess.DEVNULL)
            for step in STEPS:
                for path in folder.glob(f"callgrind.*.{step}"):
                    profile.read(path)
            found = json.loads((folder / f"{ranks}.json").read_text())
            groups = {group: count / len(STEPS) / 1e6 for group, count in profile.groups().items()}
            outside = sum(groups.values()) - groups.get("MPI", 0)
            first = first or (outside, profile)
            print(f"{dimension}-D, {found['particles']} particles, {ranks} ranks, iterations {found['iterations']}: outside MPI {outside:.1f} ({outside / first[0]:.3f}), "
                  + ", ".join(f"{group} {count:.1f}" for group, count in groups.items()), flush=True)
            more = {key: profile.own[key] - first[1].own[key] for key in profile.own if not is_mpi(key[0])}
            for key in sorted(more, key=more.get, reverse=True)[:options.top]:
                print(f"  {more[key] / len(STEPS) / 1e6:+8.2f} of {profile.own[key] / len(STEPS) / 1e6:8.2f}  {os.path.basename(key[0])[:16]:16} {key[1][:120]}")
