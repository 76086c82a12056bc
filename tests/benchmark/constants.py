"""What a change of 20 % in each tuned number of the least-squares scheme changes.

usage: tests/benchmark/constants.py BUILD_DIR [--only NAME]… [--factor F]… [--case NAME]… [--jobs N] [--keep DIR]
       (a build with -DSTRAKE_BENCHMARKS=ON, target strake-fluid-constants; default: 0.8 and 1.2, every number, four cases)
Runs four shipped cases with strake-fluid-constants (fluid/changed_constant.cpp) in the place of strake-fluid and prints, for each
number of fluid/least_squares/constants.hpp, the change of each figure in per cent of its value without a change:
  still tank    noise of the pressure at the floor; its mean; level of the water (1 s)
  wedge         mean of the force over the last fifth of 8 ms, and its rms about a line through it
  plate, rigid  impulse at the middle over 300 us; largest pressure there; impulse of the whole force, all to 2.4 ms
  dam break     place of the front and height at the wall at the end; largest count of voids
The row "rounding" changes longest_shift by 1e-12 of itself: what it shows is the scatter of a figure, and no smaller change of
another row counts. A row of zeros is a number that these cases do not read or that bounds what never happens in them."""
import concurrent.futures
import math
import os
import pathlib
import re
import shutil
import tempfile

import runs

CASES = {
    "still_tank": ["end_time=1"],
    "wedge_entry": ["end_time=0.008"],
    "plate_entry": ["structure.solver=rigid", "end_time=2.4e-3"],
    "dam_break": [],
}


def constants():
    """Name, value and comment of each number, in the order of the header."""
    text = (runs.ROOT / "fluid" / "least_squares" / "constants.hpp").read_text(encoding="utf-8")
    return re.findall(r"^  double (\w+) = ([-+.e\d]+);\s*// (.*)$", text, re.MULTILINE)


def about_a_line(times, values):
    slope, mt, mv = runs.fit_slope(times, values), sum(times) / len(times), sum(values) / len(values)
    return math.sqrt(sum((v - mv - slope * (t - mt)) ** 2 for t, v in zip(times, values)) / len(values))


def impulse(run, name, until=math.inf):
    """Over time from the moment at which it first passes a hundredth of its largest value."""
    times, values = run["time"], run[name]
    first = next(k for k, v in enumerate(values) if abs(v) > 0.01 * max(map(abs, values)))
    return sum(v * (b - a) for a, b, v in zip(times[first:], times[first + 1:], values[first + 1:]) if b <= times[first] + until)


def figures(case, run):
    if case == "still_tank":
        late = [p for t, p in zip(run["time"], run["p_bottom"]) if t >= 0.5]
        mean = sum(late) / len(late)
        return {"noise": math.sqrt(sum((p - mean) ** 2 for p in late) / len(late)), "mean p": mean, "level": run["height"][-1]}
    if case == "wedge_entry":
        kept = [k for k, t in enumerate(run["time"]) if t > 0.0065]
        times, forces = [run["time"][k] for k in kept], [run["force.y"][k] for k in kept]
        return {"force": sum(forces) / len(forces), "rms": about_a_line(times, forces)}
    if case == "plate_entry":
        return {"p impulse": impulse(run, "p_mid", 3e-4), "p largest": max(run["p_mid"]), "F impulse": impulse(run, "force.y")}
    voids = run.summary["checks"].get("voids")
    return {"front": run["front"][-1], "height": run["height"][-1], "voids": math.nan if voids is None else float(voids)}


def one(bin_dir, case, change, sets):
    environment = {**os.environ, "STRAKE_CONSTANT": change} if change else None
    run = runs.run(bin_dir, runs.ROOT / "cases" / f"{case}.toml", [*CASES[case], *sets], environment)
    return {f"{case.split('_')[0]} {name}": value for name, value in figures(case, run).items()}


def against(value, base):
    if not math.isfinite(value) or not base:
        return "same" if value == base else f"{value:.3g}"
    change = 100 * (value / base - 1)
    return "0" if value == base else f"{change:+.1e}" if abs(change) < 0.01 else f"{change:+.2f}"


def main():
    parser = runs.command(__doc__, keeps=True)
    parser.set_defaults(bin_dir=runs.ROOT / "build")
    names = [name for name, _, _ in constants()]
    parser.add_argument("--only", action="append", choices=names, metavar="NAME")
    parser.add_argument("--factor", action="append", type=float)
    parser.add_argument("--case", action="append", choices=CASES)
    parser.add_argument("--jobs", type=int, default=2)
    arguments = parser.parse_args()
    changes = ["longest_shift 1.000000000001"]
    changes += [f"{name} {factor!r}" for name in arguments.only or names for factor in arguments.factor or (0.8, 1.2)]
    cases = arguments.case or list(CASES)
    with tempfile.TemporaryDirectory() as place, concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        bin_dir = pathlib.Path(place) / "bin"
        bin_dir.mkdir()
        for program in ("strake", "strake-structure-rigid"):
            shutil.copy(arguments.bin_dir / "bin" / program, bin_dir)
        shutil.copy(arguments.bin_dir / "tests" / "strake-fluid-constants", bin_dir / "strake-fluid")
        jobs = {change: [pool.submit(one, bin_dir, case, change, arguments.set) for case in cases] for change in ["", *changes]}
        base = {name: value for job in jobs[""] for name, value in job.result().items()}
        table = runs.Table([("number", 16), ("is", 8), ("times", 8), *((name, 7) for name in base)])
        table.row("unchanged", "", "", *(f"{value:.5g}" for value in base.values()))
        values = {name: value for name, value, _ in constants()}
        for change in changes:
            name, factor = change.split()
            shown = ("rounding", "", "") if change == changes[0] else (name, values[name], factor)
            got = {key: value for job in jobs[change] for key, value in job.result().items()}
            table.row(*shown, *(against(got[key], base[key]) for key in base))
            table.keep(arguments.keep, "constants.csv")


main()
