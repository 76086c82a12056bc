"""Signals: whatever the programs do, the first one is heard within a second, and a run keeps what it has."""
import json
import shutil

from processes import *  # noqa: F403: the test's own vocabulary

STILL = ROOT / "cases" / "still_tank.toml"
PLATE = [ROOT / "cases" / "plate_entry.toml", "--set", "structure.solver=rigid", "--set", "fluid.scheme.time_step=1e-5"]


def said_after(process, seconds):
    """What a process has printed on a pipe within so many seconds."""
    os.set_blocking(process.stdout.fileno(), False)
    time.sleep(seconds)
    return process.stdout.read() or ""


def frames_of_a_tiny_interval(place):
    began = time.monotonic()
    result = strake("run", STILL, "--set", "end_time=0.02", "--set", "output.every=1e-14", cwd=place, timeout=60)
    run = place / "runs" / "still_tank"
    expect(result.returncode == 0, f"output.every = 1e-14: exit {result.returncode} after {time.monotonic() - began:.1f} s")
    expect(len(list((run / "frames").glob("fluid-*.h5"))) == rows(run) + 1 > 1, "there is a frame at t = 0 and one in each window")


def a_window_of_very_many_steps(place):
    process = start("run", STILL, "--tag", "long", "--set", "fluid.scheme.time_step=1e-7", "--set",
                    "coupling.surface.window=0.1", "--set", "end_time=0.1", cwd=place)
    try:
        header = wait_until(lambda: "time" in (process.stdout.readline() or ""), 60)
        expect(header, "the window has begun")
        time.sleep(0.5)
        struck = time.monotonic()
        process.send_signal(signal.SIGTERM)
        text = said_after(process, 1.0)
        expect("ended by SIGTERM, waiting 5 s at most for the answer to Advance" in text, f"within a second it says what it waits for: {text!r}")
        process.wait(timeout=20)
        took = time.monotonic() - struck
        expect(process.returncode == 143 and took < 6.5, f"a window of very many steps: exit {process.returncode} after {took:.1f} s")
        record = json.loads((place / "runs" / "still_tank-long" / "run.json").read_text())
        expect(record["exit_code"] == 143, "run.json says so")
    finally:
        end(process)


def a_command_that_computes_for_long(place):
    rows_of_a_table = "".join(f"{i * 1e-6:.6f},{i % 97}\n" for i in range(4_000_000))
    for name in ("a", "b"):
        (place / f"{name}.csv").write_text("time [s],x [m]\n" + rows_of_a_table)
    for number, code in ((signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGHUP, 129)):
        process = start("compare", "a.csv", "b.csv", cwd=place)
        try:
            time.sleep(0.5)
            expect(process.poll() is None, "compare of large tables is under way")
            struck = time.monotonic()
            process.send_signal(number)
            gone = wait_until(lambda: process.poll() is not None, 5)
            took = time.monotonic() - struck
            expect(gone and process.returncode == code and took < 1.5,
                   f"compare of large tables: exit {process.returncode} after {took:.2f} s, expected {code}")
        finally:
            end(process)


def the_terminal_goes(place):
    process = start("run", *PLATE, "--tag", "hup", cwd=place)
    run = place / "runs" / "plate_entry-hup"
    try:
        expect(wait_until(lambda: rows(run) >= 20, 60), "SIGHUP: the run is under way")
        process.send_signal(signal.SIGHUP)
        time.sleep(0.4)
        process.send_signal(signal.SIGHUP)  # once more, as a terminal may: nothing is lost by it
        _, errors = process.communicate(timeout=30)
        expect(process.returncode == 129 and "ended by SIGHUP" in errors and "the state is saved" in errors,
               f"SIGHUP: exit {process.returncode}\n{errors}")
        expect(json.loads((run / "run.json").read_text())["exit_code"] == 129, "SIGHUP: run.json has its end")
        expect("ended by SIGHUP" in (run / "coupler.log").read_text(), "SIGHUP: the log says so")
        expect((run / "checkpoint" / "latest" / "checksums").exists(), "SIGHUP: the state is saved")
    finally:
        end(process)


def under_nohup(place):
    process = subprocess.Popen(["nohup", str(BIN / "strake"), "run", str(STILL), "--set", "end_time=0.2", "--tag", "nohup"],
                               cwd=place, env=ENV, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    try:
        run = place / "runs" / "still_tank-nohup"
        expect(wait_until(lambda: rows(run) >= 3, 60), "nohup: the run is under way")
        process.send_signal(signal.SIGHUP)
        process.communicate(timeout=60)
        expect(process.returncode == 0, f"nohup: SIGHUP is not heard, exit {process.returncode}")
    finally:
        end(process)


def a_participant_that_builds_for_ever(place):
    shutil.copytree(ROOT / "cases" / "python_spring", place / "slow")
    script = (place / "slow" / "spring.py").read_text().replace("def build(self, key):", "def build(self, key):\n        import time; time.sleep(60)")
    (place / "slow" / "spring.py").write_text(script)
    for words in (("check", "slow/python_spring.toml"), ("run", "slow/python_spring.toml")):
        process = start(*words, cwd=place)
        try:
            expect(wait_until(lambda: "strake-fluid" in children(process.pid) or "spring.py" in " ".join(children(process.pid)), 30),
                   f"{words[0]}: participants are being built {children(process.pid)}")
            time.sleep(1.5)
            struck = time.monotonic()
            process.send_signal(signal.SIGTERM)
            process.communicate(timeout=20)
            took = time.monotonic() - struck
            expect(process.returncode == 143 and took < 2, f"{words[0]}, being set up: exit {process.returncode} after {took:.2f} s")
        finally:
            end(process)


with folder() as name:
    here = pathlib.Path(name)
    frames_of_a_tiny_interval(here)
    a_window_of_very_many_steps(here)
    a_command_that_computes_for_long(here)
    the_terminal_goes(here)
    under_nohup(here)
    a_participant_that_builds_for_ever(here)
finish()
