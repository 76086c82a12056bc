"""The flow in an elastic tube, one-dimensional, at unit density: 100 cells over 10 m, implicit Euler steps."""
import numpy as np

CELLS = 100
NODES, DX = CELLS + 1, 10.0 / CELLS  # of 1 m^2 at rest
C2 = 1e4 / (2 / np.sqrt(np.pi))  # c^2 = E / (2 r0) [m^2/s^2]
POINTS = [(k * DX, 0.0, 0.0) for k in range(NODES)]


def area_of(pressure):
    """a = (2 c^2)^2 / (p - 2 c^2)^2 [m^2]"""
    return (2 * C2) ** 2 / (pressure - 2 * C2) ** 2


def residual(u, p, a, before, end_time, dt):
    """Residuals of momentum and continuity at inner nodes; at the ends inlet and outlet. A face has the mean of its two nodes.

    dx/dt (u a - u' a') + a+ u+ u_i - a- u- u_(i-1) + (a+ (p_(i+1) - p_i) + a- (p_i - p_(i-1))) / 2 = 0
    dx/dt (a - a') + a+ u+ - a- u- = 0
    """
    u0, p0, a0 = before
    face_a, face_u = (a[1:] + a[:-1]) / 2, (u[1:] + u[:-1]) / 2
    flux, push = face_a * face_u, face_a * np.diff(p)
    momentum, continuity = np.empty(NODES), np.empty(NODES)
    momentum[1:-1] = DX / dt * (u * a - u0 * a0)[1:-1] + flux[1:] * u[1:-1] - flux[:-1] * u[:-2] + (push[1:] + push[:-1]) / 2
    continuity[1:-1] = DX / dt * (a - a0)[1:-1] + np.diff(flux)
    momentum[0] = u[0] - (10 + 3 * np.sin(10 * np.pi * end_time))
    momentum[-1] = u[-1] - 2 * u[-2] + u[-3]
    continuity[0] = p[0] - 2 * p[1] + p[2]
    continuity[-1] = p[-1] - 2 * (C2 - (np.sqrt(C2 - p0[-1] / 2) - (u[-1] - u0[-1]) / 4) ** 2)  # no reflection
    return np.concatenate([momentum, continuity])


def jacobian(u, a, before, dt):
    """Of `residual` with respect to u, then p."""
    u0, p0, _ = before
    face_a, face_u = (a[1:] + a[:-1]) / 2, (u[1:] + u[:-1]) / 2
    J, i = np.zeros((2 * NODES, 2 * NODES)), np.arange(1, CELLS)
    left, right = face_a[:-1], face_a[1:]
    J[i, i - 1] = -left * (face_u[:-1] + u[:-2] / 2)
    J[i, i] = DX / dt * a[1:-1] + right * (face_u[1:] + u[1:-1] / 2) - left * u[:-2] / 2
    J[i, i + 1] = right * u[1:-1] / 2
    p = NODES
    J[i, p + i - 1], J[i, p + i], J[i, p + i + 1] = -left / 2, (left - right) / 2, right / 2
    J[p + i, i - 1], J[p + i, i], J[p + i, i + 1] = -left / 2, (right - left) / 2, right / 2
    J[0, 0] = J[CELLS, CELLS] = J[CELLS, CELLS - 2] = J[p, p] = J[p, p + 2] = J[p + CELLS, p + CELLS] = 1
    J[CELLS, CELLS - 1] = J[p, p + 1] = -2
    J[p + CELLS, CELLS] = -(np.sqrt(C2 - p0[-1] / 2) - (u[-1] - u0[-1]) / 4)
    return J


def step(before, a, end_time, dt):
    """Velocity [m/s] and pressure [Pa] at the end of a step through a tube of given area, by Newton's method."""
    u, p, _ = before
    for _ in range(20):
        change = np.linalg.solve(jacobian(u, a, before, dt), residual(u, p, a, before, end_time, dt))
        u, p = u - change[:NODES], p - change[NODES:]
        if np.linalg.norm(change) <= 1e-12 * np.hypot(np.linalg.norm(u), np.linalg.norm(p)):
            break
    return u, p
