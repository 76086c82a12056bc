"""How the water's step would scale to 1e9 particles, from counters of runs on 8 to 64 ranks.

usage: scale_model.py PROGRAM [--ranks 8 16 32 64] [--check]
PROGRAM is build/tests/fluid_mpi_ranks. It computes a box of water in space on each number of ranks, on whatever processors there are; only
counts are read: ghosts, bytes and messages of a step, sums over all ranks, iterations, imbalance. No time of those runs enters.

The model, of a rank with n own particles:
  computing   n (1 + part g) t       t: one particle on one processor; g: all ghosts over own; part: what one of them takes of t, to copy
                                     it anew where the water is divided; ghosts have neither rows nor sums
  halo        g n b / B + m a        b: bytes of a ghost and step; m: messages; a: latency; B: of ghosts from the same
                                     node what two ranks reach, of those from other nodes the rank's part of the network
  sums        s L log2(ranks)        s: sums over all ranks in a step; L: one stage of such a sum
  hypre       h n t                  h: what the pressure takes longer than on one rank, with BoomerAMG in the place of own levels, of t
  grid        iterations k levels a  messages of a cycle of the grid, k on each level
  imbalance   (max/mean - 1) of the work falls as n^(-1/3): boxes end between buckets, and a bucket is so much of a box
Efficiency is n t over the sum of all. Ghosts are those of a cube with neighbours on all sides.
"""
import argparse
import json
import math
import os
import pathlib
import subprocess
import tempfile

parser = argparse.ArgumentParser()
parser.add_argument("program", type=pathlib.Path)
parser.add_argument("--ranks", type=int, nargs="+", default=[8, 16, 32, 64])
options = parser.parse_args()
ENV = dict(os.environ, OMP_NUM_THREADS="1", OMPI_MCA_rmaps_base_oversubscribe="1", OMPI_MCA_hwloc_base_binding_policy="none",
           OMPI_MCA_mpi_yield_when_idle="1", OMPI_MCA_btl_vader_single_copy_mechanism="none", OMPI_ALLOW_RUN_AS_ROOT="1",
           OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")

# What a machine is assumed to have. None of it was measured here.
LATENCY = 2e-6            # s a message between nodes
SUM_STAGE = 20e-6         # s a stage of a sum over all ranks
RANKS_OF_NODE = 64
NETWORK = 25e9 / RANKS_OF_NODE  # B/s of a rank
# Measured by rank_scaling.py, two ranks on two processors.
SECONDS_OF_PARTICLE = 5.4e-6  # a step of 2.5e5 particles in space, one thread
GHOST_PART = 0.06             # stage `division` of 2 ranks / half of a step / ghosts; the other stages take no longer than one rank's
HYPRE_PART = 0.08             # (pressure of 2 ranks - half of one rank's) / half of a step: set-up, cycles, one more iteration
WITHIN_NODE = 1.9e9           # B/s of a rank: bytes sent over the stage `halo` of the rank that waits least
CYCLE_MESSAGES, LEVELS = 8, 10  # of the grid's cycle on a level; levels of 4e7 rows

with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    found = []
    for ranks in options.ranks:
        subprocess.run(["mpirun", "-n", str(ranks), options.program.resolve(), folder, "counts"], env=ENV, check=True)
        found.append((ranks, json.loads((folder / f"{ranks}.json").read_text())["counts"]))

print("measured: a box of water in space, counts of a step")
print(f"{'ranks':>6} {'own':>8} {'ghosts':>8} {'first ring':>11} {'B/ghost':>8} {'messages':>9} {'sums':>6} {'iterations':>11} {'imbalance':>10}")
for ranks, of in found:
    print(f"{ranks:6d} {of['own']:8.0f} {100 * of['ghosts']:7.0f}% {100 * of['first_ring']:10.0f}% {of['bytes']:8.0f} "
          f"{of['messages']:9.0f} {of['sums']:6.0f} {of['iterations']:11d} {of['imbalance']:10.3f}")

# A rank inside has ghosts on all sides: a cube of side n^(1/3) grown by 6.3 on each of them.
worst = {key: max(of[key] for _, of in found) for key in ("bytes", "messages", "sums", "iterations")}
uneven = max((of["imbalance"] - 1) * of["own"] ** (1 / 3) for _, of in found)


def ghosts_of(n, width):
    side = n ** (1 / 3)
    return ((side + 2 * width) / side) ** 3 - 1


def model(ranks, n):
    g, outside = ghosts_of(n, 6.3), ghosts_of(RANKS_OF_NODE * n, 6.3)  # outside: from other nodes
    useful = n * SECONDS_OF_PARTICLE
    parts = {
        "ghosts": g * GHOST_PART * useful,
        "halo, bytes": worst["bytes"] * n * ((g - outside) / WITHIN_NODE + outside / NETWORK),
        "halo, messages": worst["messages"] * 26 / 7 * LATENCY,  # 26 neighbours; 8 ranks have 7
        "sums": worst["sums"] * SUM_STAGE * math.log2(ranks),
        "hypre": HYPRE_PART * useful,
        "grid": worst["iterations"] * CYCLE_MESSAGES * LEVELS * 26 * LATENCY,
        "imbalance": uneven / n ** (1 / 3) * useful,
    }
    return useful, parts


print("\nmodelled, of a step; the ghosts of a rank inside, 6.3 l0 around a cube (an upper bound)")
print(f"{'ranks':>6} {'particles':>10} {'a rank':>9} {'ghosts':>7} {'step':>8} {'efficiency':>11}   losses")
for ranks, total in ((64, 32e6), (512, 250e6), (2048, 1e9), (8192, 1e9)):
    n = total / ranks
    useful, parts = model(ranks, n)
    step = useful + sum(parts.values())
    print(f"{ranks:6d} {total:10.1e} {n:9.0f} {100 * ghosts_of(n, 6.6):6.0f}% {step:6.2f} s {useful / step:11.2f}   "
          + ", ".join(f"{name} {100 * value / step:.1f} %" for name, value in parts.items()))
print("\nNot in the model: layer particles of walls. A rank has those near its water, and makes their list anew where the boxes change.")
print("The memory of a node is assumed to serve all its ranks as it serves two.")
print("Weakest assumption: the set-up of BoomerAMG on the grid, 1/31 of the particles, is counted as if it scaled as computing does. On thousands of")
print("ranks it has ten levels of messages of its own, which were not counted here. And the water is still: where it moves, it is divided anew in many")
print("steps. A division takes 5 to 8 ms on two ranks with a step of 800 ms.")
