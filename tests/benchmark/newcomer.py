"""Cases that a newcomer would write, drawn by chance and run at defaults: does each end with sane figures, or with a refusal that says why?

usage: tests/benchmark/newcomer.py [BIN_DIR] [--cases N] [--first K] [--seed S] [--limit SECONDS] [--show K]
       (default: build/bin, 30 cases from number 0 of the seed 2026, at most 600 s each: half an hour)
Drawn are the shape (wedge, cylinder, flat plate, inclined box; sphere and wedge in space), angle and speed, a free body with its mass or a
driven one, and the start above the water or in it. So are the spacing (6 to 30 to half the body's breadth), the sound speed (default or
incompressible) and the solver (rigid; fem or particle for plates). Nothing else is set. Each case runs to 10 ms.

A case is sane when it ends with exit 0 and
  force   the vertical impulse of the water on a driven body that enters by more than a spacing is between 0.4 and 2.5 of theory (below), and positive;
  side    the sideways impulse of a symmetric body is at most a fifth of the vertical one;
  speed   no particle is faster than the guard's bound (an alarm says so);
or when it ends with exit 3, a refusal. An alarm is printed with its cause, for the reader to judge.
Theory: added mass m_a V with m_a = pi/2 rho c^2 in the plane, 4/3 rho c^3 of a disc, 0.57/2 of a plate as long as wide; c the half of the
wetted width: a of a plate, pi/2 h/tan(angle) of a wedge (Wagner 1932), sqrt(4 R h) of a cylinder, sqrt(3 R h) of a sphere, h = V t less the gap.
A wedge has the share of Wagner's force that the similarity flow leaves (similarity.py; 0.86, 0.61, 0.31 at 10, 30, 60 degrees).
Plates, and wedges once their jets pass the chines, have 1 + 2.82 (h/a)^(2/3) times that, h since then: the flow round the edges (plate_edge.py).
It is an estimate that tells nonsense from a result, not a reference."""
import json
import math
import pathlib
import random
import subprocess
import tempfile
import time

import runs

END = 0.01


def text_of(value):
    if isinstance(value, (bool, str, list)):
        return json.dumps(value)
    return "inf" if value == math.inf else repr(value)


def draw(number, seed):
    """Case `number` of a seed: its text, its name, and what is known of it."""
    chance = random.Random(f"{seed} {number}")
    shape = chance.choice(["wedge", "wedge", "cylinder", "cylinder", "plate", "plate", "box", "sphere", "wedge in space"])
    a, speed = chance.choice([0.05, 0.1, 0.25, 0.5]), round(chance.uniform(1, 10), 1)
    space = shape in ("sphere", "wedge in space")
    part = chance.choice([6, 8] if space else [8, 12, 20, 30])
    spacing = a / part
    angle = chance.choice([5, 10, 15, 20, 30, 45, 60])
    free, submerged = chance.random() < 0.4, shape in ("cylinder", "box") and chance.random() < 0.3
    solver = chance.choice(["rigid", "fem", "particle"]) if shape == "plate" else "rigid"
    gap = 0.0 if submerged else min(0.1 * spacing * chance.randint(3, 30), 0.3 * speed * END)
    wide, deep = (3, 2) if space else (5, 3)
    low, high = [-wide * a, -deep * a], [wide * a, 1.5 * a]
    body = {}
    structure = {"solver": solver}
    if shape.startswith("wedge"):
        body = {"wedge": {"deadrise": angle, "width": 2 * a, "apex": [0, gap]}}
        if space:
            structure["depth"], body["wedge"]["apex"] = 2 * a, [0, gap, 0]
    elif shape in ("cylinder", "sphere"):
        centre = [0, -1.5 * a if submerged else a + gap] + ([0] if space else [])
        body = {shape: {"radius": a if not submerged else 0.5 * a, "centre": centre}}
    elif shape == "plate":
        body = {"plate": {"length": 2 * a, "thickness": max(0.05 * a, 1.5 * spacing), "bottom": [0, gap]}}
        if solver != "rigid":
            body["plate"]["supports"] = {"left": "clamped", "right": "clamped"}
            free = False
    else:
        turn = math.radians(angle if angle < 45 else 20)
        corners = [(-0.5, -0.3), (0.5, -0.3), (0.5, 0.3), (-0.5, 0.3)]
        turned = [(a * (x * math.cos(turn) - y * math.sin(turn)), a * (x * math.sin(turn) + y * math.cos(turn))) for x, y in corners]
        lowest = min(y for _, y in turned)
        lift = -1.2 * a if submerged else gap - lowest
        structure["outline"] = [[round(x, 6), round(y + lift, 6)] for x, y in turned]
    if not submerged:
        structure["velocity"] = [0, -speed] + ([0] if space else [])
    if free:
        structure["mass"] = round(1000 * (a**3 if space else a**2) * chance.choice([0.5, 1, 3]), 4)
        body["free"] = {"y": True}
    fluid = {"dimension": 3 if space else 2, "spacing": spacing}
    if chance.random() < 0.3:
        fluid["sound_speed"] = math.inf
    cut = (lambda p: [p[0], p[1], p[0]]) if space else (lambda p: p)
    fluid["tank"], fluid["water"] = [cut(low), cut(high)], [cut(low), cut([high[0], 0.0])]
    if submerged:
        fluid["submerged"] = True
    lines = [f'title = "newcomer {number}"', f"end_time = {END}", "[fluid]"]
    lines += [f"{k} = {text_of(v)}" for k, v in fluid.items()]
    lines += ["[structure]"] + [f"{k} = {text_of(v)}" for k, v in structure.items()]
    for name, keys in body.items():
        lines += [f"[structure.{name}]"] + [f"{k} = {text_of(v)}" for k, v in keys.items() if not isinstance(v, dict)]
        for inner, more in keys.items():
            if isinstance(more, dict):
                lines += [f"[structure.{name}.{inner}]"] + [f"{k} = {text_of(v)}" for k, v in more.items()]
    words = f"{shape}{f' {angle} deg' if 'wedge' in shape or shape == 'box' else ''}, a {a:g} m, l0 a/{part}, " + (
        "submerged" if submerged else f"{speed:g} m/s") + (", free" if free else "") + (", c inf" if "sound_speed" in fluid else "") + f", {solver}"
    return "\n".join(lines) + "\n", words, (shape, a, speed, angle, gap, free, submerged, solver, spacing)


def theory(known):
    """Impulse of the water on a driven body after 10 ms [N s per metre, N s], or None."""
    shape, a, speed, angle, gap, free, submerged, solver, spacing = known
    depth = speed * END - gap
    if free or submerged or depth <= spacing or shape == "box" or solver != "rigid":
        return None
    half = {"plate": a, "cylinder": math.sqrt(max(0, 4 * a * depth)), "sphere": math.sqrt(max(0, 3 * a * depth))}.get(
        shape, 0.5 * math.pi * depth / math.tan(math.radians(angle)))
    half = min(half, a)
    if shape == "sphere":
        return 4 / 3 * 1000 * half**3 * speed
    past = {"plate": depth, "cylinder": 0}.get(shape, max(0.0, depth - 2 / math.pi * a * math.tan(math.radians(angle))))
    growth = 1 + 2.82 * (past / a) ** (2 / 3)
    if "wedge" in shape:
        growth *= 1 - 0.0145 * angle + 5e-5 * angle**2  # the similarity flow over Wagner's, within 0.01 from 5 to 60 degrees
    return growth * 0.5 * math.pi * 1000 * half**2 * speed * (1 if shape != "wedge in space" else 2 * a / (1 + half / a))


def alarms_of(summary):
    return [f"{alarm.get('kind', alarm.get('cause', 'alarm'))}" if isinstance(alarm, dict) else str(alarm) for alarm in summary.get("alarms") or []]


def judge(text, known, bin_dir, limit):
    """Runs one case; returns verdict and figures."""
    with tempfile.TemporaryDirectory() as place:
        (pathlib.Path(place) / "case.toml").write_text(text)
        begun = time.monotonic()
        try:
            done = subprocess.run([str(bin_dir.resolve() / "strake"), "run", "case.toml", "--quiet", "--set", "run.threads=1"], cwd=place,
                                  capture_output=True, text=True, env={"PATH": "/usr/bin:/bin", "HOME": place, **runs.ENVIRONMENT}, timeout=limit)
        except subprocess.TimeoutExpired:
            return "NO", f"no end within {limit:g} s", ""
        seconds = time.monotonic() - begun
        if done.returncode == 3:
            return "refused", " ".join(done.stderr.split())[:160], ""
        if done.returncode != 0:
            return "NO", f"exit {done.returncode}: " + " ".join(done.stderr.split())[:160], ""
        run = runs.Run(pathlib.Path(place) / "runs" / "case")
        t = run["time"]
        step = [t[0]] + [later - sooner for sooner, later in zip(t, t[1:])]
        vertical, sideways = (sum(f * dt for f, dt in zip(run[name], step)) for name in ("force.y", "force.x"))
        figures = f"impulse {vertical:.4g}, sideways {sideways:.2g}, largest {max(run['force.y']):.4g}, fastest {max(run['water.largest_speed']):.1f} m/s, {seconds:.0f} s"
        wrong, expected = [], theory(known)
        if expected is not None:
            figures = f"{vertical / expected:.2f} of theory, " + figures
            if not 0.4 < vertical / expected < 2.5:
                wrong.append("force")
        if known[0] != "box" and abs(sideways) > 0.2 * abs(vertical) and abs(vertical) > 0:
            wrong.append("side")
        return ("NO: " + ", ".join(wrong) if wrong else "sane"), figures, "; ".join(alarms_of(run.summary))


def main():
    parser = runs.command(__doc__)
    parser.add_argument("--cases", type=int, default=30)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--seed", type=int, default=2026)
    parser.add_argument("--limit", type=float, default=600)
    parser.add_argument("--show", type=int, metavar="K", help="print the case file of number K and end")
    arguments = parser.parse_args()
    if arguments.show is not None:
        print(draw(arguments.show, arguments.seed)[0], end="")
        return
    counts = {}
    for number in range(arguments.first, arguments.first + arguments.cases):
        text, words, known = draw(number, arguments.seed)
        verdict, figures, alarms = judge(text, known, arguments.bin_dir, arguments.limit)
        counts[verdict.split(":")[0]] = counts.get(verdict.split(":")[0], 0) + 1
        print(f"{number:3d}  {verdict:12s} {words}: {figures}" + (f"  ALARM {alarms}" if alarms else ""), flush=True)
    print(", ".join(f"{count} {name}" for name, count in sorted(counts.items())))


if __name__ == "__main__":
    main()
