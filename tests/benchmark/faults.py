"""What goes wrong on purpose, and what a run makes of it: time to the message, the message, the exit code, whether the run
can be resumed to the very result of one that nothing befell, and what is left behind (processes, zombies, sockets).

Two small programs that misbehave on request (tests/system/toy_participant.cpp) are coupled by the real `strake run`,
explicit and implicit, serial and parallel. A dead participant must be named within a second, a frozen one after
coupling.frozen_after (2 s here). Disk full is a small tmpfs where mounting is allowed, else a limit on the size of files;
the table says which. Exits 1 when an exit code, a resume, a text, or what is left is not as it should be.

    tests/benchmark/faults.py [BIN_DIR] [--toys DIR] [--scheme NAME]... [--only WORD] [--texts FILE]

With --texts what the run says is held against the block of that name in FILE; STRAKE_WRITE_TEXTS=1 writes the blocks anew.
"""
import ctypes
import os
import pathlib
import re
import resource
import signal
import socket
import subprocess
import tempfile
import threading
import time

import runs

LIBC = ctypes.CDLL(None, use_errno=True)
ONE = "coupling.surface.converged.max_iterations=1"
PARALLEL = "coupling.surface.scheme=parallel"
SCHEMES = {"serial explicit": [ONE], "serial implicit": [], "parallel explicit": [PARALLEL, ONE], "parallel implicit": [PARALLEL]}
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
AT = 12  # the window in which it happens; the checkpoint before it is of window 10


def processes(word):
    """pid → state of every process whose command line or environment holds `word`, and of zombies of ours."""
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
        """When a toy did what it was asked to do."""
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


# ---- what happens: each returns the Run and the time from which its message is awaited (None: the toy says it)

def strike_inside(name, number):
    """A signal to one process while the structure is inside a step that lasts a minute."""
    def act(place, sets):
        run = Run(place, sets=sets, toy=f"structure:sleep:{AT}")
        run.wait_for(lambda: "step begins" in run.log("structure"))
        pid, struck = run.pid(name), time.monotonic()
        os.kill(pid, number)
        return run, struck
    return act


def strike_idle_partner(place, sets):
    run = Run(place, sets=sets, toy=f"structure:sleep:{AT}")
    run.wait_for(lambda: "step begins" in run.log("structure"))
    pid, struck = run.pid("fluid"), time.monotonic()
    os.kill(pid, signal.SIGKILL)
    return run, struck


def toy(kind, name="structure", at=AT):
    return lambda place, sets: (Run(place, sets=sets, toy=f"{name}:{kind}:{at}"), None)


def during_setup(number):
    def act(place, sets):
        run = Run(place, sets=sets, toy="structure:mute:1")
        run.wait_for(lambda: "fault at" in run.log("structure"))
        time.sleep(0.1)
        struck = time.monotonic()
        os.kill(run.process.pid, number)
        return run, struck
    return act


def between_windows(number):
    def act(place, sets):
        run = Run(place, sets=sets, toy="structure:slow:0")
        run.wait_for(lambda: run.rows() >= AT)
        struck = time.monotonic()
        os.kill(run.process.pid, number)
        return run, struck
    return act


def suspended_for_a_while(name):
    def act(place, sets):
        run = Run(place, sets=sets, toy=f"structure:nap:{AT}")
        run.wait_for(lambda: "step begins" in run.log("structure"))
        pid, struck = run.pid(name), time.monotonic()
        os.kill(pid, signal.SIGSTOP)
        time.sleep(1.7)
        os.kill(pid, signal.SIGCONT)
        return run, struck
    return act


def stranger(place, sets):
    """Noise on the socket of a run that is under way, and one who knows the protocol but not the token."""
    run = Run(place, sets=sets, toy=f"structure:nap:{AT}")
    run.wait_for(lambda: "step begins" in run.log("structure"))
    hub = next(place.sockets.glob("strake-*/*"))
    for noise in (b"GET / HTTP/1.1\r\n\r\n", bytes(64), b"\xff" * 4096):
        with socket.socket(socket.AF_UNIX) as line:
            line.connect(str(hub))
            line.sendall(noise)
    words = ["--connect", f"ipc://{hub}", "--name", "structure", "--fault", "token"]
    subprocess.run([str(place.toy), *words], env=dict(os.environ, STRAKE_TOKEN="00" * 16), timeout=10, stderr=subprocess.DEVNULL)
    return run, time.monotonic()


def second_run_in_the_folder(place, sets):
    run = Run(place, sets=sets, toy=f"structure:nap:{AT}")
    run.wait_for(lambda: "step begins" in run.log("structure"))
    struck = time.monotonic()
    other = Run(place, "--resume", sets=sets)
    other_code = other.end()
    run.lines.extend(other.lines)
    run.expected_other = other_code == 2
    return run, struck


def stale_files(place, sets):
    """What a killed run may leave: an unfinished file, an unfinished checkpoint, a row cut short; then --resume."""
    run, _ = strike_inside("strake", signal.SIGKILL)(place, sets)
    run.end()
    place.left()
    (run.folder / "summary.json.part").write_text("{")
    (run.folder / "checkpoint" / "000011").mkdir()
    (run.folder / "checkpoint" / "latest.new").symlink_to("000011")
    with (run.folder / "history.csv").open("a") as file:
        file.write("12,0.01")
    run.toy = ""
    struck = time.monotonic()
    run.start("--resume")
    return run, struck


def damaged_checkpoint(place, sets):
    """The latest checkpoint is cut short: the one before it is taken, and that is said."""
    run, _ = strike_inside("strake", signal.SIGKILL)(place, sets)
    run.end()
    place.left()
    file = run.folder / "checkpoint" / "latest" / "coupler.h5"
    file.write_bytes(file.read_bytes()[:1000])
    run.toy = ""
    struck = time.monotonic()
    run.start("--resume")
    return run, struck


def stale_socket(place, sets):
    path = place.sockets / "hub"
    with socket.socket(socket.AF_UNIX) as old:
        old.bind(str(path))  # closed, and not removed
    run = Run(place, sets=[*sets, f"coupling.endpoint=ipc://{path}"])
    return run, time.monotonic()


# ---- a full disk: a small tmpfs in a name space of this process, or a limit on the size of files

def may_mount():
    """Leaves the name space of mounts of everybody else, where that is allowed."""
    new_mounts, private = 0x00020000, 0x00044000  # CLONE_NEWNS; MS_REC | MS_PRIVATE
    return LIBC.unshare(new_mounts) == 0 and LIBC.mount(b"none", b"/", None, private, None) == 0


def mount(folder, size, again=0):
    if LIBC.mount(b"tmpfs", str(folder).encode(), b"tmpfs", again, f"size={size}".encode()) != 0:
        raise SystemExit(f"no tmpfs at {folder}: {os.strerror(ctypes.get_errno())}")


PLATE = runs.ROOT / "cases" / "plate_entry.toml"
QUICK_PLATE = ["structure.solver=rigid", "fluid.spacing=0.02", "structure.plate.bottom=[0,0.024,0]", "end_time=4e-4",
               "output.probe[0].at=[0,0.024,0]",
               "output.probe[1].at=[0,0.024,0]", "run.checkpoint_windows=4", "output.every=5e-5"]
FULL = [  # name, case, sets, bytes of the disk, largest file
    ("disk full, two toys", None, ["end_time=0.4"], "200k", 20_000),
    ("disk full, plate and water", PLATE, QUICK_PLATE, "2m", 200_000),
    ("disk full at the first frame", PLATE, [*QUICK_PLATE, "output.every=1e-5"], "300k", 30_000),
]


def full_disk(options, sets, mounts):
    """The rows of FULL: name, run, place, the untouched history."""
    for name, case, more, size, largest in FULL:
        if options.only not in name:
            continue
        for limited in ([False, True] if mounts else [True]):
            with tempfile.TemporaryDirectory(prefix="strake-faults-") as folder:
                place = Place(options, pathlib.Path(folder))
                whole = Run(place, "--runs", "reference", sets=[*sets, *more], case=case)
                whole.folder = place.path / "reference" / whole.case.stem
                if whole.end() != 0:
                    raise SystemExit(f"{name}: the untouched run fails\n" + "\n".join(line for _, line in whole.lines))
                disk = place.path / "runs"
                disk.mkdir()
                if not limited:
                    mount(disk, size)
                run = Run(place, sets=[*sets, *more], case=case, limit=largest if limited else None)
                run.process.wait()
                time.sleep(0.05)
                if not limited:
                    mount(disk, "1g", again=32)  # MS_REMOUNT: room again
                yield f"{name} ({'file-size limit' if limited else 'tmpfs of ' + size})", run, place, whole.history()
                if not limited:
                    LIBC.umount(str(disk).encode())


DEAD = 1.0  # s
BY_CHANCE = {"answers twice", "Ctrl-C between windows", "SIGTERM between windows"}  # where in a run these fall
NOTES = ("refused", "is back", "going on from", "suspended", "cannot be used")
FAULTS = [  # name, what happens, exit code, resumable (None: there is nothing to resume), seconds to the message at most
    ("kill -9 structure in a step", strike_inside("structure", signal.SIGKILL), 5, True, DEAD),
    ("kill -9 fluid, structure in a step", strike_idle_partner, 5, True, DEAD),
    ("kill -9 strake", strike_inside("strake", signal.SIGKILL), -9, True, None),
    ("SIGSTOP structure in a step", strike_inside("structure", signal.SIGSTOP), 5, True, 3.0),
    ("SIGSTOP fluid, structure in a step", strike_inside("fluid", signal.SIGSTOP), 5, True, 3.0),
    ("structure suspended for 1.7 s", suspended_for_a_while("structure"), 0, None, None),
    ("strake suspended for 1.7 s", suspended_for_a_while("strake"), 0, None, None),
    ("SIGTERM to structure in a step", strike_inside("structure", signal.SIGTERM), 5, True, DEAD),
    ("never says Hello", toy("mute"), 5, None, 2.5),
    ("ends before Hello", toy("early"), 3, None, None),
    ("wrong token", toy("token"), 5, None, DEAD),
    ("another case's hash", toy("hash"), 5, None, DEAD),
    ("another protocol", toy("protocol"), 5, None, DEAD),
    ("noise and a stranger on the socket", stranger, 0, None, None),
    ("answers twice", toy("twice"), 5, True, DEAD),
    ("answers an older request", toy("stale"), 5, True, DEAD),
    ("answers with another message", toy("kind"), 5, True, DEAD),
    ("answers with noise", toy("garbage"), 5, True, DEAD),
    ("a field of wrong size", toy("size"), 5, True, DEAD),
    ("a frame cut short", toy("short"), 5, True, DEAD),
    ("NaN from the structure", toy("nan"), 4, True, DEAD),
    ("NaN from the fluid", toy("nan", "fluid"), 4, True, DEAD),
    ("NaN that the sender lets pass", toy("raw-nan"), 4, True, DEAD),
    ("a solver's own error", toy("error"), 4, True, DEAD),
    ("crash in a step", toy("crash"), 5, True, DEAD),
    ("exit in a step", toy("exit", "fluid"), 5, True, DEAD),
    ("Ctrl-C in set-up", during_setup(signal.SIGINT), 130, None, DEAD),
    ("SIGTERM in set-up", during_setup(signal.SIGTERM), 143, None, DEAD),
    ("Ctrl-C between windows", between_windows(signal.SIGINT), 130, True, DEAD),
    ("SIGTERM between windows", between_windows(signal.SIGTERM), 143, True, DEAD),
    ("Ctrl-C in a step of a minute", strike_inside("strake", signal.SIGINT), 130, True, 6.0),
    ("SIGTERM in a step of a minute", strike_inside("strake", signal.SIGTERM), 143, True, 6.0),
    ("a second run in the folder", second_run_in_the_folder, 0, None, None),
    ("stale files of a killed run", stale_files, 0, None, None),
    ("a damaged checkpoint", damaged_checkpoint, 0, None, None),
    ("a stale socket at the endpoint", stale_socket, 0, None, None),
]


def judge(name, run, place, since, code, resumable, most, whole, texts):
    """One row: what was measured, and what is wrong with it."""
    got = run.end()
    wrong = texts.wrong(name, run, place)
    wrong += [] if got == code else [f"exit {got}, expected {code}"]
    left = place.left()
    if left:
        wrong.append("left: " + left)
    if since is None:
        since = run.fault_time()
    # An error is on standard error; a run that goes on says what it met on standard output.
    said = run.lines or [(when, line) for when, line in run.notes if any(word in line for word in NOTES)]
    message = said[0] if said else None
    delay = message[0] - since if run.lines and since else None
    if most is not None and (delay is None or delay > most):
        wrong.append("no message" if delay is None else f"{delay:.2f} s to the message, expected at most {most:g}")
    way_on = "-"
    if resumable is not None:
        run.toy, run.limit = "", None
        run.lines, run.notes = [], []
        run.start("--resume")
        again = run.end()
        equal = again == 0 and run.history() == whole
        way_on = "yes, bit-equal" if equal else f"NO: exit {again}" + (f", {run.lines[0][1]}" if run.lines else "")
        if equal != resumable:
            wrong.append("resume: " + way_on)
        if place.left():
            wrong.append("the resumed run left something")
    elif code == 0 and run.history() != whole:
        wrong.append("its history is not that of an untouched run")
    return delay, message[1] if message else "", got, way_on, left or "nothing", wrong


class Texts:
    """A file of blocks `==== name` and a text, without what differs from one run to the next."""

    def __init__(self, path):
        self.path = path
        self.writes = bool(os.environ.get("STRAKE_WRITE_TEXTS"))
        head, *blocks = (path.read_text() if path else "").split("==== ")
        self.head, self.block = head, dict(block.split("\n", 1) for block in blocks)

    def wrong(self, name, run, place):
        """What is wrong with the text of an error, if anything."""
        if not self.path or name in BY_CHANCE or "tmpfs" in name or not run.lines:
            return []
        text = "".join(line + "\n" for _, line in run.lines).replace(str(place.path), "PLACE").replace(str(place.toy), "TOY")
        for pattern, word in ((r"process \d+", "process PID"), (r"\[20\d\d-[^]]*\]", "[TIME]"), (r"(for|after) [\d.e+-]+ s", r"\1 N s"),
                              (r"strake-\w{6}", "strake-XXXXXX")):
            text = re.sub(pattern, word, text)
        if self.writes:
            self.block[name] = text
            self.path.write_text(self.head + "".join(f"==== {key}\n{self.block[key]}" for key in sorted(self.block)))
        return [] if self.block.get(name) == text else [f"another text than {self.path.name} holds:\n{text}"]


class Table:
    """Prints rows as they come, and counts what is wrong."""

    def __init__(self, scheme):
        self.failed = 0
        print(f"{scheme}\n{'what happens':47} {'message after':>13} {'exit':>5}  {'resumable':16} {'left':10} message", flush=True)

    def row(self, name, place, code, judged):
        delay, message, got, way_on, left, wrong = judged
        after = "-" if delay is None or code in (0, -9) else f"{delay:.2f} s"
        print(f"{name:47} {after:>13} {got:>5}  {way_on:16} {left:10} {message.replace(str(place.path), '')[:150]}", flush=True)
        for what in wrong:
            print(f"    WRONG: {what}", flush=True)
        self.failed += bool(wrong)


def main():
    parser = runs.command(__doc__)
    parser.add_argument("--toys", type=pathlib.Path, help="folder of toy_participant, default BIN_DIR/../tests")
    parser.add_argument("--scheme", action="append", choices=list(SCHEMES))
    parser.add_argument("--only", default="", help="faults whose name holds this word")
    parser.add_argument("--texts", type=pathlib.Path, metavar="FILE", help="what the runs must say")
    options = parser.parse_args()
    texts = Texts(options.texts)
    options.toys = options.toys or options.bin_dir / ".." / "tests"
    LIBC.prctl(36, 1, 0, 0, 0)  # PR_SET_CHILD_SUBREAPER: what a killed coupler leaves comes here and can be counted
    mounts = may_mount()
    if not mounts:
        print("mounting is not allowed here: a full disk is a limit on the size of files")
    failed = 0
    for scheme in options.scheme or SCHEMES:
        sets = [*SCHEMES[scheme], *options.set]
        table = Table(scheme)
        with tempfile.TemporaryDirectory(prefix="strake-faults-") as folder:
            place = Place(options, pathlib.Path(folder))
            reference = Run(place, "--runs", "reference", sets=sets)
            reference.folder = place.path / "reference" / "toys"
            if reference.end() != 0:
                raise SystemExit("the toys do not run: " + "\n".join(line for _, line in reference.lines))
            whole = reference.history()
        for name, act, code, resumable, most in FAULTS:
            if options.only not in name:
                continue
            with tempfile.TemporaryDirectory(prefix="strake-faults-") as folder:
                place = Place(options, pathlib.Path(folder))
                run, since = act(place, sets)
                table.row(name, place, code, judge(name, run, place, since, code, resumable, most, whole, texts))
        for name, run, place, untouched in full_disk(options, sets, mounts):
            # Where not even the first checkpoint found room there is nothing to resume.
            resumable = True if (run.folder / "checkpoint" / "latest").exists() else None
            table.row(name, place, 6, judge(name, run, place, None, 6, resumable, None, untouched, texts))
        failed += table.failed
    print(f"{failed} wrong")
    raise SystemExit(bool(failed))


if __name__ == "__main__":
    main()
