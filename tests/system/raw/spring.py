#!/usr/bin/python3 -B
"""A rigid floor on a spring, m y'' + k y = F, that speaks the messages itself. proto/WIRE.md explains every step."""
import sys, tomllib
import numpy as np
from connection import Connection, pb

pairs = list(zip(sys.argv[1::2], sys.argv[2::2]))  # --connect ENDPOINT --name structure --case-hash HEX --case FILE …
option = dict(pairs)
key = tomllib.load(open(option["--case"], "rb"))["structure"]["spring"]
for path, value in (text.split("=", 1) for name, text in pairs if name == "--set"):
    if path.startswith("structure.spring."):
        key[path.rsplit(".", 1)[1]] = tomllib.loads("value = " + value)["value"]
m, k, width, thickness = key["mass"], key["stiffness"], key["width"], key["thickness"]
n = key["points"]  # on the upper face, and as many on the lower one

# The outline, counter-clockwise: a segment (a, b) along t has the normal (t_y, -t_x), which points into the fluid.
x = np.linspace(-width / 2, width / 2, n)
position = np.array([(a, -thickness, 0) for a in x] + [(a, 0, 0) for a in x[::-1]])
faces = np.array([(i, (i + 1) % (2 * n)) for i in range(2 * n)])
displacement = pb.Field(quantity="displacement", unit="m", components=3, n_points=2 * n)
committed = trial = np.zeros(2)  # all that changes in time: y [m] and v [m/s]

def advance(dt, force):  # the trapezoidal rule, with the mean force over the window
    (y, v), a = committed, k * dt**2 / (4 * m)
    end = ((1 - a) * v + dt * (force - k * y) / m) / (1 + a)
    return np.array((y + dt * (v + end) / 2, end))

coupler = Connection(option["--connect"], option["--name"], option["--case-hash"], solver="spring", version="1")
what = ""
while what != "stop":
    request, arrays = coupler.ask()
    what, frames = request.WhichOneof("what"), ()
    ask, reply = getattr(request, what), pb.Reply(done=pb.Done())
    if getattr(ask, "before", 0) == pb.Advance.COMMIT or getattr(ask, "commit", False):
        committed = trial  # REWIND needs nothing: every window starts from `committed`
    if what == "setup":
        mesh = pb.Mesh(name="spring", dimension=2, n_points=2 * n, n_faces=2 * n)
        reply.ready.CopyFrom(pb.Ready(mesh=mesh, initial=[displacement], dt_limit=np.inf, columns=[pb.Column(
            name="floor.y", unit="m")], lines=[f"spring   m {m:g} kg/m   k {k:g} N/m per metre of depth"]))
        frames = position.astype("<f8"), faces.astype("<i4"), np.tile((0, trial[0], 0), 2 * n)
    elif what == "advance":
        force = np.frombuffer(arrays[0], "<f8").reshape(-1, 3)  # N per metre of depth, on each point
        trial = advance(ask.dt, force[:, 1].sum())
        reply.advanced.CopyFrom(pb.Advanced(fields=[displacement], dt_limit=np.inf, monitor={"floor.y": trial[0]}))
        frames = (np.tile((0, trial[0], 0), 2 * n),)  # x, y, z of point 0, then of point 1, …
    elif what == "checkpoint" and ask.resume:
        committed = trial = np.load(ask.folder + "/structure.npy")
    elif what == "checkpoint":
        np.save(ask.folder + "/structure.npy", committed)
    coupler.reply(reply, frames)
