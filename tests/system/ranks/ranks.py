"""The water on several ranks: the results of one rank, resumed runs, ranks that die, stop or fail, refusals.
ranks.py ROOT BIN"""
import pathlib
import re
import resource
import shutil
import signal
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).parents[1]))
from processes import BIN, ENV, ROOT, alive, expect, finish, folder, lose_rank, ranks_of, rows, start, strake, wait_until

CASE = ROOT / "cases/plate_entry.toml"
ENTRY = ["--set", "fluid.spacing=0.0125", "--set", "run.threads=1", "--set", "structure.velocity=[0, -20, 0]",
         "--quiet"]


def run(cwd, ranks, tag, *more):
    return strake("run", CASE, "--tag", tag, "--set", f"fluid.ranks={ranks}", *ENTRY, *more, cwd=cwd)


def history(cwd, tag):
    return (pathlib.Path(cwd) / f"runs/plate_entry-{tag}/history.csv").read_bytes()


def forces(cwd, tag):
    lines = history(cwd, tag).decode().splitlines()
    at = [name.split(" ")[0] for name in lines[0].split(",")].index("force.y")
    return [float(line.split(",")[at]) for line in lines[1:]]


def departs(cwd, tag):
    """Largest difference from the force of one rank, over the largest force."""
    one, other = forces(cwd, "one"), forces(cwd, tag)
    expect(len(one) == len(other), f"{tag}: all windows")
    return max(abs(a - b) for a, b in zip(one, other)) / max(map(abs, one))


def same_results():
    """The pressure is that of one rank to its tolerance, 1e-8 of the right side."""
    with folder() as cwd:
        end = ["--set", "end_time=0.0008"]
        for tag, ranks in (("one", 1), ("two", 2)):
            expect(run(cwd, ranks, tag, *end).returncode == 0, f"plate_entry, {tag}")
        expect(departs(cwd, "two") < 1e-5, f"two ranks: the force of one, {departs(cwd, 'two'):.1e} off")
        process = start("run", CASE, "--tag", "half", "--set", "fluid.ranks=2", *ENTRY, *end, cwd=cwd)
        half = pathlib.Path(cwd) / "runs/plate_entry-half"
        wait_until(lambda: rows(half) > 50, 120)
        process.send_signal(signal.SIGINT)
        _, said = process.communicate(timeout=30)
        expect(process.returncode == 130, "Ctrl-C on two ranks: exit 130\n" + said)
        for ranks in (1, 2, 3):
            tag = f"on{ranks}"
            shutil.copytree(f"{cwd}/runs/plate_entry-half", f"{cwd}/runs/plate_entry-{tag}")
            done = run(cwd, ranks, tag, *end, "--resume")
            expect(done.returncode == 0, f"resumed on {ranks}" + done.stderr)
            expect(departs(cwd, tag) < 1e-5, f"resumed on {ranks}: the force of one, {departs(cwd, tag):.1e} off")
        expect(history(cwd, "on2") == history(cwd, "two"), "resumed on 2: the bytes of the run without a stop")


def lost_rank(kill, rank, limit):
    with folder() as cwd:
        process = start("run", CASE, "--set", "fluid.ranks=2", *ENTRY, cwd=cwd)
        table = pathlib.Path(cwd) / "runs/plate_entry/history.csv"
        wait_until(lambda: table.exists() and table.read_text().count("\n") > 3, 60)
        lose_rank(process, "strake-fluid-ranks", rank, kill, limit)


def failing_rank(fault, code, named, not_named, limit):
    """A rank that throws, alone or with all others (faulty_rank.cpp): the run ends, and says which rank and why."""
    with folder() as cwd:
        launcher = pathlib.Path(cwd) / "rank.sh"
        launcher.write_text(f"#!/bin/sh\nshift\nexec {BIN.parent}/tests/faulty_rank \"$@\"\n")
        launcher.chmod(0o755)
        ENV["STRAKE_FAULT"] = fault
        done = run(cwd, 2, "fails", "--set", f"fluid.launcher=mpirun -n {{ranks}} {launcher}")
        ended = time.monotonic()
        log = (pathlib.Path(cwd) / "runs/plate_entry-fails/fluid.log").read_text()
        began = min(float(at) for at in re.findall(r"fault at ([0-9.]+)", log))
        expect(done.returncode == code, f"{fault}: exit {code}, was {done.returncode}\n{done.stderr}")
        expect(all(word in done.stderr for word in named), f"{fault}: {named} in\n{done.stderr}")
        expect(not_named not in done.stderr, f"{fault}: no word of {not_named}")
        expect(ended - began < limit, f"{fault}: ended {ended - began:.1f} s after the fault, within {limit} s")
        expect(wait_until(lambda: not any(marked(fault)), 5), f"{fault}: no rank is left")


def marked(fault):
    for entry in pathlib.Path("/proc").iterdir():
        try:
            yield entry.name.isdigit() and f"STRAKE_FAULT={fault}".encode() in (entry / "environ").read_bytes().split(b"\0")
        except OSError:
            continue


def failures_of_ranks():
    for fault, code, named, not_named in (
            ("1:memory:start:3", 5, ["rank 1", "is out of memory"], "rank 0"),
            ("0:memory:start:3", 5, ["rank 0", "is out of memory"], "rank 1"),
            ("1:error:start:3", 5, ["rank 1", "the flow has blown up", "fluid.scheme.cfl"], "rank 0"),
            ("0:bug:start:3", 70, ["rank 0", "a vector is too short"], "rank 1"),
            ("1:error:after:3", 4, ["rank 1", "the flow has blown up"], "exited"),
            ("all:error:start:3", 4, ["the flow has blown up"], "rank "),
            ("1:thread:start:3", 5, ["rank 1", "a loop has failed"], "rank 0"),
            ("1:memory:build:", 5, ["rank 1", "is out of memory"], "rank 0")):
        failing_rank(fault, code, named, not_named, 5)


def out_of_memory(rank):
    """A rank that the system gives no more memory."""
    with folder() as cwd:
        process = start("run", CASE, "--set", "fluid.ranks=2", *ENTRY, cwd=cwd)
        table = pathlib.Path(cwd) / "runs/plate_entry/history.csv"
        wait_until(lambda: table.exists() and table.read_text().count("\n") > 3, 60)
        pids = ranks_of(process, "strake-fluid-ranks")
        began = time.monotonic()
        resource.prlimit(pids[rank], resource.RLIMIT_AS, (1 << 20, resource.RLIM_INFINITY))
        _, said = process.communicate(timeout=60)
        seconds = time.monotonic() - began
        expect(process.returncode == 5, f"rank {rank} without memory: exit 5, was {process.returncode}")
        expect(f"rank {rank}" in said and "is out of memory" in said, f"the message names rank {rank} and the cause:\n{said}")
        expect(seconds < 5, f"within 5 s: {seconds:.1f} s")
        expect(wait_until(lambda: not any(alive(pid) for pid in pids.values()), 5), "no rank is left")


def refusals():
    with folder() as cwd:
        for keys, words in ((["fluid.ranks=9"], "at least 1000 water particles"),
                            (["fluid.ranks=2", "fluid.air.layer=true"], "air under a body"),
                            (["fluid.ranks=2", "preset=\"paper\""], "least-squares"),
                            (["fluid.ranks=2", "fluid.launcher=\" \""], "line that starts the ranks"),
                            (["fluid.ranks=0"], "whole number")):
            sets = [word for key in keys for word in ("--set", key)]
            done = strake("check", CASE, "--set", "fluid.spacing=0.0125", *sets, cwd=cwd)
            expect(done.returncode in (2, 3) and words in done.stderr, f"{keys} is refused: {words}\n{done.stderr}")
        done = run(cwd, 2, "none", "--set", "fluid.launcher=/nowhere/mpirun")
        expect(done.returncode == 5 and "cannot be started" in done.stderr, "no launcher\n" + done.stderr)
        done = run(cwd, 2, "few", "--set", "fluid.launcher=mpirun -n 1")
        expect(done.returncode == 5 and "has started 1 ranks, fluid.ranks is 2" in done.stderr,
               "a launcher of fewer ranks\n" + done.stderr)


if not (BIN / "strake-fluid-ranks").exists():
    print("no strake-fluid-ranks: MPI or Zoltan was not there")
    finish()
same_results()
lost_rank(signal.SIGKILL, 1, 5)
lost_rank(signal.SIGSTOP, 0, 10)
failures_of_ranks()
for one in (0, 1):
    out_of_memory(one)
refusals()
finish()
