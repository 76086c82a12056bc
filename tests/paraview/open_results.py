"""Results open in ParaView with every field and every time step. pvpython reads the same values as h5py in the frames.

tests/run.sh --paraview; or by hand: /usr/bin/python3 tests/paraview/open_results.py SOURCES build/bin [FOLDER for the pictures]
"""
import json
import pathlib
import shutil
import sys

import h5py
import numpy

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "system"))
from processes import *  # noqa: E402,F403: the test's own vocabulary

LOOK = ROOT / "tests" / "paraview" / "look.py"
SHOW = ROOT / "cases" / "paraview" / "show.py"
KEEP = pathlib.Path(sys.argv[3]).resolve() if len(sys.argv) > 3 else None


def display():
    """A display without a screen, and its name: Debian's ParaView draws through X alone."""
    ours, servers = os.pipe()
    server = subprocess.Popen(["Xvfb", "-displayfd", str(servers), "-screen", "0", "1600x1200x24", "-nolisten", "tcp"],
                              pass_fds=[servers], stderr=subprocess.DEVNULL)
    os.close(servers)
    number = os.read(ours, 16).decode().strip()  # when it is ready; nothing when it ends before
    if not number:
        sys.exit(f"Xvfb does not start: exit {server.wait()}")
    return server, ":" + number


def pvpython(*words, cwd, timeout=300):
    return subprocess.run(["pvpython", *map(str, words)], cwd=cwd, env=ENV, capture_output=True, text=True, timeout=timeout)


def decoded(link):
    for code, letter in (("%2F", "/"), ("%2E", "."), ("%25", "%")):
        link = link.replace(code, letter)
    return link


def in_frames(run, side):
    """Time → content of a frame, in the order of time."""
    frames = {}
    for path in sorted((run / "frames").glob(f"{side}-*.h5")):
        with h5py.File(path) as file:
            position = file["position"][:]
            arrays = {decoded(name): data[:].reshape(len(position), -1) for name, data in file["point"].items()}
            frames[float(file.attrs["time"])] = {"position": position, "arrays": arrays, "cells": file["cells"].shape[0]}
    return frames


def close(one, other, scale):
    return abs(one - other) <= 1e-6 * scale + 1e-300  # ParaView's ranges of single steps are double; bounds are too


# In the file a symmetric tensor is xx xy xz yy yz zz. The older reader makes a whole one: xx xy xz yx yy yz zx zy zz.
WHOLE_TENSOR = [0, 1, 2, 1, 3, 4, 2, 4, 5]


def compare(what, seen, frames, whole_tensors):
    times = list(frames)
    if not expect_equal(len(seen["times"]), len(times), f"{what}: number of time steps"):
        return
    expect(all(abs(a - b) <= 1e-12 * max(1.0, abs(b)) for a, b in zip(seen["times"], times)), f"{what}: the times")
    wrong = []
    for step, time in zip(seen["steps"], times):
        frame = frames[time]
        if step["points"] != len(frame["position"]) or step["cells"] != frame["cells"]:
            wrong.append(f"t = {time}: {step['points']} points and {step['cells']} cells, "
                         f"the file has {len(frame['position'])} and {frame['cells']}")
        size = float(numpy.ptp(frame["position"], axis=0).max())
        for k in range(3):
            low, high = frame["position"][:, k].min(), frame["position"][:, k].max()
            if not (close(step["bounds"][2 * k], low, size) and close(step["bounds"][2 * k + 1], high, size)):
                wrong.append(f"t = {time}: bounds {step['bounds']}")
        if set(step["arrays"]) != set(frame["arrays"]):
            wrong.append(f"t = {time}: fields {sorted(step['arrays'])}, the file has {sorted(frame['arrays'])}")
            continue
        for name, values in frame["arrays"].items():
            if whole_tensors and values.shape[1] == 6:
                values = values[:, WHOLE_TENSOR]
            if len(step["arrays"][name]) != values.shape[1]:
                wrong.append(f"t = {time}: {name} has {len(step['arrays'][name])} components, not {values.shape[1]}")
                continue
            scale = float(numpy.nanmax(numpy.abs(values), initial=0))
            for k, (low, high) in enumerate(step["arrays"][name]):
                finite = values[:, k][numpy.isfinite(values[:, k])]
                if len(finite) and not (close(low, finite.min(), scale) and close(high, finite.max(), scale)):
                    wrong.append(f"t = {time}: {name}[{k}] from {low} to {high}, the file from {finite.min()} to {finite.max()}")
    fields = sorted(frames[times[-1]]["arrays"])
    expect(not wrong, f"{what}: {len(times)} steps with {', '.join(fields)}" + "".join("\n        " + w for w in wrong[:5]))


def expect_equal(one, other, what):
    expect(one == other, f"{what}: {one}, expected {other}")
    return one == other


def killed(place):
    """A run whose processes are killed in the middle of it."""
    process = start("run", ROOT / "cases" / "dam_break.toml", "--tag", "killed", cwd=place)
    run = place / "runs" / "dam_break-killed"
    several = wait_until(lambda: len(list((run / "frames").glob("fluid-*.h5"))) >= 5, 60)
    end(process)
    expect(several and not (run / "summary.json").exists(), "killed: the run had frames and no end")
    wait_until(lambda: not any(run.glob("frames/*.part")), 2)
    return run


def listed(run, side):
    """Frames that the list names: a kill between a frame and its line leaves one more on disk."""
    names = (run / f"{side}.xdmf").read_text().count("<Time ")
    frames = in_frames(run, side)
    expect(len(frames) - 1 <= names <= len(frames), f"{run.name}: {names} of {len(frames)} {side} frames are listed")
    return dict(list(frames.items())[:names])


def runs(place):
    plate = ["run", ROOT / "cases" / "plate_entry.toml", "--set", "end_time=2.2e-3", "--set", "output.every=2e-4", "--quiet"]
    failing = ["run", ROOT / "cases" / "plate_failure.toml", "--set", "end_time=1.7e-3", "--quiet"]
    wanted = {
        "plate_entry-fem": [*plate, "--tag", "fem"],
        "plate_entry-particle": [*plate, "--tag", "particle", "--set", "structure.solver=particle"],
        "plate_failure-failure": [*failing, "--tag", "failure"],
        "plate_failure-parts": [*failing, "--tag", "parts", "--set", "structure.solver=particle"],
        "dam_break_3d-space": ["run", ROOT / "cases" / "dam_break_3d.toml", "--set", "end_time=0.05", "--tag", "space", "--quiet"],
        # Frames of ranks are virtual: a small file joins the parts.
        "plate_entry-ranks": [*plate, "--tag", "ranks", "--set", "fluid.ranks=2"],
        "dam_break_3d-ranks": ["run", ROOT / "cases" / "dam_break_3d.toml", "--set", "end_time=0.05", "--tag", "ranks", "--set", "fluid.ranks=3", "--quiet"],
    }
    for name, words in wanted.items():
        result = strake(*words, cwd=place, timeout=280)
        expect(result.returncode == 0, f"{name}: exit {result.returncode}\n{result.stderr}")
        yield place / "runs" / name
    yield killed(place)


def picture(place, run, *words):
    out = place / f"{run.name}.png"
    result = pvpython(SHOW, run, "-o", out, *words, cwd=place)
    expect(result.returncode == 0 and out.exists(), f"{run.name}: a picture is drawn, exit {result.returncode}\n{result.stderr[-2000:]}")
    if not out.exists():
        return
    n_colours = json.loads(pvpython(LOOK, "--colours", out, cwd=place).stdout.splitlines()[-1])
    expect(n_colours > 100, f"{run.name}: the picture has {n_colours} colours")
    if KEEP:
        KEEP.mkdir(parents=True, exist_ok=True)
        shutil.copy(out, KEEP)


for program in ("pvpython", "Xvfb"):
    if not shutil.which(program):
        sys.exit(f"there is no {program}: apt-get install paraview python3-paraview xvfb libgl1-mesa-dri")
x_server, ENV["DISPLAY"] = display()
with folder() as place:
    place = pathlib.Path(place)
    made = list(runs(place))
    for run in made:
        files = sorted(run.glob("*.xdmf"))
        result = pvpython(LOOK, *files, cwd=place)
        lines = [line for line in result.stdout.splitlines() if line.startswith("{")]
        expect(result.returncode == 0 and lines, f"{run.name}: pvpython exits {result.returncode}\n{result.stderr[-2000:]}")
        for reader, by_file in json.loads(lines[-1]).items() if lines else ():
            for path, seen in by_file.items():
                compare(f"{run.name}, {pathlib.Path(path).stem}, {reader}", seen, listed(run, pathlib.Path(path).stem),
                        reader == "XDMFReader")
    picture(place, made[0], "--time", "2.1e-3")
    picture(place, made[3], "--solid", "damage")
    picture(place, made[4])
x_server.terminate()
x_server.wait()
finish()
