"""A floor on a spring that knows preCICE alone, under Strake's water (floor/floor.py): period and mean against theory.
Both kinds of Python solvers are then killed, suspended, and give what is no number: each is named, and soon."""
import pathlib
import re
import shutil
import sys
import time

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent))
from processes import *  # noqa: F403: the test's own vocabulary

sys.path.insert(0, str(BIN.parent / "python"))
os.environ.update(STRAKE_BIN=str(BIN), OMP_NUM_THREADS="1")
import numpy as np  # noqa: E402
import strake as package  # noqa: E402

CASE = ROOT / "cases" / "python_spring"
FLOOR = pathlib.Path(__file__).resolve().parent / "floor"
WRAPPER = """#!/usr/bin/python3 -B
import os, sys
given = dict(zip(sys.argv[1::2], sys.argv[2::2]))
os.environ.update(STRAKE_CONNECT=given["--connect"], STRAKE_NAME=given["--name"], STRAKE_CASE_HASH=given["--case-hash"])
os.execv(__file__.replace("wrapper", "floor"), ["floor.py"])
"""


def case_of(place, solver):
    """The case of python_spring with another solver, beside it; without the probe that this one does not have."""
    text = (CASE / "python_spring.toml").read_text().partition("[[output.probe]]")[0]
    case = place / f"{pathlib.Path(solver).stem}.toml"
    case.write_text(text.replace('"./spring.py"', f'"./{solver}"'))
    return case


def period_and_mean(time, y):
    """Mean time between upward crossings of the mean, and the mean over whole periods."""
    mean = np.trapezoid(y, time) / (time[-1] - time[0]) if hasattr(np, "trapezoid") else np.trapz(y, time) / (time[-1] - time[0])
    z = y - mean
    up = [t0 + (t1 - t0) * -z0 / (z1 - z0) for t0, t1, z0, z1 in zip(time, time[1:], z, z[1:]) if z0 < 0 <= z1]
    return (up[-1] - up[0]) / (len(up) - 1), mean


def against_theory(place):
    run = package.run(case_of(place, "floor.py"), folder=place / "runs")
    field = run.interface
    period, mean = period_and_mean(np.concatenate([[0], field["time"]]), np.concatenate([[0], np.asarray(field["displacement"])[:, 0, 1]]))
    m, k = 200 + 1000, 1e8  # kg per metre of depth with the column on it, N/m
    for what, found, theory in (("period", period, 2 * np.pi * np.sqrt(m / k)), ("mean", mean, -9.81 * 1000 / k)):
        expect(abs(found / theory - 1) < 0.02, f"{what} {found:.4g}, theory {theory:.4g}: {100 * (found / theory - 1):+.2f} % (within 2 %)")
    iterations = run.column("iterations")
    expect(len(iterations) == 175 and iterations.mean() < 2.3, f"{len(iterations)} windows, {iterations.mean():.2f} iterations")
    expect(float(np.abs(np.asarray(field["displacement"])[:, :, 0]).max()) == 0, "the floor does not move sideways")


def connected_by_its_environment(place):
    (place / "wrapper.py").write_text(WRAPPER)
    (place / "wrapper.py").chmod(0o755)
    runs = [package.run(case_of(place, solver), {"end_time": 1e-3}, folder=place / "runs", tag="short") for solver in ("floor.py", "wrapper.py")]
    expect((runs[0].folder / "history.csv").read_bytes() == (runs[1].folder / "history.csv").read_bytes(),
           "connection data of the environment, no options: the same to the byte")


def faults(place, solver, line, name):
    """Puts faults beside a line of the solver. Each must end the run with its code, and be named."""
    text = (place / solver).read_text()
    assert line in text
    indent = re.match(" *", next(l for l in text.splitlines() if line in l)).group()
    for fault, code, words in (("force = float('nan')", 4, "nan"), ("raise ArithmeticError('no pivot')", 4, "ArithmeticError: no pivot"),
                               ("import os, signal; os.kill(os.getpid(), signal.SIGKILL)", 5, "killed by signal 9"),
                               ("import os, signal; os.kill(os.getpid(), signal.SIGSTOP)", 5, "")):
        broken = place / f"broken_{solver}"
        broken.write_text(text.replace(line, f"{line}\n{indent}{fault}") if "nan" in fault else text.replace(indent + line, f"{indent}{fault}\n{indent}{line}"))
        broken.chmod(0o755)
        case = case_of(place, broken.name)
        case.write_text(case.read_text().replace("structure.spring", f"structure.{broken.stem}"))
        begin = time.monotonic()
        result = strake("run", case, "--force", "--set", "coupling.frozen_after=0.5", cwd=place)
        took = time.monotonic() - begin
        expect(result.returncode == code and words in result.stderr and "structure" in result.stderr and took < 5,
               f"{name}: {fault}: exit {result.returncode} after {took:.1f} s, {result.stderr.splitlines()[0] if result.stderr else 'no word'}")


def other_names(place):
    """Data whose names the coupler does not know: what is missing is said before the first window, or in it."""
    for ours, theirs, words in (("Displacement", "Disp0", ("structure: sends no displacement", "it sends Disp0", 'precice_names = ["Disp0=displacement"]')),
                                ("Force", "Forces0", ('data "Forces0" of mesh "Floor-Mesh": is not sent by the partner', "it sends force", 'precice_names = ["Forces0=force"]'))):
        for file, new in (("floor.py", "named.py"), ("precice-config.xml", "named.xml")):
            (place / new).write_text((place / file).read_text().replace(f'"{ours}"', f'"{theirs}"').replace("precice-config.xml", "named.xml"))
        (place / "named.py").chmod(0o755)
        result = strake("run", case_of(place, "named.py"), "--force", cwd=place)
        expect(result.returncode in (3, 4) and all(word in result.stderr for word in words), f"{theirs}: exit {result.returncode}, {result.stderr[:300]}")


def refused_to_resume(place):
    case = case_of(place, "floor.py")
    words = ("run", case, "--tag", "cut", "--set", "run.checkpoint_windows=5")
    process = start(*words, cwd=place)
    expect(wait_until(lambda: rows(place / "runs" / "floor-cut") >= 10, 60), "resume: the run is under way")
    process.send_signal(signal.SIGINT)
    process.communicate(timeout=30)
    result = strake(*words, "--resume", cwd=place)
    expect(result.returncode != 0 and "resume" in result.stderr, f"resume is refused in words: exit {result.returncode}\n{result.stderr}")


with folder() as name:
    here = pathlib.Path(name)
    shutil.copytree(FLOOR, here, dirs_exist_ok=True)
    shutil.copy(CASE / "spring.py", here)
    against_theory(here)
    connected_by_its_environment(here)
    faults(here, "floor.py", 'force = participant.read_data(mesh, "Force", ids, dt)[:, 1].sum()', "precice")
    faults(here, "spring.py", '(y, v), a, force = self.state, self.k * dt**2 / (4 * self.m), load["force"][:, 1].sum()', "strake")
    other_names(here)
    refused_to_resume(here)
finish()
