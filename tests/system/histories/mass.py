#!/usr/bin/python3 -B
"""One of two masses on three springs, m x'' + (k + joint) x = joint * (place of the other), by four Newmark steps in a window.
It plays the fluid or the structure, and takes and sends histories, or asks for the other's place at the start alone."""
import sys
import tomllib

import numpy as np
from connection import Connection, pb

pairs = list(zip(sys.argv[1::2], sys.argv[2::2]))
option = dict(pairs)
side = option["--name"]
key = tomllib.load(open(option["--case"], "rb"))["structure"]["mass"]
for path, value in (text.split("=", 1) for name, text in pairs if name == "--set"):
    if path == "structure.mass.history":
        key["history"] = value == "true"
m, k, joint, history = key["mass"], key["stiffness"], key["joint"], key["history"]
start = {"fluid": key["left"], "structure": key["right"]}
other_start = start["structure" if side == "fluid" else "fluid"]
STEPS = 4

place = pb.Field(quantity="place", unit="m", components=1, n_points=1)
committed = trial = np.array([start[side], 0.0, (joint * other_start - (k + joint) * start[side]) / m])  # x, v, a
other_before = {"fluid": [other_start], "structure": []}[side]  # a fluid has it of its Setup
heard, error = [], 0.0


def exact(t):
    return 0.5 * (np.cos(2 * np.pi * t) + (1 if side == "fluid" else -1) * np.cos(6 * np.pi * t))


def advance(t, dt, times, places):
    """From the committed state, the other's place linear between its samples. Returns the states at the ends of the steps."""
    (x, v, a), h, states = committed, dt / STEPS, []
    for i in range(1, STEPS + 1):
        pull = joint * np.interp(t + i * h, times, places)
        ahead = x + h * v + h * h / 4 * a
        new = (pull - (k + joint) * ahead) / (m + h * h / 4 * (k + joint))
        x, v, a = ahead + h * h / 4 * new, v + h / 2 * (a + new), new
        states.append((t + i * h if i < STEPS else t + dt, np.array([x, v, a])))
    return states


coupler = Connection(option["--connect"], side, option["--case-hash"], solver="mass", version="1")
what = ""
while what != "stop":
    request, arrays = coupler.ask()
    what, frames = request.WhichOneof("what"), ()
    ask, reply = getattr(request, what), pb.Reply(done=pb.Done())
    if getattr(ask, "before", 0) == pb.Advance.COMMIT or getattr(ask, "commit", False):
        committed, other_before = trial, [heard[-1]]
        error = max(error, worst)
    if what == "setup":
        mesh = pb.Mesh(name="mass", dimension=2, n_points=1)
        reply.ready.CopyFrom(pb.Ready(mesh=mesh, initial=[place], dt_limit=np.inf, cannot_resume=True, history=history,
                                      partner_initial=True, lines=["mass"], columns=[pb.Column(name=f"error.{side}", unit="m")]))
        frames = np.zeros(3), trial[:1]
    elif what == "advance":
        times = [sample.time for sample in ask.samples]
        heard = [np.frombuffer(array, "<f8")[0] for array in arrays]
        if len(times) == 1:  # the start of the window is what was heard last
            times, heard = [ask.t, *times], [*other_before, *heard]
        states = advance(ask.t, ask.dt, times, heard)
        trial = states[-1][1]
        worst = max(abs(state[0] - exact(t)) for t, state in states)
        samples = [pb.Sample(time=t, fields=[place]) for t, state in states] if ask.wants_history else []
        reply.advanced.CopyFrom(pb.Advanced(fields=[place], dt_limit=np.inf, history=samples,
                                            monitor={f"error.{side}": max(error, worst)}))
        frames = [trial[:1], *(state[:1] for t, state in states)][:1 + len(samples)]
    elif what == "checkpoint":
        sys.exit("this program said that it cannot save its state")
    coupler.reply(reply, [np.ascontiguousarray(frame, "<f8") for frame in frames])
