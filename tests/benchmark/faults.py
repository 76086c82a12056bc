"""Injects faults into runs, and checks how they end. For each fault the table has the time to the message, the message,
the exit code, and what is left behind (processes, zombies, sockets). It also says whether a resumed run has exactly the
result of an undisturbed one.

Two small programs that misbehave on request (tests/system/toy_participant.cpp) are coupled by the real `strake run`,
explicit and implicit, serial and parallel. A dead participant must be named within a second, a frozen one after
coupling.frozen_after (2 s here). Disk full is a small tmpfs where mounting is allowed, else a limit on the size of files;
the table says which. Exits 1 when an exit code, a resume, a text, or what is left is not as it should be.

    tests/benchmark/faults.py [BIN_DIR] [--toys DIR] [--scheme NAME]... [--only WORD] [--texts FILE] [--at-once N]

With --texts the output of the run is compared with the block of that name in FILE; STRAKE_WRITE_TEXTS=1 writes the
blocks anew.
"""
import concurrent.futures
import os
import pathlib
import re
import signal
import socket
import subprocess
import tempfile
import time

import runs
from faulty_runs import Place, Run, adopt_orphans, make_room, may_mount, mount, unmount

ONE = "coupling.surface.converged.max_iterations=1"
PARALLEL = "coupling.surface.scheme=parallel"
SCHEMES = {"serial explicit": [ONE], "serial implicit": [], "parallel explicit": [PARALLEL, ONE], "parallel implicit": [PARALLEL]}
AT = 12  # the window in which it happens; the checkpoint before it is of window 10


# ---- what happens: each returns the Run and the time from which its message is awaited (None: the toy says it)

def in_its_step(run):
    return "step begins" in run.log("structure")


def awaited_in_vain(run):
    waits = "fault at" in run.log("structure")
    if waits:
        time.sleep(0.1)
    return waits


def strike(name, number, toy=f"structure:sleep:{AT}", when=in_its_step):
    """Sends a signal to one process as soon as `when` is true for the run. Without `when`, sends it while the structure is inside a
    step of a minute."""
    def act(place, sets):
        run = Run(place, sets=sets, toy=toy)
        run.wait_for(lambda: when(run))
        pid, struck = run.pid(name), time.monotonic()
        os.kill(pid, number)
        return run, struck
    return act


def in_set_up(number):
    return strike("strake", number, "structure:mute:1", awaited_in_vain)


def between_windows(number):
    return strike("strake", number, "structure:slow:0", lambda run: run.rows() >= AT)


def toy(kind, name="structure", at=AT):
    return lambda place, sets: (Run(place, sets=sets, toy=f"{name}:{kind}:{at}"), None)


def napping(place, sets):
    """A run whose structure is inside a step that lasts a few seconds, and when that was seen."""
    run = Run(place, sets=sets, toy=f"structure:nap:{AT}")
    run.wait_for(lambda: in_its_step(run))
    return run, time.monotonic()


def suspended_for_a_while(name):
    def act(place, sets):
        run, struck = napping(place, sets)
        pid = run.pid(name)
        os.kill(pid, signal.SIGSTOP)
        time.sleep(1.7)
        os.kill(pid, signal.SIGCONT)
        return run, struck
    return act


def stranger(place, sets):
    """Sends noise to the socket of a run under way. Then connects a client that has the protocol but not the token."""
    run, _ = napping(place, sets)
    hub = next(place.sockets.glob("strake-*/*"))
    for noise in (b"GET / HTTP/1.1\r\n\r\n", bytes(64), b"\xff" * 4096):
        with socket.socket(socket.AF_UNIX) as line:
            line.connect(str(hub))
            line.sendall(noise)
    words = ["--connect", f"ipc://{hub}", "--name", "structure", "--fault", "token"]
    subprocess.run([str(place.toy), *words], env=dict(os.environ, STRAKE_TOKEN="00" * 16), timeout=10, stderr=subprocess.DEVNULL)
    return run, time.monotonic()


def second_run_in_the_folder(place, sets):
    run, struck = napping(place, sets)
    other = Run(place, "--resume", sets=sets)
    other_code = other.end()
    run.lines.extend(other.lines)
    run.wrong += [] if other_code == 2 else [f"the second run: exit {other_code}, expected 2"]
    return run, struck


def killed_then_resumed(spoil):
    """`strake` is killed, something befalls what it has written, and the run is resumed."""
    def act(place, sets):
        run, _ = strike("strake", signal.SIGKILL)(place, sets)
        run.end()
        place.left()
        spoil(run.folder)
        run.toy = ""
        struck = time.monotonic()
        run.start("--resume")
        return run, struck
    return act


def stale_files(folder):
    """What a killed run may leave: an unfinished file, an unfinished checkpoint, a line cut short."""
    (folder / "summary.json.part").write_text("{")
    (folder / "checkpoint" / "000011").mkdir()
    (folder / "checkpoint" / "latest.new").symlink_to("000011")
    with (folder / "history.csv").open("a") as file:
        file.write("12,0.01")


def damaged_checkpoint(folder):
    """The latest checkpoint is cut short: the one before it is taken, and that is said."""
    file = folder / "checkpoint" / "latest" / "coupler.h5"
    file.write_bytes(file.read_bytes()[:1000])


def stale_socket(place, sets):
    """A killed run leaves its socket at an endpoint of the user's; the next run there replaces that one alone."""
    path, there = place.sockets / "hub", []
    kill = killed_then_resumed(lambda folder: there.append(path.is_socket()))
    run, struck = kill(place, [*sets, f"coupling.endpoint=ipc://{path}"])
    run.wrong += [] if there == [True] else ["the killed run left no socket"]
    return run, struck


# ---- a full disk: a small tmpfs in a name space of this process, or a limit on file sizes

PLATE = runs.ROOT / "cases" / "plate_entry.toml"
QUICK_PLATE = ["structure.solver=rigid", "fluid.spacing=0.02", "structure.plate.bottom=[0,0.024,0]", "end_time=4e-4",
               "output.probe[0].at=[0,0.024,0]",
               "output.probe[1].at=[0,0.024,0]", "run.checkpoint_windows=4", "output.every=5e-5"]
FULL = [  # name, case, sets, bytes of the disk, largest file
    ("disk full, two toys", None, ["end_time=0.4"], "200k", 20_000),
    ("disk full, plate and water", PLATE, QUICK_PLATE, "2m", 340_000),
    ("disk full at the first frame", PLATE, [*QUICK_PLATE, "output.every=1e-5"], "300k", 30_000),
]


def full_disk(options, sets, texts, full, limited):
    """One line of FULL, with a limit on the size of files or on a small disk."""
    name, case, more, size, largest = full
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
            make_room(disk)
        name = f"{name} ({'file-size limit' if limited else 'tmpfs of ' + size})"
        # Where not even the first checkpoint found room there is nothing to resume.
        resumable = True if (run.folder / "checkpoint" / "latest").exists() else None
        judged = judge(name, run, place, None, 6, resumable, None, whole.history(), texts)
        if not limited:
            unmount(disk)
    return name, place.path, 6, judged


DEAD = 1.0  # s
BY_CHANCE = {"answers twice", "Ctrl-C between windows", "SIGTERM between windows"}  # where in a run these fall
NOTES = ("refused", "is back", "going on from", "suspended", "cannot be used")
FAULTS = [  # name, what happens, exit code, resumable (None: there is nothing to resume), seconds to the message at most
    ("kill -9 structure in a step", strike("structure", signal.SIGKILL), 5, True, DEAD),
    ("kill -9 fluid, structure in a step", strike("fluid", signal.SIGKILL), 5, True, DEAD),
    ("kill -9 strake", strike("strake", signal.SIGKILL), -9, True, None),
    ("SIGSTOP structure in a step", strike("structure", signal.SIGSTOP), 5, True, 3.0),
    ("SIGSTOP fluid, structure in a step", strike("fluid", signal.SIGSTOP), 5, True, 3.0),
    ("structure suspended for 1.7 s", suspended_for_a_while("structure"), 0, None, None),
    ("strake suspended for 1.7 s", suspended_for_a_while("strake"), 0, None, None),
    ("SIGTERM to structure in a step", strike("structure", signal.SIGTERM), 5, True, DEAD),
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
    ("Ctrl-C in set-up", in_set_up(signal.SIGINT), 130, None, DEAD),
    ("SIGTERM in set-up", in_set_up(signal.SIGTERM), 143, None, DEAD),
    ("Ctrl-C between windows", between_windows(signal.SIGINT), 130, True, DEAD),
    ("SIGTERM between windows", between_windows(signal.SIGTERM), 143, True, DEAD),
    ("Ctrl-C in a step of a minute", strike("strake", signal.SIGINT), 130, True, 6.0),
    ("SIGTERM in a step of a minute", strike("strake", signal.SIGTERM), 143, True, 6.0),
    ("a second run in the folder", second_run_in_the_folder, 0, None, None),
    ("stale files of a killed run", killed_then_resumed(stale_files), 0, None, None),
    ("a damaged checkpoint", killed_then_resumed(damaged_checkpoint), 0, None, None),
    ("a stale socket at the endpoint", stale_socket, 0, None, None),
]


def judge(name, run, place, since, code, resumable, most, whole, texts):
    """One line of the table: what was measured, and what is wrong with it."""
    got = run.end()
    wrong = run.wrong + texts.wrong(name, run, place)
    wrong += [] if got == code else [f"exit {got}, expected {code}"]
    left = place.left()
    if left:
        wrong.append("left: " + left)
    if since is None:
        since = run.fault_time()
    # An error is on standard error; a run that continues reports a fault on standard output.
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
        for side in ("fluid", "structure"):
            before, resumed, after = run.log(side).partition("[info] resumed at window ")
            if resumable and run.case == place.case and not ("commit 1 " in before and "commit " in after):
                wrong.append(f"{side}.log does not go on behind what it held")
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
                              (r"strake-\w{6}", "strake-XXXXXX"), (r"lost: .*", "lost: N windows")):
            text = re.sub(pattern, word, text)
        if self.writes:
            self.block[name] = text
            self.path.write_text(self.head + "".join(f"==== {key}\n{self.block[key]}" for key in sorted(self.block)))
        return [] if self.block.get(name) == text else [f"another text than {self.path.name} holds:\n{text}"]


class Table:
    """Prints lines as they come, and counts what is wrong."""

    def __init__(self, scheme):
        self.failed = 0
        print(f"{scheme}\n{'what happens':47} {'message after':>13} {'exit':>5}  {'resumable':16} {'left':10} message", flush=True)

    def row(self, name, path, code, judged):
        delay, message, got, way_on, left, wrong = judged
        after = "-" if delay is None or code in (0, -9) else f"{delay:.2f} s"
        print(f"{name:47} {after:>13} {got:>5}  {way_on:16} {left:10} {message.replace(str(path), '')[:150]}", flush=True)
        for what in wrong:
            print(f"    WRONG: {what}", flush=True)
        self.failed += bool(wrong)


def fault(options, sets, texts, whole, number):
    """One line of FAULTS."""
    name, act, code, resumable, most = FAULTS[number]
    with tempfile.TemporaryDirectory(prefix="strake-faults-") as folder:
        place = Place(options, pathlib.Path(folder))
        run, since = act(place, sets)
        return name, place.path, code, judge(name, run, place, since, code, resumable, most, whole, texts)


def main():
    parser = runs.command(__doc__)
    parser.add_argument("--toys", type=pathlib.Path, help="folder of toy_participant, default BIN_DIR/../tests")
    parser.add_argument("--scheme", action="append", choices=list(SCHEMES))
    parser.add_argument("--only", default="", help="faults whose name holds this word")
    parser.add_argument("--texts", type=pathlib.Path, metavar="FILE", help="what the runs must say")
    parser.add_argument("--at-once", type=int, default=1, metavar="N", help="faults at a time; times to messages are those of 1")
    options = parser.parse_args()
    texts = Texts(options.texts)
    options.toys = options.toys or options.bin_dir / ".." / "tests"
    adopt_orphans()
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
        disks = [(full, limited) for full in FULL if options.only in full[0] for limited in ([False, True] if mounts else [True])]
        # Most of the time a run waits until a fault is noticed: several at once save that, each in a process that adopts its own orphans.
        with concurrent.futures.ProcessPoolExecutor(1 if texts.writes else options.at_once, initializer=adopt_orphans) as pool:
            for line in [pool.submit(fault, options, sets, texts, whole, number)
                         for number, one in enumerate(FAULTS) if options.only in one[0]] + [
                             pool.submit(full_disk, options, sets, texts, *disk) for disk in disks]:
                table.row(*line.result())
        failed += table.failed
    print(f"{failed} wrong")
    raise SystemExit(bool(failed))


if __name__ == "__main__":
    main()
