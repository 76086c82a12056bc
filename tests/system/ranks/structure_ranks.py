"""A body on several ranks in water: the figures of one rank, resumed runs, ranks that die or stop, refusals.
structure_ranks.py ROOT BIN"""
import csv
import pathlib
import shutil
import signal
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parents[1]))
from processes import BIN, ROOT, expect, finish, folder, lose_rank, rows, start, strake, wait_until

CASE = ROOT / "tests/system/ranks/block.toml"
FAST = ["--set", "run.threads=1", "--quiet"]
PROGRAM = "strake-structure-fem-ranks"


def run(cwd, ranks, tag, *more):
    return strake("run", CASE, "--tag", tag, "--set", f"structure.ranks={ranks}", *FAST, *more, cwd=cwd, timeout=280)


def table(cwd, tag):
    with open(f"{cwd}/runs/block-{tag}/history.csv", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def largest_difference(one, other):
    """Of a column, over the largest value in it; of displacement, stress and energies."""
    worst = 0
    for name in one[0]:
        if not name.startswith(("bottom", "seam", "energy", "force")) or name.endswith((".x", ".z")):
            continue
        scale = max(abs(float(row[name])) for row in one) or 1
        worst = max(worst, max(abs(float(a[name]) - float(b[name])) for a, b in zip(one, other)) / scale)
    return worst


def same_figures():
    with folder() as cwd:
        expect(run(cwd, 1, "one").returncode == 0, "on one rank")
        process = start("run", CASE, "--tag", "half", *FAST, cwd=cwd)
        half = pathlib.Path(cwd) / "runs/block-half"
        wait_until(lambda: rows(half) > 0, 120)
        process.send_signal(signal.SIGINT)
        _, said = process.communicate(timeout=30)
        expect(process.returncode == 130, "Ctrl-C on two ranks: exit 130\n" + said)
        for ranks in (1, 2):
            shutil.copytree(half, f"{cwd}/runs/block-on{ranks}")
            done = run(cwd, ranks, f"on{ranks}", "--resume")
            off = largest_difference(table(cwd, "one"), table(cwd, f"on{ranks}"))
            expect(done.returncode == 0 and off < 1e-9, f"resumed on {ranks}: {off:.1e} from one rank" + done.stderr)
        done = run(cwd, 2, "two")
        expect(done.returncode == 0 and table(cwd, "two") == table(cwd, "on2"), "resumed on 2: the bytes of 2" + done.stderr)
        frames = [sorted(path.name for path in pathlib.Path(cwd).glob(f"runs/block-{tag}/frames/structure*"))
                  for tag in ("one", "two")]
        expect(frames[0] == frames[1] and len(frames[0]) > 1, f"as many frames: {frames}")


def factors_and_failure():
    """Factors, and a body that may fail but is strong enough; one that fails: tests/structure/ranks."""
    sets = ["structure.fem.linear_solver=\"direct\"", "structure.failure.criterion=\"von_mises\"", "structure.failure.strength=1e9",
            "structure.failure.fracture_energy=1e6", "structure.fem.strain=\"compatible\""]
    keys = [word for key in sets for word in ("--set", key)]
    with folder() as cwd:
        for ranks in (1, 2):
            done = run(cwd, ranks, f"factors{ranks}", *keys)
            expect(done.returncode == 0, f"factors on {ranks}\n" + done.stderr)
        one, two = table(cwd, "factors1"), table(cwd, "factors2")
        off = largest_difference(one, two)
        expect(off < 1e-9 and any("failure.damage" in name for name in two[0]), f"factors: {off:.1e} from one rank")


def lost_rank(kill, rank, limit):
    with folder() as cwd:
        process = start("run", CASE, *FAST, cwd=cwd)
        wait_until(lambda: rows(pathlib.Path(cwd) / "runs/block") > 0, 120)
        lose_rank(process, PROGRAM, rank, kill, limit)


def refusals():
    with folder() as cwd:
        for keys, words in ((["structure.solver=\"rigid\""], "a rigid structure is computed on one rank"),
                            (["structure.launcher=\" \""], "line that starts the ranks"),
                            (["structure.ranks=0"], "whole number")):
            sets = [word for key in keys for word in ("--set", key)]
            done = strake("check", CASE, *sets, cwd=cwd)
            expect(done.returncode in (2, 3) and words in done.stderr, f"{keys} is refused: {words}\n{done.stderr}")
        done = run(cwd, 4, "many")
        expect(done.returncode == 3 and "at least 5000 unknowns" in done.stderr, "few unknowns\n" + done.stderr)
        done = run(cwd, 2, "none", "--set", "structure.launcher=/nowhere/mpirun")
        expect(done.returncode == 5 and "cannot be started" in done.stderr, "no launcher\n" + done.stderr)
        done = run(cwd, 2, "few", "--set", "structure.launcher=mpirun -n 1")
        expect(done.returncode == 5 and "has started 1 ranks, structure.ranks is 2" in done.stderr,
               "a launcher of fewer ranks\n" + done.stderr)


if not (BIN / PROGRAM).exists():
    print("no " + PROGRAM + ": MPI or Trilinos ML was not there")
    finish()
same_figures()
factors_and_failure()
lost_rank(signal.SIGKILL, 1, 5)
lost_rank(signal.SIGSTOP, 0, 10)
refusals()
finish()
