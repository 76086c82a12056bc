"""The paper's plate, rigid, against potential flow and linear acoustics; and what the turbulence model changes for the elastic one.

usage: tests/benchmark/plates.py [BIN_DIR] [--part spacing|steps|turbulence]… [--spacing L0]… [--speed V]… [--at-once N]
                                 [--set KEY=VALUE]… [--keep DIR]
       (default: build/bin, all parts, spacings 0.02 0.01 0.005 m, speeds 1.98 3.13 4.23 4.43 6.26 m/s, two runs at a time)
Each run is cases/plate_entry.toml, coupled at every fluid step, from a gap of 1.2 l0 to 30 us past the longest average.
  spacing     6.26 m/s at each spacing: c = inf at steps of 1e-4 and 1e-5 s, c = 1500 m/s at 2e-6 s
  steps       c = 1500 m/s at the finest spacing: every speed at steps of 5e-6, 2e-6 and 5e-7 s
  turbulence  fem plate, 6.26 m/s, l0 = 0.01 m: model none, static and k up to the first peak of the deflection
Measured at the middle of the plate's lower face over a sensor of 2 l0 (cases/VALIDATION.md). t_c is the first step in which the pressure
exceeds rho V^2/2. The impulse is the integral of p over every step since t_c; the peak is the largest mean over 50 us. References are
theory, not experiment (cases/VALIDATION.md). Incompressible (plate_edge.py): 1.0338 rho V a at contact in this tank, and 1.55 (V t/a)^(2/3)
more as the water flows round the edges. With sound (linear_plate.py): rho c V until a/c = 133 us, 0.9975 rho V a after 133 us, 1.264 rho V a
after 300 us, 0.2556 mm per m/s of mid deflection. 4.43 m/s is the speed after a fall of 1 m; the paper's 4.23
is probably a misprint of it."""
import math

import drawing
import runs

DENSITY, HALF, SOUND = 1000.0, 0.2, 1500.0  # kg/m^3, m, m/s
SPEED = 6.26                                # m/s
CASE = runs.ROOT / "cases" / "plate_entry.toml"


def entry(l0, speed, sound, step, after=3.3e-4, solver="rigid"):
    """A run of plate_entry that ends so long after contact [s], as a case and its settings."""
    gap = 1.2 * l0
    window = step if solver == "rigid" else 5 * step
    # Before contact the first layer of the water may rise, or yield, by a few hundredths of the gap.
    end = math.ceil((1.03 * gap / speed + after) / window) * window
    return CASE, [f"fluid.spacing={l0!r}", f"fluid.sound_speed={sound!r}", f"fluid.scheme.time_step={step!r}",
                  f"structure.solver={solver}", f"structure.velocity=[0,{-speed!r},0]", f"structure.plate.bottom=[0,{gap!r},0]",
                  f"output.probe[0].at=[0,{gap!r},0]", f"output.probe[1].at=[0,{gap!r},0]", f"output.probe[1].diameter={2 * l0!r}",
                  f"coupling.surface.window={window!r}", f"end_time={end!r}", f"output.every={end!r}", "run.threads=1"]


class Impact:
    """Pressure of the sensor at mid-span, in rho V a and rho c V. `series`: time since contact [s] and pressure [Pa]."""

    def __init__(self, run, speed):
        scale = DENSITY * speed * HALF
        self.at_once = math.nan  # impulse of the step of contact
        times, impulses = run["time"], run["p_mid.impulse"]
        met = next((k for k, value in enumerate(impulses) if value), None)
        self.contact = math.nan if met is None else times[met - 1]
        self.series = [] if met is None else [(t - self.contact, p) for t, p in zip(times, run["p_mid"])][met - 1:]
        if met is not None:
            self.at_once = impulses[met] / scale
        since = [0.0] + [t - self.contact for t in times[met or 0:]]
        sums = [0.0] + impulses[met or 0:]
        self.at = {}
        for after in (133e-6, 300e-6):
            k = next((k for k, t in enumerate(since) if t >= after * (1 - 1e-9)), None)
            share = (after - since[k - 1]) / (since[k] - since[k - 1]) if k else math.nan
            self.at[after] = (sums[k - 1] + share * (sums[k] - sums[k - 1])) / scale if k else math.nan
        hammer = DENSITY * SOUND * speed
        self.mean = run.probe("p_mid", "mean_peak_50us") / hammer
        self.first = run.probe("p_mid", "first_peak") / hammer
        self.gap = run.summary["checks"]["momentum_gap"]
        self.cost = run.summary["seconds"]["wall"]


def judged(value, reference, tolerance):
    """Deviation in per cent and whether it lies within the gate."""
    return runs.off(value, reference), f"{100 * tolerance:g} %", "yes" if abs(value / reference - 1) <= tolerance else "NO"


def spacing_table(arguments):
    print("\nRigid plate at 6.26 m/s: impulse in rho V a, 50-us mean in rho c V")
    table = runs.Table([("l0 [m]", 6), ("c [m/s]", 7), ("step [s]", 8), ("quantity", 22), ("measured", 8), ("reference", 9),
                        ("off", 8), ("gate", 5), ("met", 3), ("kind and source of the reference", 40), ("wall [s]", 6)])
    cases = [(l0, sound, step) for l0 in arguments.spacing for sound, step in ((math.inf, 1e-4), (math.inf, 1e-5), (SOUND, 2e-6))]
    jobs = [(case, sets + arguments.set) for case, sets in (entry(l0, SPEED, sound, step) for l0, sound, step in cases)]
    picture = drawing.Drawing("Rigid plate, 6.26 m/s, c = 1500 m/s: pressure at mid-span", "time since contact [us]",
                              "p / (rho c V) [1]", (-10, 320), (-0.2, 1.4))
    picture.line([-10, 0, 0, 133.3], [0, 0, 1, 1], "theory: rho c V until a/c", "#444444", dashed=True)
    for (l0, sound, step), run in zip(cases, runs.run_all(arguments.bin_dir, jobs, arguments.at_once)):
        impact, head = Impact(run, SPEED), (f"{l0:g}", f"{sound:g}", f"{step:g}")
        cost = f"{impact.cost:.0f}"
        if sound == math.inf:
            grown = 1.0338 + 1.55 * (SPEED * 300e-6 / HALF) ** (2 / 3)
            for name, value, reference in (("impulse, contact's step", impact.at_once, 1.0338), ("impulse at 300 us", impact.at[300e-6], grown)):
                table.row(*head, name, f"{value:.3f}", f"{reference:.4f}", *judged(value, reference, 0.05),
                          "theory: potential flow", cost)
            continue
        for after, reference in ((133e-6, 0.9975), (300e-6, 1.264)):
            value = impact.at[after]
            table.row(*head, f"impulse at {1e6 * after:.0f} us", f"{value:.3f}", f"{reference:g}", *judged(value, reference, 0.08),
                      "theory: linear acoustics", cost)
        table.row(*head, "50-us mean, first peak", f"{impact.mean:.3f}", "1", *judged(impact.mean, 1, 0.10),
                  "theory: rho c V until a/c", cost)
        table.row(*head, "single step, first peak", f"{impact.first:.3f}", "1", runs.off(impact.first, 1), "", "",
                  "theory: rho c V until a/c", cost)
        picture.line([1e6 * t for t, _ in impact.series], [p / (DENSITY * SOUND * SPEED) for _, p in impact.series],
                     f"l0 = {1000 * l0:g} mm", drawing.COLOURS[arguments.spacing.index(l0) % len(drawing.COLOURS)])
    table.keep(arguments.keep, "plates-spacing.csv")
    if arguments.keep:
        picture.write(arguments.keep / "plates-spacing.svg")


def steps_table(arguments):
    l0, steps = min(arguments.spacing), (5e-6, 2e-6, 5e-7)
    print(f"\nRigid plate, c = 1500 m/s, l0 = {l0:g} m: 50-us mean of the first peak over rho c V [1], its spread over the steps\n"
          "(gates: 10 % of 1; 3 % between steps), impulses in rho V a (theory 0.9975 and 1.264; gate 8 %)")
    table = runs.Table([("V [m/s]", 7), *((f"mean, {s:g}", 11) for s in steps), ("spread", 7), ("met", 7),
                        *((f"{a} us, {s:g}", 13) for a in (133, 300) for s in steps), ("met", 7),
                        *((f"1 step, {s:g}", 13) for s in steps)])
    jobs = [(case, sets + arguments.set) for case, sets in (entry(l0, v, SOUND, s) for v in arguments.speed for s in steps)]
    results = runs.run_all(arguments.bin_dir, jobs, arguments.at_once)
    picture = drawing.Drawing(f"Rigid plate, c = 1500 m/s, l0 = {1000 * l0:g} mm, steps of 2e-6 s: mid-span", "time since contact [us]",
                              "p / (rho c V) [1]", (-10, 320), (-0.2, 1.6))
    picture.line([-10, 0, 0, 133.3], [0, 0, 1, 1], "theory: rho c V until a/c", "#444444", dashed=True)
    for speed, colour in zip(arguments.speed, drawing.COLOURS):
        impacts = [Impact(next(results), speed) for _ in steps]
        means = [i.mean for i in impacts]
        spread = max(means) / min(means) - 1
        met = "yes" if max(abs(m - 1) for m in means) <= 0.10 and spread <= 0.03 else "NO"
        late = [i.at[after] for after in (133e-6, 300e-6) for i in impacts]
        held = all(abs(v / r - 1) <= 0.08 for v, r in zip(late, 3 * [0.9975] + 3 * [1.264]))
        table.row(f"{speed:g}", *(f"{m:.3f}" for m in means), f"{100 * spread:.1f} %", met, *(f"{v:.3f}" for v in late),
                  "yes" if held else "NO", *(f"{i.first:.3f}" for i in impacts))
        picture.line([1e6 * t for t, _ in impacts[1].series],
                     [p / (DENSITY * SOUND * speed) for _, p in impacts[1].series], f"{speed:g} m/s", colour)
    table.keep(arguments.keep, "plates-steps.csv")
    if arguments.keep:
        picture.write(arguments.keep / "plates-steps.svg")


def turbulence_table(arguments):
    print("\nElastic plate (fem), 6.26 m/s, l0 = 0.01 m, c = 1500 m/s: what the turbulence model changes (gate: less than 1 %)")
    table = runs.Table([("model", 8), ("first p [MPa]", 13), ("change", 9), ("50-us mean [MPa]", 16), ("change", 9),
                        ("impulse [Pa s]", 14), ("change", 9), ("first deflection [mm]", 21), ("change", 9),
                        ("theory 1.600 mm", 30)])
    models = ("none", "static", "k")
    jobs = [(case, [*sets, f"fluid.scheme.turbulence.model={model}", *arguments.set])
            for model in models for case, sets in (entry(0.01, SPEED, SOUND, 2e-6, after=9e-4, solver="fem"),)]
    without = None
    for model, run in zip(models, runs.run_all(arguments.bin_dir, jobs, arguments.at_once)):
        figures = [run.probe("p_mid", "first_peak"), run.probe("p_mid", "mean_peak_50us"), run.probe("p_mid", "impulse"),
                   run.probe("mid.y", "first_peak")]
        without = without or figures
        changes = ["" if model == "none" else f"{100 * (f / w - 1):+.4f} %" for f, w in zip(figures, without)]
        shown = [f"{figures[0] / 1e6:.3f}", f"{figures[1] / 1e6:.3f}", f"{figures[2]:.1f}", f"{1000 * figures[3]:.4f}"]
        table.row(model, *(cell for pair in zip(shown, changes) for cell in pair), runs.off(figures[3], 1.600e-3))
    table.keep(arguments.keep, "plates-turbulence.csv")


PARTS = {"spacing": spacing_table, "steps": steps_table, "turbulence": turbulence_table}
parser = runs.command(__doc__, keeps=True)
parser.add_argument("--part", action="append", choices=PARTS)
parser.add_argument("--spacing", type=float, action="append", metavar="L0")
parser.add_argument("--speed", type=float, action="append", metavar="V")
parser.add_argument("--at-once", type=int, default=2, metavar="N")
arguments = parser.parse_args()
arguments.spacing = arguments.spacing or [0.02, 0.01, 0.005]
arguments.speed = arguments.speed or [1.98, 3.13, 4.23, 4.43, 6.26]
for part in arguments.part or PARTS:
    PARTS[part](arguments)
