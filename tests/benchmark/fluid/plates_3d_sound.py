"""Impulse of a rigid disc and a square plate that meet level water with sound, by linear acoustics.

usage: plates_3d_sound.py [--cells 25 50]    (a square of 100 cells: 2 GB, some minutes)
The plate has the velocity V from t = 0 on, in boundless water of density rho and sound speed c, without weight. The potential obeys
  phi_tt = c^2 laplacian(phi),  phi = 0 on the level surface beside the plate,  dphi/dz = V on the plate,
with phi = 0 at t = 0, and the impulse on the plate is -rho times the integral of phi over it. Second-order differences in space and time, with a
given number of cells in the radius or half width a. Printed in units of rho V a^3, and as a share of what water without sound gives: 4/3 (disc,
classical) and 1.819 (square, plates_3d.py). The largest
impulse comes before any wave returns from the rims of the grid. Later the theory has tension, which water on a plate does not bear."""
import argparse

import numpy as np

SIDE = 3  # of the grid, in a; half as deep in space. Waves come back from its rims at c t / a = 3
END = 2  # c t / a
FRACTION = 0.5  # of the cell that a wave passes in a step; 0.57 is the limit in space


def disc(cells):
    h = 1 / cells
    r = (np.arange(SIDE * cells) + 0.5) * h
    outer, inner, on = ((r + h / 2) / r)[:, None], ((r - h / 2) / r)[:, None], r < 1

    def laplacian(phi):
        out = outer * (np.vstack([phi[1:], phi[-1:]]) - phi) - inner * (phi - np.vstack([phi[:1], phi[:-1]]))
        out[:, 1:-1] += phi[:, 2:] - 2 * phi[:, 1:-1] + phi[:, :-2]
        out[on, 0] += 2 * phi[on, 1] - 2 * phi[on, 0] - 2 * h
        return out / h**2

    return impulses(np.zeros((r.size, r.size)), laplacian, h, lambda phi: phi[on, 0] @ (2 * np.pi * r[on]) * h, ~on)


def square(cells):
    h = 1 / cells
    x = (np.arange(SIDE * cells) + 0.5) * h  # a quarter: mirrored at x = 0 and y = 0
    on = (x[:, None] < 1) & (x[None, :] < 1)

    def laplacian(phi):
        out = np.zeros_like(phi)
        for axis in (0, 1):
            step = np.diff(phi, axis=axis)
            left = (slice(None),) * axis
            out[left + (slice(None, -1),)] += step
            out[left + (slice(1, None),)] -= step
        out[:, :, 1:-1] += phi[:, :, 2:] - 2 * phi[:, :, 1:-1] + phi[:, :, :-2]
        out[:, :, 0][on] += 2 * phi[:, :, 1][on] - 2 * phi[:, :, 0][on] - 2 * h
        return out / h**2

    n = x.size
    return impulses(np.zeros((n, n, n // 2)), laplacian, h, lambda phi: 4 * h**2 * phi[:, :, 0][on].sum(), ~on)


def impulses(phi, laplacian, h, on_plate, beside):
    """Returns c t/a and -integral of phi at each step. beside: mask of the level surface."""
    before, step, found = phi.copy(), FRACTION * h, []
    for k in range(int(END / step)):
        after = 2 * phi - before + step**2 * laplacian(phi)
        after[..., 0][beside] = 0
        after[..., -1] = 0
        before, phi = phi, after
        found.append(((k + 1) * step, -on_plate(phi)))
    return np.array(found)


parser = argparse.ArgumentParser()
parser.add_argument("--cells", type=int, nargs="+", default=[25, 50])
for name, plate, alone in (("disc", disc, 4 / 3), ("square", square, 1.819)):
    for cells in parser.parse_args().cells:
        time, impulse = plate(cells).T
        top = impulse.argmax()
        print(f"{name:7} {cells:3d} cells  largest {impulse[top]:.3f} rho V a^3 at c t/a = {time[top]:.2f}, {impulse[top] / alone:.3f} of water without sound; "
              + ", ".join(f"{t:g}: {np.interp(t, time, impulse) / alone:.3f}" for t in (0.5, 1, 1.4, 2)), flush=True)
