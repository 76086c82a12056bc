"""Time of a step on ranks and on threads, weak and strong, and what the ranks say of themselves.

usage: rank_scaling.py BUILD [--turns N] [--steps N] [--small] [--series N ...]
Still water in a box that fills whole cells of both grids, in the plane and in space. In turns on one machine, least of all turns:
  half   1 rank, 1 thread, half of the box        ranks  2 ranks, 1 thread each, the whole box
  one    1 rank, 1 thread, the whole box          threads  1 rank, 2 threads, the whole box
Weak efficiency is half / ranks; the ranks against threads is ranks / threads. Wanted: weak 0.85 (pressure) and 0.80 (step),
ranks / threads <= 1.11, CPU time of 4 ranks on 2 processors outside messages <= 1.15 of one.
Of the four ranks the time of MPI's calls inside hypre is known, and told apart, where the target message_time is built.
With --series, on a machine with as many processors: N ranks with a box of N halves, and one rank with N threads and the same box.
The halves lie beside each other along x, in space along x and z."""
import argparse
import json
import os
import pathlib
import resource
import subprocess
import sys
import tempfile

parser = argparse.ArgumentParser()
parser.add_argument("build", type=pathlib.Path)
parser.add_argument("--turns", type=int, default=2)
parser.add_argument("--steps", type=int, default=20)
parser.add_argument("--small", action="store_true", help="an eighth of the particles, to try the script")
parser.add_argument("--series", type=int, nargs="+", default=[], help="weak efficiency alone, on so many ranks and on so many threads")
options = parser.parse_args()
STRAKE = options.build.resolve() / "bin" / "strake"
MESSAGE_TIME = options.build.resolve() / "tests" / "libmessage_time.so"
SPACING = 0.01
CASE = """title = "still water on ranks"
preset = "improved"
end_time = {end}
[fluid]
dimension = {dimension}
spacing = {spacing}
density = 1000.0
gravity = [0.0, -9.81, 0.0]
tank = [[0.0, 0.0, 0.0], [{x}, {top}, {z}]]
water = [[0.0, 0.0, 0.0], [{x}, {y}, {z}]]
[fluid.scheme]
time_step = {step}
[structure]
solver = "none"
[coupling.surface]
window = {end}
[output]
every = {end}
"""
# Particles along x, y and z of the half box; the whole one is twice as long, plus what fills its last cell.
BOXES = {"2-D": ((503, 1002), 497, 1), "3-D": ((59, 118), 46, 46)}
STEP = 1.5e-3


def run(folder, name, dimension, x, y, z, ranks, threads):
    case = folder / f"{name}.toml"
    case.write_text(CASE.format(end=options.steps * STEP, dimension=dimension, spacing=SPACING, step=STEP, x=x * SPACING, y=y * SPACING,
                                top=(y + y // 5) * SPACING, z=z * SPACING if dimension == 3 else 0.0))
    allow = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    command = [STRAKE, "run", case, "--runs", folder / "runs", "--force", "--quiet", "--no-trace",
               "--set", f"fluid.ranks={ranks}", "--set", f"run.threads={threads}"]
    if ranks > os.cpu_count():
        loaded = f"-x LD_PRELOAD={MESSAGE_TIME} -x STRAKE_MESSAGE_TIME={folder / name} " if MESSAGE_TIME.exists() else ""
        command += ["--set", 'fluid.launcher="mpirun --oversubscribe --mca mpi_yield_when_idle 1 ' + loaded + '-n {ranks}"']
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, env=dict(os.environ, **allow), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode != 0:
        sys.exit(done.stdout)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    summary = json.loads((folder / "runs" / name / "summary.json").read_text())
    stages = summary["seconds"]["fluid"]
    rows = [line.split(",") for line in (folder / "runs" / name / "history.csv").read_text().splitlines() if line and not line.startswith("#")]
    iterations = dict(zip([cell.split(" ")[0] for cell in rows[0]], rows[-1]))["pressure_iterations"]
    waits = [float(file.read_text()) for file in folder.glob(name + ".[0-9]*")]
    return {"in_hypre": sum(waits), "step": sum(stages.values()) / options.steps, "stages": stages, "ranks": summary["ranks"]["fluid"], "iterations": int(float(iterations)),
            "cpu": after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime}


def least(results):
    best = min(results, key=lambda result: result["step"])
    best["stages"] = {stage: min(result["stages"][stage] for result in results) / options.steps for stage in best["stages"]}
    return best


def box_of(n, half, y, z):
    """A box of n halves: along x, in space in equal parts along x and z; each length fills whole cells of both grids as far as it can."""
    across = 1
    while z > 1 and 4 * across * across <= n and n % (2 * across) == 0:
        across *= 2
    return half * (n // across), y, z * across


def series(folder, space, half, y, z):
    """Weak efficiency: N ranks, and N threads of one rank, on N halves."""
    dimension = 2 if z == 1 else 3
    print(f"{space}: {half * y * z} particles for each rank or thread; ms a step, least of {options.turns} turns of {options.steps} steps")
    first = None
    for n in options.series:
        x, deep, wide = box_of(n, half, y, z)
        for kind, ranks, threads in (("ranks", n, 1), ("threads", 1, n)):
            if n == 1 and kind == "threads":
                continue
            best = least([run(folder, kind, dimension, x, deep, wide, ranks, threads) for turn in range(options.turns)])
            stages = best["stages"]
            together = stages["pressure"] + stages.get("halo", 0) + stages.get("waiting", 0)
            first = first or (together, best["step"])
            counts = best["ranks"]
            print(f"  {n:3d} {kind:8} step {1e3 * best['step']:8.1f}  efficiency {first[1] / best['step']:.2f}   pressure with messages {1e3 * together:8.1f}  "
                  f"{first[0] / together:.2f}   iterations {best['iterations']}"
                  + "".join(f"  {stage} {1e3 * seconds:.1f}" for stage, seconds in sorted(stages.items(), key=lambda item: -item[1])), flush=True)
            if counts and kind == "ranks":
                busy = [rank["busy"] for rank in counts]
                memory = [rank["memory_bytes"] / 2**20 for rank in counts]
                print(f"      imbalance {max(busy) * len(busy) / sum(busy):.3f}, ghosts {100 * max(rank['ghosts'] / rank['particles'] for rank in counts):.0f} %, "
                      f"memory of a rank {min(memory):.0f} to {max(memory):.0f} MiB", flush=True)


with tempfile.TemporaryDirectory(prefix="strake-ranks-") as name:
    folder = pathlib.Path(name)
    for space, ((half, whole), y, z) in BOXES.items():
        if options.small:
            scale = 2 if space == "3-D" else 3
            half, whole, y, z = half // scale, whole // scale, y // scale, max(1, z // scale)
        if options.series:
            series(folder, space, half, y, z)
            continue
        dimension = 2 if z == 1 else 3
        kinds = {"half": (half, 1, 1), "ranks": (whole, 2, 1), "one": (whole, 1, 1), "threads": (whole, 1, 2), "four": (whole, 4, 1)}
        found = {kind: [] for kind in kinds}
        for turn in range(options.turns):
            for kind, (x, ranks, threads) in kinds.items():
                found[kind].append(run(folder, kind, dimension, x, y, z, ranks, threads))
        best = {kind: least(results) for kind, results in found.items()}
        print(f"{space}: {half * y * z} and {whole * y * z} particles; ms a step, least of {options.turns} turns of {options.steps} steps")
        order = sorted(best["one"]["stages"], key=lambda stage: -best["one"]["stages"][stage])
        stages = order + [stage for stage in best["ranks"]["stages"] if stage not in order]
        for stage in stages:
            print(f"  {stage:12}" + "".join(f"{kind:>9} {1e3 * best[kind]['stages'].get(stage, 0):8.1f}" for kind in kinds))
        print(f"  {'step':12}" + "".join(f"{kind:>9} {1e3 * best[kind]['step']:8.1f}" for kind in kinds))
        print(f"  {'iterations':12}" + "".join(f"{kind:>9} {best[kind]['iterations']:8d}" for kind in kinds))
        # The wait for all ranks is of the pressure, but for a few decisions of a step.
        together = {stage: best["ranks"]["stages"][stage] for stage in ("halo", "waiting")}
        pressure = best["ranks"]["stages"]["pressure"] + sum(together.values())
        print(f"  weak: pressure with all messages {best['half']['stages']['pressure'] / pressure:.2f}, step {best['half']['step'] / best['ranks']['step']:.2f}; "
              f"threads alone {best['half']['step'] / best['threads']['step']:.2f}")
        print(f"  2 ranks / 2 threads {best['ranks']['step'] / best['threads']['step']:.2f}; 2 threads against 1: {best['one']['step'] / best['threads']['step']:.2f}")
        busy = [rank["busy"] for rank in best["four"]["ranks"]]
        cpu = sum(rank["cpu"] for rank in best["four"]["ranks"])
        print(f"  4 ranks: processor time outside messages {cpu / best['one']['cpu']:.2f} of one rank's, start and output included; imbalance {max(busy) * len(busy) / sum(busy):.2f}")
        waits = best["four"]["in_hypre"]
        if waits > 0:
            print(f"  without MPI's calls inside hypre, {waits:.2f} s of {cpu:.2f}: {(cpu - waits) / best['one']['cpu']:.2f} of one rank's")
        for rank in best["four"]["ranks"]:
            print(f"    particles {rank['particles']}, ghosts {100 * rank['ghosts'] / rank['particles']:.1f} %, memory {rank['memory_bytes'] / 2**20:.0f} MiB, "
                  f"sent {rank['sent_bytes'] / options.steps / max(1, rank['ghosts']):.0f} B a ghost and step")
