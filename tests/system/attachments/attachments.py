"""What is coupled to points of a structure: mooring lines, a controller in Python, two bodies, resume, faults, refusals."""
import os
import pathlib
import signal
import sys
import time

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent))
from processes import *  # noqa: F403: the test's own vocabulary

SPRING = ROOT / "cases" / "python_spring" / "python_spring.toml"
SPRING_PY = ROOT / "cases" / "python_spring" / "spring.py"
FLOORS = ROOT / "cases" / "two_floors" / "two_floors.toml"
ATTACHED = """
[[attachments]]
name = "winch"
at = [[0.0, -0.05]]
solver = "./winch.py"
[attachments.winch]
stiffness = 1e8
"""
WINCH = """#!/usr/bin/python3 -B
import numpy as np, strake, sys, time
class Winch(strake.Participant):
    can_resume = {resume}
    dt_limit = {limit}
    def build(self, key):
        self.k = key["stiffness"]
        self.state = np.zeros(1)
        self.columns = {{"pull": "N/m"}}
    def advance(self, t, dt, motion):
        {fault}
        before, self.state[0] = self.state[0], -self.k * motion["displacement"][0, 1]
        self.monitor["pull"] = self.state[0]
        return 0, (before + self.state[0]) / 2
Winch.main()
"""


def winch(place, fault="pass", resume=True, limit="np.inf"):
    (place / "winch.py").write_text(WINCH.format(fault=fault, resume=resume, limit=limit))
    (place / "winch.py").chmod(0o755)


with folder() as name:
    place = pathlib.Path(name)
    runs = place / "runs"
    winch(place)
    text = SPRING.read_text().replace('"./spring.py"', f'"{SPRING_PY}"').replace("stiffness = 1.0e8 ", "stiffness = 0.0 ")
    (place / "floor.toml").write_text(text + ATTACHED)

    # The floor's spring as a controller's: the same floor.
    run_case(place, "floor.toml", "--strict"), run_case(place, SPRING)
    attached, own = columns(runs / "floor"), columns(runs / "python_spring")
    off = max(abs(a - b) for a, b in zip(attached["floor.y [m]"], own["floor.y [m]"]))
    expect(off < 1e-8, f"a spring that is attached moves the floor as its own: {off:.1e} m off of 2e-4 m")
    expect(max(abs(a + 1e8 * y) for a, y in zip(attached["winch.pull [N/m]"], attached["floor.y [m]"])) < 2, "it reports its pull")
    expect(strake("report", runs / "floor", "-o", place / "floor.html", cwd=place).returncode == 0, "a report is made")
    expect(strake("picture", runs / "floor", "-o", place / "floor.svg", cwd=place).returncode == 0, "a picture is drawn")

    # The longest window that it announces counts from the first one on.
    winch(place, limit="1e-4")
    run_case(place, "floor.toml", "--tag", "short", "--set", "end_time=1e-3")
    ends = columns(runs / "floor-short")["time [s]"]
    longest = max(b - a for a, b in zip([0, *ends], ends))
    expect(longest < 1e-4 * 1.001, f"its windows have at most 1e-4 s from the first one on: {longest:.3g} s")
    winch(place)

    # Resumed in the middle: the same bytes. Two bodies, one with the controller, the other with springs of ours.
    two = FLOORS.read_text().replace('"../python_spring/spring.py"', f'"{SPRING_PY}"')
    more = ATTACHED.replace("[[0.0, -0.05]]", "[[-0.6, -0.05]]").replace('name = "winch"', 'name = "winch"\nbody = "left"') + """
[[attachments]]
name = "springs"
body = "right"
at = [[0.2, 0.0], [1.0, 0.0]]
solver = "spring"
[attachments.spring]
anchor = [[0.2, -1.0], [1.0, -1.0]]
stiffness = 1e6
damping = 10.0
"""
    (place / "two.toml").write_text(two + more)
    run_case(place, "two.toml", "--set", "end_time=0.02")
    run_case(place, "two.toml", "--tag", "parts", "--set", "end_time=0.01", "--set", "run.checkpoint=1e-3")
    run_case(place, "two.toml", "--tag", "parts", "--resume", "--set", "end_time=0.02", "--set", "run.checkpoint=1e-3")
    expect((runs / "two-parts" / "history.csv").read_bytes() == (runs / "two" / "history.csv").read_bytes(),
           "a resumed run with two bodies and attachments has the same history.csv")
    both = columns(runs / "two")
    expect(both["springs.tension.1 [N/m]"][-1] != 0 and both["winch.force.y [N/m]"][-1] != 0, "both pull")

    # Mooring lines hold a box where it floats (cases/moored_box.toml, closed form), and where it does not they pull more.
    run_case(place, ROOT / "cases" / "moored_box.toml", "--strict", "--set", "end_time=0.3")

    # Faults: an exception, a death, a value that is no number, and one that cannot be taken up again.
    winch(place, "if t > 0.005: raise ValueError('the drum is empty')")
    done = run_case(place, "floor.toml", "--tag", "throws", code=4)
    expect("winch" in done.stderr and "the drum is empty" in done.stderr, "an exception names the attachment: " + done.stderr[:300])
    winch(place, "if t > 0.005: import os; os.kill(os.getpid(), 9)")
    begin = time.monotonic()
    done = run_case(place, "floor.toml", "--tag", "dies", code=5)
    expect("winch" in done.stderr and "signal 9" in done.stderr, "a death names the attachment: " + done.stderr[:300])
    winch(place, "if t > 0.005: self.k = float('nan')")
    done = run_case(place, "floor.toml", "--tag", "nan", code=4)
    expect("winch" in done.stderr and "not finite" in done.stderr, "no number names the attachment: " + done.stderr[:300])
    expect((runs / "floor-nan" / "history.csv").exists(), "what was computed before stays")
    winch(place, resume=False)
    done = strake("check", "floor.toml", cwd=place)
    expect("winch cannot save its state" in done.stdout, "check says that it cannot be resumed")

    # What is refused, with its place.
    winch(place)
    for change, words in (("attachments.winch.at=[[0.0,0.3]]", "from the body's surface"), ("attachments.winch.name=fluid", "no side, body"),
                          ("attachments.winch.solver=sprnig", 'did you mean "spring"'), ("attachments.winsh.at=[[0,0]]", "attachments winch"),
                          ("attachments.winch.solver=spring", "anchor is missing"), ("attachments.winch.body=left", "one [structure]"),
                          ("attachments.winch.solver=./gone.py", "there is no file"), ("fluid.solver=none", "a fluid and a structure"),
                          ("coupling.interface=volume", "attached to its points"), ("attachments.winch.colour=1", "not a key")):
        done = strake("check", "floor.toml", "--set", change, cwd=place)
        expect(done.returncode == 3 and words in done.stderr, f"{change}: {done.returncode} {done.stderr[:300]}")
    done = strake("check", "two.toml", "--set", "attachments.winch.body=centre", cwd=place)
    expect(done.returncode == 3 and "one of the bodies left, right" in done.stderr, "a body that is not there: " + done.stderr[:200])
    done = strake("check", ROOT / "cases" / "moored_box.toml", "--set", "attachments.mooring.catenary.anchor=[[0,0]]", cwd=place)
    expect(done.returncode == 3 and "one for each of the 2 points" in done.stderr, "anchors that do not fit: " + done.stderr[:200])
finish()
