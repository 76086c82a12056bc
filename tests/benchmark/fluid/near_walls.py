"""Wedges that enter between near walls and over a near floor, beside Wagner's theory with the images in them.

usage: near_walls.py [BIN_DIR] [--set KEY=VALUE]…
       (default: build/bin; ten runs of the plane, half a minute each on one core)
Half the wetted width at the end is 0.196 m (Wagner), 24 spacings; speed 6 m/s, no gravity. Printed are the impulse until the end and the mean force over the last
fifth of the time, over those of the same wedge with walls 1 m and a floor 0.8 m away. cases/VALIDATION.md, "Walls and floor near a wedge"."""
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import runs

SPEED, SPACING, FAR = 6.0, 0.008, (1.0, 0.8)
ENDS = {30: 0.012, 15: 0.0056}  # deadrise [degrees], end of the run [s]
NEAR = {30: [(0.304, 0.8), (0.4, 0.8), (0.6, 0.8), (1.0, 0.2), (1.0, 0.12)], 15: [(0.304, 0.8), (0.4, 0.8), (1.0, 0.2)]}  # wall, floor [m]
CASE = """title = "near walls"
end_time = {end}
[fluid]
dimension = 2
spacing = {spacing}
gravity = [0, 0]
tank = [[-{wall}, -{floor}], [{wall}, 0.504]]
water = [[-{wall}, -{floor}], [{wall}, 0]]
[structure]
solver = "rigid"
velocity = [0, -{speed}]
wedge = {{ deadrise = {deadrise}, width = 0.5 }}
"""


def chi(s):
    """Legendre's chi function of order 2, the integral of artanh(u)/u from 0 to s."""
    return sum(s ** (2 * k + 1) / (2 * k + 1) ** 2 for k in range(2000))


def impulse_share(half, wall, floor):
    """What walls and floor make of the impulse of a wedge; (B2) and the floor of coupler/summary/blockage.hpp."""
    x0, h = 0.5 * math.pi * half / wall, half / floor
    low, high = 0.0, 1.0
    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if chi(middle) < x0 else (low, middle)
    return -2 * math.log(math.cos(math.asin(low))) / x0**2 + 5 * math.pi**2 / 144 * h**2 / math.sqrt(1 + 0.21 * h**2)


def in_theory(half, wall, floor):
    """Impulses until the end and in the last fifth, in parts of the impulse without walls."""
    whole, before = (s**2 * impulse_share(s * half, wall, floor) for s in (1.0, 0.8))
    return whole, whole - before


def impulses(run, end):
    """The same of a run [N s/m]; the force of a window is its mean."""
    whole, last, before = 0.0, 0.0, 0.0
    for t, force in zip(run["time"], run["force.y"]):
        whole += force * (t - before)
        last += force * max(0.0, t - max(before, 0.8 * end))
        before = t
    return whole, last


def main():
    arguments = runs.command(__doc__).parse_args()
    for deadrise, end in ENDS.items():
        half = 0.5 * math.pi * SPEED * end / math.tan(math.radians(deadrise))
        far_run = far_theory = None
        for wall, floor in [FAR, *NEAR[deadrise]]:
            text = CASE.format(end=end, spacing=SPACING, wall=wall, floor=floor, speed=SPEED, deadrise=deadrise)
            run, theory = impulses(runs.run(arguments.bin_dir, text, ["run.threads=1", *arguments.set]), end), in_theory(half, wall, floor)
            if far_run is None:
                far_run, far_theory = run, theory
            parts = [f"{100 * (a / b - 1):+.0f} %" for a, b in zip((*run, *theory), (*far_run, *far_theory))]
            print(f"{deadrise} degrees, walls {wall / half:.2f}, floor {floor / half:.2f} half wetted widths away: {run[0]:.1f} N s/m, "
                  f"impulse {parts[0]} (theory {parts[2]}), last fifth {parts[1]} (theory {parts[3]})", flush=True)


if __name__ == "__main__":
    main()
