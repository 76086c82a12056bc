"""Sends kill -9 to each of the three processes in the middle of a run, and Ctrl-C. The others end within a second, and the
exit code and the message say which died. No process is left, and the files written so far can be read. What the killed one
was writing may be left, as FILE.part: nobody takes it for a frame, and a resumed run removes it."""
import json
import signal
import time

import h5py

from processes import *  # noqa: F403: the test's own vocabulary

CASE = ROOT / "cases" / "plate_entry.toml"
QUICK = ["--set", "structure.solver=rigid", "--set", "fluid.scheme.time_step=1e-5", "--set", "output.every=1e-5", "--set",
         "run.checkpoint_windows=7"]


def files_readable(run, who):
    frames = sorted((run / "frames").glob("fluid-*.h5"))
    expect(len(frames) > 0, f"{who}: there are fluid frames")
    for frame in frames:
        with h5py.File(frame, "r") as file:
            if file["position"].shape[0] == 0:
                expect(False, f"{who}: {frame.name} is empty")
    table = (run / "history.csv").read_text().splitlines()
    width = len(table[0].split(","))
    whole = all(len(line.split(",")) == width for line in table[1:])
    expect(whole, f"{who}: history.csv has whole rows ({len(table) - 1})")
    expect(not list(run.rglob("*.tmp")), f"{who}: no *.tmp")


def half_written(run):
    return sorted(path.relative_to(run).as_posix() for path in run.rglob("*.part"))


def resumed_without_them(run, who, place):
    """Half a frame, under the number of the next one, is no frame to any reader. A resumed run removes it."""
    print(f"      {who}: left {half_written(run)}")
    for side in ("fluid", "structure"):
        last = sorted((run / "frames").glob(f"{side}-*.h5"))[-1]
        after = run / "frames" / f"{side}-{int(last.stem[-6:]) + 1:06}.h5.part"
        after.write_bytes(last.read_bytes()[:1000])
    done = strake("picture", run, cwd=place)
    expect(done.returncode == 0, f"{who}: strake picture reads the frames\n{done.stderr}")
    end_time = (rows(run) + 5) * 1e-5
    done = strake("run", CASE, *QUICK, "--tag", "kill", "--resume", "--set", f"end_time={end_time:.6g}", cwd=place)
    expect(done.returncode == 0, f"{who}: the run is resumed\n{done.stderr}")
    expect(half_written(run) == [], f"{who}: nothing half-written is left: {half_written(run)}")
    files_readable(run, f"{who}, resumed")
    listed = (run / "fluid.xdmf").read_text()
    numbers = [int(path.stem[-6:]) for path in sorted((run / "frames").glob("fluid-*.h5"))]
    expect(".part" not in listed and numbers == list(range(len(numbers))) and rows(run) + 1 == len(numbers),
           f"{who}, resumed: a frame for each window, {len(numbers)}")


def run_and_strike(who, strike, code, named):
    with folder() as place:
        process = start("run", CASE, *QUICK, "--tag", "kill", cwd=place)
        run = pathlib.Path(place) / "runs" / "plate_entry-kill"
        try:
            running = wait_until(lambda: rows(run) >= 20, 60)
            expect(running, f"{who}: the run is under way")
            if not running:
                process.kill()
                print(process.communicate()[1])
                return
            pids = children(process.pid)
            expect(len(pids) == 2, f"{who}: two participants are running {sorted(pids)}")
            struck = time.monotonic()
            strike(process, pids)
            gone = wait_until(lambda: process.poll() is not None and not any(alive(p) for p in pids.values()), 5)
            took = time.monotonic() - struck
            expect(gone and took < 1.0, f"{who}: everything ended after {took:.2f} s")
            output, errors = process.communicate()
            if code is not None:
                expect(process.returncode == code, f"{who}: exit code {process.returncode}, expected {code}")
                expect(named in errors + output, f"{who}: the message names {named!r}:\n{errors.strip()}")
                state = json.loads((run / "run.json").read_text())
                expect(state.get("exit_code") == code, f"{who}: run.json says exit code {state.get('exit_code')}")
            else:
                for name in ("fluid", "structure"):
                    log = (run / f"{name}.log").read_text()
                    expect("coupler" in log, f"{who}: {name}.log says that the coupler is gone")
            files_readable(run, who)
            if who.startswith("kill -9"):
                resumed_without_them(run, who, place)
            else:
                expect(half_written(run) == [], f"{who}: nothing half-written is left: {half_written(run)}")
        finally:
            end(process)


def kill(name):
    def strike(process, pids):
        os.kill(pids[name], signal.SIGKILL)
    return strike


def marked(mark, word=""):
    """Processes with that mark in their environment: what was started here, whoever its parent is now."""
    found = {}
    for entry in pathlib.Path("/proc").iterdir():
        try:
            if entry.name.isdigit() and f"STRAKE_TEST={mark}".encode() in (entry / "environ").read_bytes().split(b"\0"):
                words = (entry / "cmdline").read_bytes().decode().split("\0")
                if not word or word in words:
                    found[int(entry.name)] = words[0]
        except OSError:
            continue
    return found


def kill_while_they_load(word):
    """The coupler dies just after it has started a program, which is still being loaded: the program ends as well."""
    with folder() as place:
        mark = f"{os.getpid()}{word}"
        process = subprocess.Popen([str(BIN / "strake"), "run", str(CASE)], cwd=place, env=dict(ENV, STRAKE_TEST=mark),
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        expect(wait_until(lambda: marked(mark, word), 30, step=0), f"kill -9 coupler: a program starts with {word}")
        process.kill()
        process.wait()
        struck = time.monotonic()
        ended = wait_until(lambda: not marked(mark), 3)
        left = marked(mark)
        expect(ended, f"kill -9 coupler while {word} is loaded: nothing runs {time.monotonic() - struck:.2f} s later {left}")
        for pid in left:
            os.kill(pid, signal.SIGKILL)


for mode in ("--check", "--connect"):
    kill_while_they_load(mode)
run_and_strike("kill -9 fluid", kill("strake-fluid"), 5, "fluid")
run_and_strike("kill -9 structure", kill("strake-structure-rigid"), 5, "structure")
run_and_strike("kill -9 coupler", lambda process, pids: process.kill(), None, "coupler")
run_and_strike("Ctrl-C", lambda process, pids: process.send_signal(signal.SIGINT), 130,
               "interrupted by Ctrl-C, the state is saved")
run_and_strike("SIGTERM", lambda process, pids: process.send_signal(signal.SIGTERM), 143,
               "ended by SIGTERM, the state is saved")
finish()
