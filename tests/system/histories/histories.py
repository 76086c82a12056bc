"""Two masses, each a program of its own over the wire, that takes four steps in a window and is given the place of the other.
Histories both ways keep the second order of the programs."""
import csv
import pathlib
import shutil
import sys

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent))
from processes import *  # noqa: F403: the test's own vocabulary

HERE = ROOT / "tests" / "system" / "histories"


def errors(place, *sets):
    """Largest departure of a mass from the exact motion [m], of both masses the larger."""
    tag = f"{len(list((place / 'runs').glob('*')))}"
    words = [BIN / "strake", "run", place / "two_masses.toml", "--runs", place / "runs", "--tag", tag, "--quiet"]
    for text in sets:
        words += ["--set", text]
    done = subprocess.run(list(map(str, words)), cwd=place, env=ENV, capture_output=True, text=True, timeout=60)
    expect(done.returncode == 0, f"{', '.join(sets) or 'as the case is'}: exit {done.returncode}{done.stderr if done.returncode else ''}")
    with open(place / "runs" / f"two_masses-{tag}" / "history.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    expect("force.y [N/m]" not in rows[0] and "work_gap [1]" not in rows[0], "no columns of a force that is not exchanged")
    return max(float(rows[-1][f"error.{side} [m]"]) for side in ("fluid", "structure"))


with folder() as place:
    place = pathlib.Path(place)
    for file in (HERE / "mass.py", HERE / "two_masses.toml", ROOT / "tests" / "system" / "raw" / "connection.py"):
        shutil.copy(file, place)
    (place / "runs").mkdir()
    history, half = errors(place), errors(place, "coupling.surface.window=0.005")
    start = errors(place, "structure.mass.history=false")
    expect(history <= 0.005 and history / half > 3.7, f"histories both ways: error {history:.5f} m, at half the window {half:.5f} m")
    both = errors(place, "coupling.surface.scheme=parallel")
    expect(abs(both - history) < 1e-6, f"in a parallel scheme: error {both:.5f} m")
    expect(2 * history < start < 0.009, f"the start of the other alone: error {start:.5f} m")
finish()
