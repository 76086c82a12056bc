"""Runs for tests/benchmark/faults.py, in a folder of their own, with what they leave and disks that are soon full. A run
is `strake run` of two small programs that misbehave on request (tests/system/toy_participant.cpp)."""
import ctypes
import os
import pathlib
import resource
import signal
import subprocess
import threading
import time

import runs

LIBC = ctypes.CDLL(None, use_errno=True)
CASE = """title = "two toys"
end_time = 0.04
[fluid]
solver = "{toy}"
[structure]
solver = "{toy}"
[coupling.surface]
window = 1e-3
[coupling]
frozen_after = 2.0
start_within = 1.5
[run]
checkpoint_windows = 5
"""


def processes(word):
    """pid → state of every process whose command line or environment contains `word`, and of zombies of ours."""
    found = {}
    for entry in pathlib.Path("/proc").iterdir():
        if not entry.name.isdigit() or int(entry.name) == os.getpid():
            continue
        try:
            stat = (entry / "stat").read_text().rsplit(")", 1)[1].split()
            known = word in (entry / "cmdline").read_bytes().decode(errors="replace")
        except OSError:
            continue
        if known or (stat[0] == "Z" and int(stat[1]) == os.getpid()):
            found[int(entry.name)] = stat[0]
    return found


class Run:
    """`strake run` of the toys, or of a case; its messages with the times at which they came."""

    def __init__(self, place, *words, sets=(), toy="", case=None, limit=None, start=True):
        self.place, self.words, self.case = place, words, case or place.case
        self.folder = place.path / "runs" / self.case.stem
        self.sets, self.toy, self.limit = sets, toy, limit
        self.lines, self.notes = [], []  # (monotonic time, text) of standard error and of standard output
        self.wrong = []  # what is known to be so before the run has ended
        if start:
            self.start()

    def start(self, *more):
        words = [str(self.place.program), "run", str(self.case), *self.words, *more]
        for pair in self.sets:
            words += ["--set", pair]
        environment = dict(runs.ENVIRONMENT | dict(os.environ), NO_COLOR="1", XDG_RUNTIME_DIR=str(self.place.sockets))
        environment.pop("STRAKE_TOY", None)
        if self.toy:
            environment["STRAKE_TOY"] = self.toy
        limit = self.limit
        self.process = subprocess.Popen(
            words, cwd=self.place.path, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
            preexec_fn=(lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))) if limit else None)
        self.readers = [threading.Thread(target=self.read, args=pair)
                        for pair in ((self.process.stderr, self.lines), (self.process.stdout, self.notes))]
        for reader in self.readers:
            reader.start()

    @staticmethod
    def read(stream, lines):
        for line in stream:
            lines.append((time.monotonic(), line.rstrip()))

    def wait_for(self, what, seconds=60):
        end = time.monotonic() + seconds
        while not what() and time.monotonic() < end and self.process.poll() is None:
            time.sleep(0.005)

    def log(self, name):
        try:
            return (self.folder / f"{name}.log").read_text()
        except OSError:
            return ""

    def pid(self, name):
        return self.process.pid if name == "strake" else int(self.log(name).split("process ", 1)[1].split(",")[0])

    def rows(self):
        try:
            return (self.folder / "history.csv").read_bytes().count(b"\n") - 1
        except OSError:
            return 0

    def end(self, seconds=60):
        try:
            self.process.wait(seconds)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
            self.lines.append((time.monotonic(), "HANGS"))
        for reader in self.readers:
            reader.join()
        return self.process.returncode

    def fault_time(self):
        """Time at which a toy carried out its fault."""
        times = [float(line.split()[-1]) for name in ("fluid", "structure") for line in self.log(name).splitlines()
                 if "fault at " in line]
        return min(times, default=None)

    def history(self):
        return [(self.folder / name).read_bytes() for name in ("history.csv", "iterations.csv")]


class Place:
    def __init__(self, options, path):
        self.path, self.program = path, options.bin_dir.resolve() / "strake"
        self.sockets = path / "sockets"
        self.sockets.mkdir(mode=0o700)
        self.case = path / "toys.toml"
        self.toy = options.toys.resolve() / "toy_participant"
        self.case.write_text(CASE.format(toy=self.toy))

    def left(self):
        """What the run left behind, after the second that the participants of a killed coupler may take."""
        end = time.monotonic() + 1
        while True:
            while True:  # orphans come to this process
                try:
                    if os.waitpid(-1, os.WNOHANG)[0] == 0:
                        break
                except ChildProcessError:
                    break
            still = processes(str(self.path))
            left = [f"process {pid} ({state})" for pid, state in still.items()]
            left += [f"socket {path.name}" for path in self.sockets.iterdir()]
            if not left or time.monotonic() > end:
                for pid in still:
                    os.kill(pid, signal.SIGKILL)
                return ", ".join(left)
            time.sleep(0.02)


def adopt_orphans():
    """What a killed coupler leaves comes to this process and can be counted."""
    LIBC.prctl(36, 1, 0, 0, 0)  # PR_SET_CHILD_SUBREAPER


def may_mount():
    """Leaves the name space of mounts of everybody else, where that is allowed."""
    new_mounts, private = 0x00020000, 0x00044000  # CLONE_NEWNS; MS_REC | MS_PRIVATE
    return LIBC.unshare(new_mounts) == 0 and LIBC.mount(b"none", b"/", None, private, None) == 0


def mount(folder, size, again=0):
    if LIBC.mount(b"tmpfs", str(folder).encode(), b"tmpfs", again, f"size={size}".encode()) != 0:
        raise SystemExit(f"no tmpfs at {folder}: {os.strerror(ctypes.get_errno())}")


def make_room(folder):
    mount(folder, "1g", again=32)  # MS_REMOUNT


def unmount(folder):
    LIBC.umount(str(folder).encode())
