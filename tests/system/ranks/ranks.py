"""The water on several ranks: the results of one rank, resumed runs, files in parts, ranks that die, stop or fail, refusals.
ranks.py ROOT BIN"""
import contextlib
import functools
import json
import os
import pathlib
import re
import resource
import shutil
import signal
import sys
import time
import xml.etree.ElementTree

import h5py
import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).parents[1]))
from processes import (BIN, ENV, ROOT, alive, expect, finish, folder, lose_rank, ranks_of, rows, side_by_side, start, strake,
                       wait_until)

CASE = ROOT / "cases/plate_entry.toml"
ENTRY = ["--set", "fluid.spacing=0.0125", "--set", "run.threads=1", "--set", "structure.velocity=[0, -40, 0]",
         "--quiet"]  # the plate meets the water in window 30
RIGID = ["--set", "structure.solver=rigid"]  # starts at once, where the water's ranks alone are of interest


def run(cwd, ranks, tag, *more, env=ENV):
    return strake("run", CASE, "--tag", tag, "--set", f"fluid.ranks={ranks}", *ENTRY, *more, cwd=cwd, env=env)


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
        end = ["--set", "end_time=0.0004"]
        for tag, ranks in (("one", 1), ("two", 2)):
            expect(run(cwd, ranks, tag, *end).returncode == 0, f"plate_entry, {tag}")
        log = (pathlib.Path(cwd) / "runs/plate_entry-two/fluid.log").read_text()
        expect("] [info] " in log and "\x1b" not in log, "the log of ranks has no colours")
        expect(departs(cwd, "two") < 1e-5, f"two ranks: the force of one, {departs(cwd, 'two'):.1e} off")
        same_frames(pathlib.Path(cwd) / "runs")
        read_by_others(pathlib.Path(cwd) / "runs/plate_entry-two")
        lost_parts_of_a_frame(cwd)
        for begun, resumed in ((1, (2,)), (2, (1, 2, 3)), (4, (2,))):
            interrupted(cwd, begun, end)
            for ranks in resumed:
                tag = f"{begun}on{ranks}"
                shutil.copytree(f"{cwd}/runs/plate_entry-half{begun}", f"{cwd}/runs/plate_entry-{tag}")
                done = run(cwd, ranks, tag, *end, "--resume")
                expect(done.returncode == 0, f"{begun} ranks resumed on {ranks}" + done.stderr)
                expect(departs(cwd, tag) < 1e-5, f"{begun} on {ranks}: the force of one, {departs(cwd, tag):.1e} off")
        expect(history(cwd, "2on2") == history(cwd, "two"), "resumed on 2: the bytes of the run without a stop")
        same_frames(pathlib.Path(cwd) / "runs", "2on3")
        lost_parts_of_a_checkpoint(cwd, end)


def interrupted(cwd, ranks, end):
    process = start("run", CASE, "--tag", f"half{ranks}", "--set", f"fluid.ranks={ranks}", *ENTRY, *end, cwd=cwd)
    half = pathlib.Path(cwd) / f"runs/plate_entry-half{ranks}"
    wait_until(lambda: rows(half) > 20, 120)
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=30)
    expect(process.returncode == 130, f"Ctrl-C on {ranks} ranks: exit 130\n" + said)


def frame(path):
    """The values of a frame, in the order of the particles' numbers."""
    with h5py.File(path) as file:
        order = np.argsort(file["point/id"][:, 0])
        return {name: file[name][()][order] for name in ("position", "point/id", "point/kind", "point/pressure")}


def same_frames(runs, tag="two"):
    """A frame of several ranks has the particles of one rank, whatever the folder that it is read from."""
    last = len(list((runs / "plate_entry-one/frames").glob("fluid-*.h5"))) - 1
    for number in (0, last):
        one, other = (frame(runs / f"plate_entry-{name}/frames/fluid-{number:06}.h5") for name in ("one", tag))
        for name in ("point/id", "point/kind"):
            expect(np.array_equal(one[name], other[name]), f"frame {number} of {tag}: {name} of one rank")
        off = abs(one["position"] - other["position"]).max()
        expect(off <= (1e-6 * 0.0125 if number else 0), f"frame {number} of {tag}: the places of one rank, {off:.1e} m off")
    lists = [(runs / f"plate_entry-{name}/fluid.xdmf").read_text() for name in ("one", tag)]
    expect(lists[0] == lists[1], f"{tag}: fluid.xdmf of one rank")


def read_by_others(run_folder):
    """What fluid.xdmf names is there, of the size and type that it names, and joins the parts of all ranks."""
    items = list(xml.etree.ElementTree.parse(run_folder / "fluid.xdmf").iter("DataItem"))
    expect(len(items) > 10, f"fluid.xdmf names {len(items)} arrays")
    for item in items:
        path, _, name = item.text.partition(":")
        path = run_folder / path
        with h5py.File(path) as file:
            array = file[name]
            sizes = tuple(map(int, item.get("Dimensions").split()))
            kind = {"Float": "f", "Int": "i"}[item.get("NumberType")] + item.get("Precision")
            named = array.shape == sizes and array.dtype == np.dtype(kind) and array.is_virtual
            joined = np.concatenate([h5py.File(part)[name] for part in sorted(path.with_suffix("").glob("*.h5"))])
            if not named or not np.array_equal(array, joined):
                expect(False, f"{path}:{name}: {array.shape} {array.dtype}, fluid.xdmf has {sizes} {kind}; the parts' values")


def lost_parts_of_a_frame(cwd):
    run_folder = pathlib.Path(cwd) / "runs/plate_entry-two"
    part = sorted(run_folder.glob("frames/fluid-*/0001.h5"))[-1]
    part.rename(part.with_suffix(".away"))
    done = strake("picture", run_folder, "-o", f"{cwd}/picture.png", cwd=cwd)
    expect(done.returncode == 3 and f"{part} is missing" in done.stderr, "a frame that lacks a part\n" + done.stderr)
    with h5py.File(f"{part.parent}.h5") as file:
        expect(np.isnan(file["position"][()]).any(), "other programs read NaN there")
    part.with_suffix(".away").rename(part)
    done = strake("picture", run_folder, "-o", f"{cwd}/picture.png", cwd=cwd)
    expect(done.returncode == 0, "a picture of a frame in parts\n" + done.stderr)


def lost_parts_of_a_checkpoint(cwd, end):
    for name, harm in (("missing", pathlib.Path.unlink), ("damaged", lambda part: part.write_bytes(part.read_bytes()[:-9]))):
        shutil.copytree(f"{cwd}/runs/plate_entry-half2", f"{cwd}/runs/plate_entry-{name}", symlinks=True)
        parts = list(pathlib.Path(cwd).glob(f"runs/plate_entry-{name}/checkpoint/0*/fluid.0001.h5"))
        expect(len(parts) > 0, "each rank writes its part of a checkpoint")
        for part in parts:
            harm(part)
        done = run(cwd, 2, name, *end, "--resume")
        expect(done.returncode == 3 and "fluid.0001.h5" in done.stderr, f"a part of a checkpoint is {name}\n" + done.stderr)


def a_rank_cannot_write():
    with folder() as cwd:
        process = start("run", CASE, "--set", "fluid.ranks=2", "--set", "output.every=2e-5", *ENTRY, *RIGID, cwd=cwd)
        frames = pathlib.Path(cwd) / "runs/plate_entry/frames"
        wait_until(lambda: (frames / "fluid-000001.h5").exists(), 60)
        (frames / "fluid-000020/0001.h5/taken").mkdir(parents=True)
        _, said = process.communicate(timeout=60)
        expect(process.returncode == 6 and "fluid-000020/0001.h5: cannot be written" in said,
               f"the second rank cannot write: exit {process.returncode}, not 6\n" + said)
        expect((frames / "fluid-000019.h5").exists() and not (frames / "fluid-000020").exists()
               and not (frames / "fluid-000020.h5").exists(), "no half of a frame is left")


def lost_rank(kill, rank, limit):
    with folder() as cwd:
        process = start("run", CASE, "--set", "fluid.ranks=2", *ENTRY, *RIGID, cwd=cwd)
        table = pathlib.Path(cwd) / "runs/plate_entry/history.csv"
        wait_until(lambda: table.exists() and table.read_text().count("\n") > 3, 60)
        lose_rank(process, "strake-fluid-ranks", rank, kill, limit)


def stopped_in_the_start():
    """A rank is stopped before it has met the others in the start of MPI."""
    with folder() as cwd:
        process = start("run", CASE, "--set", "fluid.ranks=2", *ENTRY, *RIGID, cwd=cwd)
        expect(wait_until(lambda: ranks_of(process, "strake-fluid-ranks"), 60), "a rank starts")
        pid = next(iter(ranks_of(process, "strake-fluid-ranks").values()))
        began = time.monotonic()
        os.kill(pid, signal.SIGSTOP)
        _, said = process.communicate(timeout=60)
        seconds = time.monotonic() - began
        expect(process.returncode == 5 and "is stopped" in said, f"stopped in the start: exit {process.returncode}\n{said}")
        expect(seconds < 6, f"the end of a rank that is stopped in the start: {seconds:.1f} s")
        expect(wait_until(lambda: not alive(pid), 5), "the stopped rank is not left")


def suspended_together(first, second):
    """All ranks are stopped for longer than a rank waits for another, as by a batch system, and go on one after the other."""
    with folder() as cwd:
        process = start("run", CASE, "--set", "fluid.ranks=2", *ENTRY, *RIGID, "--set", "end_time=0.0003", cwd=cwd)
        table = pathlib.Path(cwd) / "runs/plate_entry/history.csv"
        wait_until(lambda: table.exists() and table.read_text().count("\n") > 3, 60)
        pids = ranks_of(process, "strake-fluid-ranks")
        for pid in pids.values():
            os.kill(pid, signal.SIGSTOP)
        time.sleep(5)
        for rank in (first, second):
            with contextlib.suppress(ProcessLookupError):  # the other one has killed it
                os.kill(pids[rank], signal.SIGCONT)
            time.sleep(0.6)
        _, said = process.communicate(timeout=60)
        expect(process.returncode == 0, f"all ranks suspended, rank {first} first to go on: exit {process.returncode}\n{said}")


def failing_rank(fault, code, named, not_named, limit):
    """A rank that throws, alone or with all others (faulty_rank.cpp): the run ends, and says which rank and why."""
    with folder() as cwd:
        launcher = pathlib.Path(cwd) / "rank.sh"
        launcher.write_text(f"#!/bin/sh\nshift\nexec {BIN.parent}/tests/faulty_rank \"$@\"\n")
        launcher.chmod(0o755)
        done = run(cwd, 2, "fails", "--set", f"fluid.launcher=mpirun -n {{ranks}} {launcher}", *RIGID,
                   env=dict(ENV, STRAKE_FAULT=fault))
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
    return [functools.partial(failing_rank, *one, 5) for one in (
        ("1:memory:start:3", 5, ["rank 1", "is out of memory"], "rank 0"),
        ("0:memory:start:3", 5, ["rank 0", "is out of memory"], "rank 1"),
        ("1:error:start:3", 5, ["rank 1", "the flow has blown up", "fluid.scheme.cfl"], "rank 0"),
        ("0:bug:start:3", 70, ["rank 0", "a vector is too short"], "rank 1"),
        ("1:error:after:3", 4, ["rank 1", "the flow has blown up"], "exited"),
        ("all:error:start:3", 4, ["the flow has blown up"], "rank "),
        ("1:mpi:start:3", 5, ["rank 1", "invalid count"], "rank 0"),
        ("1:thread:start:3", 5, ["rank 1", "a loop has failed"], "rank 0"),
        ("1:memory:build:", 5, ["rank 1", "is out of memory"], "rank 0"))]


def out_of_memory(rank):
    """A rank that the system gives no more memory."""
    with folder() as cwd:
        process = start("run", CASE, "--set", "fluid.ranks=2", *ENTRY, *RIGID, cwd=cwd)
        table = pathlib.Path(cwd) / "runs/plate_entry/history.csv"
        wait_until(lambda: table.exists() and table.read_text().count("\n") > 3, 60)
        pids = ranks_of(process, "strake-fluid-ranks")
        began = time.monotonic()
        resource.prlimit(pids[rank], resource.RLIMIT_AS, (1 << 20, resource.RLIM_INFINITY))
        _, said = process.communicate(timeout=60)
        seconds = time.monotonic() - began
        expect(process.returncode == 5, f"rank {rank} without memory: exit 5, was {process.returncode}")
        # A library that ignores a refused request is stopped by the system before our code sees the refusal.
        cause = "is out of memory" in said or "exited on signal" in said
        expect(f"rank {rank}" in said and cause, f"the message names rank {rank} and the cause:\n{said}")
        expect(seconds < 5, f"within 5 s: {seconds:.1f} s")
        expect(wait_until(lambda: not any(alive(pid) for pid in pids.values()), 5), "no rank is left")


def crowded():
    """More threads than processors are told, with the key that ends it; without run.threads there are none."""
    with folder() as cwd:
        processors = len(os.sched_getaffinity(0))
        for sets, words in ((["fluid.ranks=2", f"run.threads={processors}"], f"--set run.threads={max(1, processors // 2)}"),
                            (["fluid.ranks=2"], "" if processors >= 2 else "take turns on 1 processor")):
            done = strake("check", CASE, *RIGID, *[word for key in sets for word in ("--set", key)], cwd=cwd)
            found = [line for line in done.stdout.splitlines() if "take turns" in line]
            expect(done.returncode == 0 and (words in found[0] if words else not found), f"check of {sets}: {found}")
            if processors > 1:
                threads = processors if len(sets) > 1 else processors // 2
                expect(f"2 ranks of {threads} thread" in done.stdout, f"check of {sets} says the threads of a rank")
        done = strake("run", CASE, "--set", "fluid.ranks=2", "--set", "end_time=1e-5", "--quiet", *RIGID, cwd=cwd)
        log = (pathlib.Path(cwd) / "runs/plate_entry/fluid.log").read_text()
        each = max(1, processors // 2)
        expect(f"2 of 2 ranks on this machine, {each} thread" in log, "the ranks divide the processors\n" + log)
        record = json.loads((pathlib.Path(cwd) / "runs/plate_entry/run.json").read_text())["participants"]
        expect((record["fluid"]["ranks"], record["fluid"]["threads"]) == (2, each), f"run.json says what each rank takes: {record['fluid']}")
        echo = pathlib.Path(cwd) / "runs/plate_entry/case.toml"
        expect(f"{each} for each of the 2 ranks of fluid" in echo.read_text(), "so does case.toml")
        done = strake("check", echo, cwd=cwd)
        expect(f"2 ranks of {each} thread" in done.stdout, f"a run of case.toml divides again\n{done.stderr}")


def refusals():
    with folder() as cwd:
        for keys, words in ((["fluid.ranks=9"], "at least 1000 water particles"),
                            (["fluid.ranks=2", "fluid.air.layer=true"], "air under a body"),
                            (["fluid.ranks=2", "preset=\"paper\""], "least-squares"),
                            (["fluid.ranks=2", "fluid.launcher=\" \""], "line that starts the ranks"),
                            (["fluid.ranks=0"], "whole number")):
            sets = [word for key in keys for word in ("--set", key)]
            done = strake("check", CASE, "--set", "fluid.spacing=0.0125", *RIGID, *sets, cwd=cwd)
            expect(done.returncode in (2, 3) and words in done.stderr, f"{keys} is refused: {words}\n{done.stderr}")
        done = run(cwd, 2, "none", *RIGID, "--set", "fluid.launcher=/nowhere/mpirun")
        expect(done.returncode == 5 and "cannot be started" in done.stderr, "no launcher\n" + done.stderr)
        done = run(cwd, 2, "nothing", *RIGID, "--set", "fluid.launcher=true")
        expect(done.returncode == 5 and "exited with code 0" in done.stderr and 'fluid.launcher = "true" must' in done.stderr,
               "a launcher that starts nothing\n" + done.stderr)
        done = run(cwd, 2, "few", *RIGID, "--set", "fluid.launcher=mpirun -n 1")
        expect(done.returncode == 5 and "has started 1 ranks, fluid.ranks is 2" in done.stderr,
               "a launcher of fewer ranks\n" + done.stderr)


if not (BIN / "strake-fluid-ranks").exists():
    print("no strake-fluid-ranks: MPI or Zoltan was not there")
    finish()
same_results()
# Each waits for seconds until a rank is missed, two at a time.
side_by_side([a_rank_cannot_write, functools.partial(suspended_together, 0, 1), functools.partial(suspended_together, 1, 0),
              functools.partial(lost_rank, signal.SIGSTOP, 0, 10), functools.partial(lost_rank, signal.SIGKILL, 1, 5),
              stopped_in_the_start, *failures_of_ranks(), *(functools.partial(out_of_memory, one) for one in (0, 1))])
crowded()
refusals()
finish()
