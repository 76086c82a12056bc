"""Two masses between springs that exchange histories, by solvers that know preCICE's names alone (oscillator/). The error
against the exact motion falls with the square of the window, as that of their time steps does."""
import pathlib
import shutil
import sys

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent))
from processes import *  # noqa: F403: the test's own vocabulary

sys.path.insert(0, str(BIN.parent / "python"))
os.environ.update(STRAKE_BIN=str(BIN), OMP_NUM_THREADS="1")
import coupling_pb2  # noqa: E402
import numpy as np  # noqa: E402
import strake as package  # noqa: E402

LARGEST = 0.005  # m, at windows of 0.01 s


def exact(t):
    """Places [m] of both masses: half of each of the two modes."""
    together, against = np.cos(2 * np.pi * t), np.cos(6 * np.pi * t)
    return (together + against) / 2, (together - against) / 2


def error_at(place, window):
    run = package.run(place / "oscillator.toml", {"coupling.surface.window": window}, folder=place / "runs", tag=f"w{window}")
    places = [np.asarray(run.interface[name])[:, 0, 0] for name in ("fluid.Place-Left", "structure.Place-Right")]
    return max(np.abs(u - theory).max() for u, theory in zip(places, exact(np.asarray(run.interface["time"]))))


if "wants_history" not in coupling_pb2.Advance.DESCRIPTOR.fields_by_name:
    print("skipped: this coupler takes no history of a structure")
    sys.exit(0)
with folder() as name:
    here = pathlib.Path(name)
    shutil.copytree(pathlib.Path(__file__).resolve().parent / "oscillator", here, dirs_exist_ok=True)
    coarse, fine = error_at(here, 0.02), error_at(here, 0.01)
    order = np.log2(coarse / fine)
    expect(fine < LARGEST, f"largest error {fine:.5f} m at windows of 0.01 s (at most {LARGEST})")
    expect(abs(order - 2) < 0.1, f"{coarse:.5f} m at 0.02 s: order {order:.2f} (2 within 0.1)")
finish()
