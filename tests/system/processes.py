"""Runs of the real programs for the system tests: start, find the processes, kill, wait, read what is left."""
import concurrent.futures
import csv
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(sys.argv[1])
BIN = pathlib.Path(sys.argv[2])
ENV = dict(os.environ, NO_COLOR="1", OMP_NUM_THREADS="1")
failures = []


def expect(condition, what):
    print(("ok    " if condition else "FAIL  ") + what, flush=True)
    if not condition:
        failures.append(what)


def finish():
    print(f"{len(failures)} failed")
    sys.exit(bool(failures))


def folder():
    return tempfile.TemporaryDirectory(prefix="strake-test-")


def strake(*words, cwd, timeout=120, env=ENV):
    return subprocess.run([str(BIN / "strake"), *map(str, words)], cwd=cwd, env=env, capture_output=True, text=True,
                          timeout=timeout)


def side_by_side(tasks, most=2):
    """Calls functions without operands, `most` at a time: for runs that wait more than they compute."""
    with concurrent.futures.ThreadPoolExecutor(most) as pool:
        for done in [pool.submit(task) for task in tasks]:
            done.result()


def run_case(place, case, *words, code=0):
    done = strake("run", case, "--runs", place / "runs", *words, cwd=place)
    if done.returncode != code:
        print(done.stdout[-3000:], done.stderr[-3000:])
    expect(done.returncode == code, f"{case} {' '.join(map(str, words))}: exit {done.returncode}, expected {code}")
    return done


def columns(run):
    """Title → numbers of each column of a run's record; an empty cell is not a number."""
    with open(run / "history.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    return {title: [float(row[title] or "nan") for row in rows] for title in rows[0]}


def start(*words, cwd):
    return subprocess.Popen([str(BIN / "strake"), *map(str, words)], cwd=cwd, env=ENV, stdout=subprocess.PIPE,
                            stderr=subprocess.PIPE, text=True)


def child_processes(pid):
    """The pid and the words of the command line of each child of `pid`."""
    for entry in pathlib.Path("/proc").iterdir():
        if not entry.name.isdigit():
            continue
        try:
            fields = (entry / "stat").read_text().rsplit(")", 1)[1].split()
            words = (entry / "cmdline").read_bytes().decode().split("\0")
        except (OSError, IndexError):
            continue
        if int(fields[1]) == pid and fields[0] != "Z":
            yield int(entry.name), words


def children(pid):
    """Process name → pid of the children of `pid`."""
    return {pathlib.Path(words[0]).name: child for child, words in child_processes(pid)}


def ranks_of(process, program):
    """Rank → pid of the ranks of a program that a run has started."""
    found = {}
    for entry in pathlib.Path("/proc").iterdir():
        if not entry.name.isdigit():
            continue
        try:
            words = (entry / "environ").read_bytes().split(b"\0")
            name = (entry / "cmdline").read_bytes().split(b"\0")[0]
        except OSError:
            continue
        if name.endswith(program.encode()) and f"STRAKE_COUPLER={process.pid}".encode() in words:
            for word in words:
                if word.startswith(b"OMPI_COMM_WORLD_RANK="):
                    found[int(word.split(b"=")[1])] = int(entry.name)
    return found


def alive(pid):
    try:
        return (pathlib.Path("/proc") / str(pid) / "stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False


def wait_until(condition, seconds, step=0.02):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if condition():
            return True
        time.sleep(step)
    return condition()


def lose_rank(process, program, rank, kill, limit):
    """Sends a signal to one of two ranks: the run ends within `limit` seconds, names it, and leaves none."""
    pids = ranks_of(process, program)
    expect(sorted(pids) == [0, 1], f"two ranks: {pids}")
    began = time.monotonic()
    os.kill(pids[rank], kill)
    _, said = process.communicate(timeout=60)
    seconds = time.monotonic() - began
    expect(process.returncode == 5, f"exit 5, was {process.returncode}")
    expect(f"rank {rank} " in said, f"the message names rank {rank}:\n{said}")
    print(f"      {signal.Signals(kill).name} of rank {rank}: {seconds:.1f} s")
    expect(seconds < limit, "within the limit")
    expect(wait_until(lambda: not any(alive(pid) for pid in pids.values()), 5), "no rank is left")


def rows(run):
    path = run / "history.csv"
    return max(0, path.read_text().count("\n") - 1) if path.exists() else 0


def end(process):
    if process.poll() is None:
        for pid in children(process.pid).values():
            os.kill(pid, signal.SIGKILL)
        process.kill()
    process.wait()
