"""The elastic tube between two Python solvers that know preCICE's names alone (tube/). Iterations per window and the values
in the middle are those of preCICE's own tutorial: 8.59 with preCICE 3.4.1, at the same settings."""
import pathlib
import shutil
import sys

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent))
from processes import *  # noqa: F403: the test's own vocabulary

sys.path.insert(0, str(BIN.parent / "python"))
os.environ.update(STRAKE_BIN=str(BIN), OMP_NUM_THREADS="1")
import numpy as np  # noqa: E402
import strake as package  # noqa: E402

MIDDLE = 50
# time [s], area [m^2], pressure [Pa]: windows converged to 1e-10. At 1e-5 they may be off by 1e-5 of the largest pressure, 200 Pa.
VALUES = ((0.24, 0.994420069, -49.6587672), (0.50, 1.025458222, 221.3991549), (1.00, 0.975320299, -222.8516757))

def with_two_meshes(here):
    """The flow sends its pressure on a mesh of its own, which has the same points."""
    (here / "tube.xml").write_text((here / "tube.xml").read_text().replace(
        '  <participant name="Fluid">', '  <mesh name="Fluid-Pressures" dimensions="3"><use-data name="Pressure" /></mesh>\n  <participant name="Fluid">').replace(
        '<provide-mesh name="Fluid-Nodes" />', '<provide-mesh name="Fluid-Nodes" /><provide-mesh name="Fluid-Pressures" />').replace(
        '<write-data name="Pressure" mesh="Fluid-Nodes" />', '<write-data name="Pressure" mesh="Fluid-Pressures" />'))
    flow = here / "tube_fluid.py"
    flow.write_text(flow.read_text().replace("participant.initialize()", 'participant.set_mesh_vertices("Fluid-Pressures", POINTS)\nparticipant.initialize()').replace(
        'write_data(MESH, "Pressure"', 'write_data("Fluid-Pressures", "Pressure"'))
    return package.run(here / "tube.toml", folder=here / "runs", tag="two")


with folder() as name:
    here = pathlib.Path(name)
    shutil.copytree(pathlib.Path(__file__).resolve().parent / "tube", here, dirs_exist_ok=True)
    run = package.run(here / "tube.toml", folder=here / "runs")
    iterations = run.column("iterations")
    expect(len(iterations) == 100 and abs(iterations.mean() - 8.4) < 0.3 and run.summary["iterations"]["unconverged"] == 0,
           f"{len(iterations)} windows, {iterations.mean():.2f} iterations (8.4 within 0.3), first {iterations[:4].astype(int).tolist()}")
    time, area, pressure = (np.asarray(run.interface[field]) for field in ("time", "structure.CrossSection", "fluid.pressure"))
    for t, a, p in VALUES:
        window = int(np.argmin(np.abs(time - t)))
        found = area[window, MIDDLE], pressure[window, MIDDLE]
        expect(abs(found[0] - a) < 1e-6 and abs(found[1] - p) < 2e-3,
               f"t = {t:.2f} s: area {found[0]:.7f} m^2 ({a:.7f}), pressure {found[1]:.4f} Pa ({p:.4f})")
    two = with_two_meshes(here)
    files = [(one.folder / "iterations.csv").read_bytes() for one in (run, two)]
    expect(files[0] == files[1] and (np.asarray(two.interface["structure.CrossSection"]) == area).all(),
           f"two meshes of the flow: {two.column('iterations').mean():.2f} iterations, the same numbers to the byte")
finish()
