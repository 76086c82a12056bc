"""coupling.placement = "fluid": the scheme in the fluid's process gives what it gives in the coupler's, file by file and bit
by bit; a kill is named, Ctrl-C saves the state, and either placement goes on from what the other one saved."""
import json
import signal
import time

from processes import *  # noqa: F403: the test's own vocabulary

CASE = ROOT / "cases" / "plate_entry.toml"
WINDOW = 4e-5  # s
# 300 particles and a soft plate that meets the water after 48 windows.
COARSE = ["fluid.spacing=0.02", "fluid.tank=[[-0.3,-0.2,0],[0.3,0.3,0]]", "fluid.water=[[-0.3,-0.2,0],[0.3,0,0]]",
          f"coupling.surface.window={WINDOW}", "structure.plate.bottom=[0,0.012,0]", "structure.plate.length=0.2",
          "structure.material.young=5e9", "output.probe[0].at=[0,0.012,0]", "output.probe[1].at=[0,0.012,0]",
          "output.probe[1].diameter=0.04", f"output.every={10 * WINDOW}", "run.threads=1"]
PARTICLE = ["structure.solver=particle"]
WAYS = {
    "serial implicit": PARTICLE,
    "serial explicit": ["structure.solver=rigid", "coupling.surface.converged.max_iterations=1"],
    "volume": PARTICLE + ["coupling.interface=volume", "coupling.volume.window=4e-5", "structure.plate.thickness=0.04"],
    "parallel": PARTICLE + ["coupling.surface.scheme=parallel"],
    "halved windows": PARTICLE + ["coupling.surface.converged.max_iterations=3",
                                  "coupling.surface.converged.relative=1e-7", "coupling.surface.converged.unconverged=halve"],
}


def words(tag, sets, placement, windows=80):
    pairs = [*COARSE, *sets, f"end_time={windows * WINDOW!r}", f"coupling.placement={placement}"]
    return ["run", CASE, "--quiet", "--tag", tag] + [word for pair in pairs for word in ("--set", pair)]


def contents(run):
    """What must be equal: name → bytes."""
    found = {name: (run / name).read_bytes() for name in ("history.csv", "iterations.csv", "fluid.xdmf", "structure.xdmf")
             if (run / name).exists()}
    for part in ("interface", "frames"):
        found |= {f"{part}/{file.name}": file.read_bytes() for file in (run / part).iterdir()}
    summary = json.loads((run / "summary.json").read_text())
    for key in ("seconds", "peak_memory_bytes", "tag"):
        del summary[key]
    found["summary.json"] = json.dumps(summary, indent=1).encode()
    return found


def expect_equal(one, other, what):
    different = sorted(name for name in one.keys() | other.keys() if one.get(name) != other.get(name))
    expect(not different, f"{what}: {len(one)} files bit-equal {different}")


def completed(place, tag, sets, placement, *more, windows=80):
    result = strake(*words(tag, sets, placement, windows), *more, cwd=place)
    expect(result.returncode == 0, f"{tag}, {placement}: exit {result.returncode} {result.stderr}")
    return pathlib.Path(place) / "runs" / f"plate_entry-{tag}"


def struck(place, tag, placement, who, number, after=20):
    """A run that is struck after so many windows: exit code, what it said, seconds to its end."""
    process = start(*words(tag, [*PARTICLE, "run.checkpoint_windows=7"], placement, windows=200), cwd=place)
    run = pathlib.Path(place) / "runs" / f"plate_entry-{tag}"
    try:
        expect(wait_until(lambda: rows(run) >= after, 60), f"{who}: the run is under way")
        pids = children(process.pid)
        expect(len(pids) == 2, f"{who}: two participants are running {sorted(pids)}")
        begin = time.monotonic()
        os.kill(process.pid if who == "strake" else pids[who], number)
        gone = wait_until(lambda: process.poll() is not None and not any(alive(p) for p in pids.values()), 5)
        expect(gone, f"{who}: everything has ended")
        return process.returncode, process.communicate()[1], time.monotonic() - begin
    finally:
        end(process)


def equal_results():
    for way, sets in WAYS.items():
        with folder() as place:
            name = way.replace(" ", "-")
            hub, fluid = (contents(completed(place, f"{name}-{placement}", sets, placement)) for placement in ("coupler", "fluid"))
            expect_equal(hub, fluid, way)
            expect(hub["history.csv"].count(b"\n") == 81 or way == "halved windows", f"{way}: 80 windows")


def faults():
    with folder() as place:
        for who in ("strake-fluid", "strake-structure-particle"):
            code, said, seconds = struck(place, who, "fluid", who, signal.SIGKILL)
            side = "fluid" if who == "strake-fluid" else "structure"
            expect(code == 5 and seconds < 1.5, f"kill -9 {who}: exit {code} after {seconds:.2f} s")
            expect(said.startswith(f"{side}, ") and "was killed by signal 9" in said and "window" in said.splitlines()[0],
                   f"kill -9 {who}: named, with its window\n{said.strip()}")
            resumed = completed(place, who, PARTICLE + ["run.checkpoint_windows=7"], "fluid", "--resume", windows=200)
            expect(rows(resumed) == 200, f"kill -9 {who}: goes on from its checkpoint")
        code, said, seconds = struck(place, "coupler", "fluid", "strake", signal.SIGKILL)
        expect(code == -9 and seconds < 1.5, f"kill -9 strake: both sides have ended after {seconds:.2f} s")
        whole = contents(resumed)
        for first, second in (("fluid", "coupler"), ("coupler", "fluid"), ("fluid", "fluid")):
            tag = f"{first}-{second}"
            code, said, seconds = struck(place, tag, first, "strake", signal.SIGINT)
            expect(code == 130 and "state is saved" in said, f"Ctrl-C, {first}: exit {code} after {seconds:.2f} s, {said.strip()}")
            resumed = completed(place, tag, PARTICLE + ["run.checkpoint_windows=7"], second, "--resume", windows=200)
            expect_equal(whole, contents(resumed), f"{first}, Ctrl-C, {second}")


def frozen():
    with folder() as place:
        for who, side in (("strake-fluid", "fluid"), ("strake-structure-particle", "structure")):
            said_to = words(who, [*PARTICLE, "coupling.frozen_after=2"], "fluid", windows=2000)
            process = start(*[word for word in said_to if word != "--quiet"], cwd=place)
            run = pathlib.Path(place) / "runs" / f"plate_entry-{who}"
            try:
                expect(wait_until(lambda: rows(run) >= 20, 60), f"{side} stopped: the run is under way")
                os.kill(children(process.pid)[who], signal.SIGSTOP)
                expect(wait_until(lambda: process.poll() is not None, 8), f"{side} stopped: the run has ended")
                output, said = process.communicate()
                expect(process.returncode == 5 and said.startswith(f"{side}, ") and "no heartbeat" in said,
                       f"{side} stopped: exit {process.returncode}, {said.strip()}")
                expect(f"{side}, " in output and "no heartbeat for" in output, f"{side} stopped: a line before the end said so")
            finally:
                end(process)
        whole = contents(completed(place, "whole", PARTICLE, "fluid", windows=200))
        for who in ("strake", "strake-structure-particle"):  # longer than the heartbeats, shorter than the patience
            process = start(*words(f"back-{who}", PARTICLE, "fluid", windows=200), cwd=place)
            run = pathlib.Path(place) / "runs" / f"plate_entry-back-{who}"
            try:
                wait_until(lambda: rows(run) >= 20, 60)
                pid = process.pid if who == "strake" else children(process.pid)[who]
                os.kill(pid, signal.SIGSTOP)
                time.sleep(2)
                os.kill(pid, signal.SIGCONT)
                expect(process.wait(timeout=60) == 0, f"{who} stopped and continued: {process.communicate()[1]}")
                expect_equal(whole, contents(run), f"{who} stopped and continued")
            finally:
                end(process)


def refusals():
    with folder() as place:
        for more, problem in ((["--attach", "structure"], "needs the coupler in the middle"),
                              (["--set", "structure.solver=none"], "coupling.placement"),
                              (["--set", "coupling.endpoint=tcp://127.0.0.1:*"], "all stays on one machine")):
            result = strake(*words("refused", PARTICLE, "fluid"), *more, cwd=place)
            expect(result.returncode == 2 or result.returncode == 3, f"{more}: exit {result.returncode}")
            expect(problem in result.stderr, f"{more}: says why\n{result.stderr.strip()}")
            expect(not (pathlib.Path(place) / "runs").exists(), f"{more}: leaves no folder")


equal_results()
faults()
frozen()
refusals()
finish()
