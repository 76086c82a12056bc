#!/usr/bin/python3 -B
"""One of two masses of 1 kg between three springs, mass.py Left|Right, by the names of preCICE's Python bindings alone.

wall - k - mass - k12 - mass - k - wall; it sends its place and takes the other's, in four steps of a window.
"""
import pathlib
import sys

import precice

K, K12 = 4 * 3.141592653589793**2, 16 * 3.141592653589793**2  # N/m
STEPS = 4

side = sys.argv[1]
other = {"Left": "Right", "Right": "Left"}[side]
participant = precice.Participant(side, str(pathlib.Path(__file__).with_name("oscillator.xml")), 0, 1)
ids = participant.set_mesh_vertices(side, [(0, 0)])
u, v = (1.0, 0.0) if side == "Left" else (0.0, 0.0)  # m, m/s
a = -(K + K12) if side == "Left" else K12  # m/s^2
if participant.requires_initial_data():
    participant.write_data(side, f"Place-{side}", ids, [(u, 0)])
participant.initialize()
step = participant.get_max_time_step_size() / STEPS
while participant.is_coupling_ongoing():
    if participant.requires_writing_checkpoint():
        saved = u, v, a
    dt = min(step, participant.get_max_time_step_size())
    theirs = participant.read_data(side, f"Place-{other}", ids, dt)[0, 0]
    u = (u + dt * v + dt**2 / 4 * (a + K12 * theirs)) / (1 + dt**2 / 4 * (K + K12))  # Newmark, mean acceleration
    v, a = v + dt / 2 * (a + K12 * theirs - (K + K12) * u), K12 * theirs - (K + K12) * u
    participant.write_data(side, f"Place-{side}", ids, [(u, 0)])
    participant.advance(dt)
    if participant.requires_reading_checkpoint():
        u, v, a = saved
participant.finalize()
