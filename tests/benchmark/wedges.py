"""Wedges at constant speed into still water without gravity, beside the similarity solution of each deadrise.

usage: tests/benchmark/wedges.py [BIN_DIR] [--deadrise DEG]… [--across N] [--step S] [--threads N] [--set KEY=VALUE]… [--keep DIR]
       (default: build/bin, 10 20 30 40 60 degrees, 100 spacings per half wetted width, steps of 0.06 l0/V)
Prints for each angle, over the last 20 % of growth:
  K        slope of F against t over rho V^3 (least squares), as in cases/VALIDATION.md, "Wedge entry: similarity flow"
  +-       its standard error from the scatter about that line, over the exact K: what one run can tell
  F/t      mean of F/(rho V^3 t), t from the moment the apex meets the still level
  rms      of F/(rho V^3 t) about its mean, over the mean
  Cp       largest mean of p/(rho V^2/2) over bins of z/(V t), without 3 l0 at the apex, and its place. Above 40 degrees theory
           has it at the apex. There the line through the bins of the lower half is extrapolated to the apex over
           s^(2 pi/angle - 2), as in the flow in the water's corner; s from the apex, angle = deadrise + 90 degrees
  flank    length of the exact pressure's fall from 0.9 to 0.1 of its largest, in spacings, at the end: below 3 no Cp is resolved
  sides    difference of the mean force on the two faces' horizontal parts over the vertical force
  gap      |momentum of water - impulses| over the vertical impulse on the body
and writes to DIR the table (wedges.csv), the distribution of pressure (wedge-DEG.csv: z/Vt [1], Cp [1], Cp of theory at the same height
[1]) and its picture over the similarity curve (wedge-DEG.svg), the force against time (wedge-DEG-force.csv). Reference: theory, exact
similarity flow for water without bounds (similarity.py, which needs numpy: Dobrovol'skaya's problem; cases/VALIDATION.md). The tank is
twelve half wetted widths long each side of the wedge and ten deep; half of that adds 4 % to the force at 40 degrees."""
import math

import similarity  # first: it says what is missing where numpy is
import numpy

import drawing
import runs

SPEED, DENSITY, HALF = 10.0, 1000.0, 1.0  # m/s, kg/m^3, half wetted width at the end [m]
PROBES = 60
BIN = 0.02                                # of z/(V t)


def case(deadrise, l0, exact, step, threads):
    slope = math.tan(math.radians(deadrise))
    reach = 1 + max(0.0, exact.largest[1])    # of the largest pressure over the apex, in V t
    depth = HALF * slope / reach              # V t at the end
    gap = 0.5 * l0
    width = 2 * HALF * 1.5
    tank, floor = round(12 * HALF / l0) * l0, round(10 * HALF / l0) * l0
    rim = round((0.5 * width * slope + gap + 1.0) / l0) * l0
    step *= l0 / SPEED
    end = round((depth + gap) / SPEED / step) * step  # a short last step would show what the others leave, over its own length
    text = f"""title = "wedge benchmark"
preset = "improved"
end_time = {end!r}
[fluid]
dimension = 2
spacing = {l0!r}
density = {DENSITY}
kinematic_viscosity = 0.0
sound_speed = inf
gravity = [0.0, 0.0, 0.0]
tank = [[{-tank!r}, {-floor!r}, 0.0], [{tank!r}, {rim!r}, 0.0]]
water = [[{-tank!r}, {-floor!r}, 0.0], [{tank!r}, 0.0, 0.0]]
[fluid.scheme]
time_step = {step!r}
[structure]
solver = "rigid"
velocity = [0.0, {-SPEED}, 0.0]
[structure.wedge]
deadrise = {deadrise}
width = {width!r}
apex = [0.0, {gap!r}, 0.0]
[coupling.surface]
window = {step!r}
[run]
threads = {threads}
[output]
every = {end!r}
"""
    for k, height in enumerate(probe_heights(slope)):
        text += f"""[[output.probe]]
name = "p{k:02d}"
of = "fluid"
at = [{height / slope!r}, {gap + height!r}, 0.0]
quantity = "pressure"
diameter = {2 * l0!r}
"""
    return text, gap / SPEED, slope


def probe_heights(slope):
    """Over the apex [m], along the right face."""
    return [1.2 * HALF * (k + 0.5) / PROBES * slope for k in range(PROBES)]


def pressure_curve(run, heights, kept, met, lowest):
    """Means of Cp over bins of z/(V t), from the kept lines of the history. Probes lower than `lowest` over the apex are
    left out."""
    bins = {}
    for k, height in enumerate(heights):
        if height < lowest:
            continue
        pressure = run[f"p{k:02d}.mean"]
        for row in kept:
            z = height / (SPEED * (run["time"][row] - met)) - 1
            bins.setdefault(round(z / BIN), []).append(pressure[row] / (0.5 * DENSITY * SPEED**2))
    return sorted((BIN * b, sum(v) / len(v)) for b, v in bins.items() if len(v) >= 10)


def carried_to_apex(curve, deadrise):
    """Cp at the apex: least-squares line of Cp over (z + 1)^(2 pi/angle - 2), z < -0.5."""
    power = 2 * math.pi / math.radians(deadrise + 90) - 2
    low = [(z, cp) for z, cp in curve if z < -0.5]
    arms, values = [(z + 1) ** power for z, _ in low], [cp for _, cp in low]
    return sum(values) / len(values) - runs.fit_slope(arms, values) * sum(arms) / len(arms)


def flank(deadrise, exact):
    """Along the face, in V t."""
    after = [(p, z) for p, z in zip(exact.pressure[::-1], exact.height[::-1]) if z > exact.largest[1]]
    place = lambda share: next(z for p, z in after if p < share * exact.largest[0])
    return (place(0.1) - place(0.9)) / math.sin(math.radians(deadrise))


def keep_curve(folder, name, deadrise, across, curve, exact):
    folder.mkdir(parents=True, exist_ok=True)
    theory = numpy.interp([z for z, _ in curve], exact.height[::-1], exact.pressure[::-1], right=0.0)
    with (folder / f"{name}.csv").open("w", encoding="utf-8") as file:
        file.write("z/Vt [1],Cp [1],Cp theory [1]\n" + "".join(f"{z:.3f},{c:.4g},{t:.4g}\n" for (z, c), t in zip(curve, theory)))
    picture = drawing.Drawing(f"Wedge of {deadrise:g} degrees: pressure along the face", "height over the still level, z / (V t) [1]",
                              "p / (rho V^2 / 2) [1]", (-1.0, 1.05 * exact.tip), (0.0, 1.25 * exact.largest[0]))
    picture.line(exact.height, exact.pressure, "theory: exact similarity flow (Dobrovol'skaya's problem)", "#444444")
    picture.points([z for z, _ in curve], [c for _, c in curve],
                   f"particles, {across} spacings per half wetted width, mean over the last fifth", drawing.COLOURS[1])
    picture.write(folder / f"{name}.svg")


def keep_force(folder, name, run, met):
    with (folder / f"{name}-force.csv").open("w", encoding="utf-8") as file:
        file.write("t [s],F/(rho V^3) [s]\n" + "".join(
            f"{t - met:.6g},{f / (DENSITY * SPEED**3):.6g}\n" for t, f in zip(run["time"], run["force.y"])))


def main():
    parser = runs.command(__doc__, keeps=True)
    parser.add_argument("--deadrise", type=float, action="append")
    parser.add_argument("--across", type=int, default=100)
    parser.add_argument("--step", type=float, default=0.06)
    parser.add_argument("--threads", type=int, default=2)
    arguments = parser.parse_args()
    for deadrise in arguments.deadrise or []:
        if not 4 <= deadrise <= 81:
            parser.error(f"--deadrise {deadrise:g}: expected 4 to 81 degrees, where the similarity solution is known well")
    table = runs.Table([("deadrise", 8), ("K", 7), ("exact", 7), ("off", 8), ("+-", 6), ("F/t", 7), ("off", 8), ("rms", 5), ("Cp", 6),
                        ("exact", 6), ("off", 8), ("z/Vt", 5), ("exact", 5), ("flank", 5), ("sides", 7), ("gap", 7), ("particles", 9), ("wall [s]", 8)])
    l0 = HALF / arguments.across
    for deadrise in arguments.deadrise or [10.0, 20.0, 30.0, 40.0, 60.0]:
        exact = similarity.SimilarFlow(deadrise)
        text, met, slope = case(deadrise, l0, exact, arguments.step, arguments.threads)
        run = runs.run(arguments.bin_dir, text, arguments.set)
        growth = run["time"][-1] - met
        kept = [row for row, t in enumerate(run["time"]) if t > met + 0.8 * growth]
        times = [run["time"][row] - met for row in kept]
        force = [run["force.y"][row] / (DENSITY * SPEED**3) for row in kept]
        side = sum(run["force.x"][row] for row in kept) / sum(run["force.y"][row] for row in kept)
        mean = sum(f / t for f, t in zip(force, times)) / len(kept)
        rms = math.sqrt(sum((f / t - mean) ** 2 for f, t in zip(force, times)) / len(kept))
        curve = pressure_curve(run, probe_heights(slope), kept, met, 3 * l0 * math.sin(math.radians(deadrise)))
        z_at, cp = max(curve, key=lambda point: point[1])
        steep = f"{flank(deadrise, exact) * SPEED * times[-1] / l0:.1f}"
        if exact.largest[1] < -0.999:
            z_at, cp, steep = -1.0, carried_to_apex(curve, deadrise), ""
        if arguments.keep:
            keep_curve(arguments.keep, f"wedge-{deadrise:g}", deadrise, arguments.across, curve, exact)
            keep_force(arguments.keep, f"wedge-{deadrise:g}", run, met)
        k = runs.fit_slope(times, force)
        gap = run.summary["checks"]["momentum_gap"]
        table.row(f"{deadrise:g}", f"{k:.2f}", f"{exact.force:.2f}", runs.off(k, exact.force), f"{100 * runs.slope_error(times, force) / exact.force:.0f} %", f"{mean:.2f}",
                  runs.off(mean, exact.force), f"{rms / mean:.2f}", f"{cp:.2f}", f"{exact.largest[0]:.2f}",
                  runs.off(cp, exact.largest[0]), f"{z_at:.2f}", f"{exact.largest[1]:.2f}", steep, f"{side:.3f}",
                  "unknown" if gap is None else f"{gap:.4f}", f"{run.summary['particles']['fluid']}",
                  f"{run.summary['seconds']['wall']:.0f}")
        table.keep(arguments.keep, "wedges.csv")


main()
