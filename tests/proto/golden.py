"""Golden messages: golden.py SOURCE FOLDER_OF_coupling_pb2 [--write]. Every message of the protocol as bytes, each with
its meaning beside it, for whoever writes a participant in another language. This test builds them in Python and holds
the files against that; golden_test.cpp reads the same files in C++. --write makes the files anew."""
import pathlib
import sys

sys.path.insert(0, sys.argv[2])
import coupling_pb2 as pb
import numpy as np

FOLDER = pathlib.Path(sys.argv[1]) / "tests" / "proto" / "golden"
INF = float("inf")
OUTLINE = np.array([[0, 0, 0], [1, 0, 0], [1, 0.5, 0], [0, 0.5, 0]], "<f8")      # a body in two dimensions
FACES = np.array([[0, 1], [1, 2], [2, 3], [3, 0]], "<i4")                        # counter-clockwise
WET = np.array([[0.25, 0, 0], [0.75, 0, 0]], "<f8")                              # two wet points of the fluid
TOKEN, HASH = bytes(range(16)), bytes(range(32, 64))


def mesh(name, points, faces=0, mass=False):
    return pb.Mesh(name=name, dimension=2, n_points=points, n_faces=faces, has_mass=mass)


def field(quantity, unit, points, conservative=False, components=3):
    return pb.Field(quantity=quantity, unit=unit, components=components, conservative=conservative, n_points=points)


def constant(points, *value):
    return np.tile(np.array(value, "<f8"), (points, 1))


U, V, F = field("displacement", "m", 4), field("velocity", "m/s", 4), field("force", "N", 4, conservative=True)
P = field("pressure", "Pa", 2, components=1)
MESSAGES = {  # name: what it is for, header, frames
    "01-hello": ("A participant's first words; sequence 0: it has received nothing yet.",
                 pb.Reply(hello=pb.Hello(protocol=1, name="structure", token=TOKEN, solver="spring", version="1.2",
                                         case_hash=HASH)), []),
    "02-setup-structure": ("The structure is set up first: no partner yet, so its mesh is empty. An empty mesh\n"
                           "still has its frame of positions, of 0 bytes.",
                           pb.Request(sequence=1, setup=pb.Setup(run_folder="/home/me/runs/x", interface="surface",
                                                                 partner_mesh=pb.Mesh(dimension=3))), [np.zeros((0, 3))]),
    "03-ready-structure": ("The structure's mesh: position, faces, mass; then its motion at the start. dt_limit inf:\n"
                           "any window will do.",
                           pb.Reply(sequence=1, ready=pb.Ready(
                               mesh=mesh("spring", 4, 4, True), dt_limit=INF, initial=[U, V],
                               columns=[pb.Column(name="floor.y", unit="m")], lines=["spring   m 200 kg/m"])),
                           [OUTLINE, FACES, np.array([1, 2, 3, 4], "<f8"), constant(4, 0, 0, 0), constant(4, 0, -6.26, 0)]),
    "04-setup-fluid": ("The fluid is told the structure's mesh and motion.",
                       pb.Request(sequence=1, setup=pb.Setup(run_folder="/home/me/runs/x", interface="surface",
                                                             partner_mesh=mesh("spring", 4, 4), partner_initial=[U])),
                       [OUTLINE, FACES, constant(4, 0, 0, 0)]),
    "05-ready-fluid": ("The fluid's wet points; faces are not needed to map onto.",
                       pb.Reply(sequence=1, ready=pb.Ready(mesh=mesh("fluid", 2), dt_limit=1e-4)), [WET]),
    "06-advance": ("The first window, first iteration: the mean force over [0, 1e-5] s.",
                   pb.Request(sequence=2, advance=pb.Advance(t=0, dt=1e-5, iteration=1,
                                                             samples=[pb.Sample(time=1e-5, fields=[F])])),
                   [constant(4, 0, 12.5, 0)]),
    "07-advanced": ("Displacement at the end of the window, and a number for history.csv. The times are of the\n"
                    "participant's steady clock.",
                    pb.Reply(sequence=2, times=pb.Times(received=5_000_000_000, answered=5_000_125_000),
                             advanced=pb.Advanced(fields=[U], dt_limit=INF, monitor={"floor.y": -1e-6})),
                    [constant(4, 0, -1e-6, 0)]),
    "08-advance-rewind": ("The second iteration: everything back to the last commit first, then the same window again.",
                          pb.Request(sequence=3, advance=pb.Advance(before=pb.Advance.REWIND, t=0, dt=1e-5, iteration=2,
                                                                    samples=[pb.Sample(time=1e-5, fields=[F])])),
                          [constant(4, 0, 10, 0)]),
    "09-advance-history": ("The next window, after a commit that writes a field frame; motion as a history of two samples.",
                           pb.Request(sequence=4, advance=pb.Advance(
                               before=pb.Advance.COMMIT, write_output=True, t=1e-5, dt=1e-5, iteration=1,
                               samples=[pb.Sample(time=1.5e-5, fields=[U]), pb.Sample(time=2e-5, fields=[U])])),
                           [constant(4, 0, -1e-6, 0), constant(4, 0, -2e-6, 0)]),
    "10-advanced-retry": ("The participant asks for windows of at most 5e-6 s and has no result.",
                          pb.Reply(sequence=4, advanced=pb.Advanced(dt_limit=5e-6, retry_smaller_dt=True)), []),
    "11-scalar-fields": ("Any quantity with any number of components: the elastic tube's pressure.",
                         pb.Reply(sequence=5, advanced=pb.Advanced(fields=[field("pressure", "Pa", 2, components=1)],
                                                                   dt_limit=INF)),
                         [np.array([101325, -2.5], "<f8")]),
    "12-working": ("Unasked, at most once a second: a long computation goes on.",
                   pb.Reply(sequence=5, working=pb.Working(fraction=0.5, what="factorising")), []),
    "13-checkpoint": ("Write the state into the folder, the former window being committed first.",
                      pb.Request(sequence=6, checkpoint=pb.Checkpoint(folder="/home/me/runs/x/checkpoint/000002",
                                                                      before=pb.Advance.COMMIT)), []),
    "14-checkpoint-resume": ("Read the state from it.",
                             pb.Request(sequence=2, checkpoint=pb.Checkpoint(folder="/home/me/runs/x/checkpoint/000002",
                                                                             resume=True)), []),
    "15-stop": ("The end of the run; the last window is committed with a field frame.",
                pb.Request(sequence=7, stop=pb.Stop(commit=True, write_output=True)), []),
    "16-done": ("The answer to Checkpoint and Stop: everything is on disk.", pb.Reply(sequence=7, done=pb.Done()), []),
    "17-fault": ("The participant gives up; the run ends with this text and exit code.",
                 pb.Reply(sequence=5, fault=pb.Fault(where="pressure", problem="did not converge\n500 iterations",
                                                     fix="lower the window", exit_code=4)), []),
    "19-ready-history": ("A structure that takes its load as a history, over its steps.",
                         pb.Reply(sequence=1, ready=pb.Ready(mesh=mesh("tube", 2), dt_limit=INF, history=True, initial=[
                             field("area", "m^2", 2, components=1)])), [WET, np.array([1e-4, 1e-4], "<f8")]),
    "20-setup-history": ("The fluid is told so, and given the structure's mesh and area.",
                         pb.Request(sequence=1, setup=pb.Setup(
                             interface="surface", history=True, partner_mesh=mesh("tube", 2),
                             partner_initial=[field("area", "m^2", 2, components=1)])), [WET, np.array([1e-4, 1e-4], "<f8")]),
    "21-advanced-history": ("The fluid's answer: the pressure of the window first, then that at the ends of its two steps.",
                            pb.Reply(sequence=2, advanced=pb.Advanced(
                                fields=[P], dt_limit=INF,
                                history=[pb.Sample(time=5e-6, fields=[P]), pb.Sample(time=1e-5, fields=[P])])),
                            [np.array([11, 21], "<f8"), np.array([10, 20], "<f8"), np.array([12, 22], "<f8")]),
    "22-ready-cannot-resume": ("A structure that cannot save its state, and needs the fluid's fields at the start.",
                               pb.Reply(sequence=1, ready=pb.Ready(mesh=mesh("mass", 2), dt_limit=INF, cannot_resume=True,
                                                                   partner_initial=True)), [WET]),
    "23-advance-wants-history": ("The fluid takes the structure's fields as a history: send Advanced.history. The first window of\n"
                                 "one that asked for it begins with the fluid's field at the start.",
                                 pb.Request(sequence=2, advance=pb.Advance(t=0, dt=1e-5, iteration=1, wants_history=True, samples=[
                                     pb.Sample(time=0, fields=[P]), pb.Sample(time=1e-5, fields=[P])])),
                                 [np.array([9, 19], "<f8"), np.array([12, 22], "<f8")]),
    "24-ready-meshes": ("A fluid that has joined two meshes, one point each: it takes the displacement on the first, and sends\n"
                        "the force on the second. On the first the force is zero.",
                        pb.Reply(sequence=1, ready=pb.Ready(
                            mesh=pb.Mesh(name="fluid", dimension=2, n_points=2, meshes=[
                                pb.MeshPart(name="nodes"), pb.MeshPart(name="faces", first_point=1)]),
                            dt_limit=INF, initial=[field("force", "N", 2, conservative=True)],
                            sent_on=[pb.FieldMesh(quantity="force", mesh="faces")],
                            taken_on=[pb.FieldMesh(quantity="displacement", mesh="nodes")])),
                        [WET, np.array([[0, 0, 0], [0, 2.5, 0]], "<f8")]),
    "18-refused": ("Hello was not accepted.",
                   pb.Request(refused=pb.Refused(where="coupler", problem='"structure" does not know the token of this run',
                                                 fix="STRAKE_TOKEN must hold the token that the coupler printed")), []),
}


def line(data, meaning, depth=0):
    return f"{'  ' * depth}{data.hex(' ')} | {meaning}\n"


def explained(message, depth=0):
    """The bytes of a header, field by field. Presence in proto3: what has its default value is not sent."""
    text = b""
    lines = ""
    for descriptor, value in message.ListFields():
        values = value if descriptor.label == descriptor.LABEL_REPEATED else [value]
        if descriptor.message_type and descriptor.message_type.GetOptions().map_entry:
            entry = descriptor.message_type._concrete_class
            values = [entry(key=key, value=value[key]) for key in sorted(value)]
        for one in values:
            alone = type(message)()
            if descriptor.label == descriptor.LABEL_REPEATED:
                if descriptor.message_type and descriptor.message_type.GetOptions().map_entry:
                    getattr(alone, descriptor.name)[one.key] = one.value
                else:
                    getattr(alone, descriptor.name).extend([one])
            elif descriptor.message_type:
                getattr(alone, descriptor.name).CopyFrom(one)
            else:
                setattr(alone, descriptor.name, one)
            data = alone.SerializeToString()
            text += data
            if not descriptor.message_type:
                shown = one.hex() if isinstance(one, bytes) else repr(one).replace("'", '"')
                lines += line(data, f"{descriptor.name} = {shown}", depth)
                continue
            inside = one.SerializeToString()
            lines += line(data[:len(data) - len(inside)], f"{descriptor.name}: {len(inside)} bytes", depth)
            if descriptor.message_type.GetOptions().map_entry:  # text → float64: the last 9 bytes are the number
                lines += line(inside[:-9], f'key = "{one.key}"', depth + 1) + line(inside[-9:], f"value = {one.value}", depth + 1)
            else:
                lines += explained(one, depth + 1)[1]
    return text, lines


def text_of(name):
    purpose, header, frames = MESSAGES[name]
    data, lines = explained(header)
    assert data == header.SerializeToString(deterministic=True), name
    text = "".join(f"# {words}\n" for words in purpose.split("\n"))
    text += f"frame 0: {header.DESCRIPTOR.name}, {len(data)} bytes\n{lines}"
    for number, frame in enumerate(frames, 1):
        rows = frame.reshape(-1, frame.shape[-1] if frame.ndim > 1 else 1)
        text += f"frame {number}: {frame.nbytes} bytes of {'int32' if frame.dtype == '<i4' else 'float64'}\n"
        text += "".join(line(row.tobytes(), " ".join(f"{x:g}" for x in row)) for row in rows)
    return text


def read(path):
    """The frames of a golden file: what stands before | in each line, in hexadecimal."""
    frames = []
    for row in path.read_text(encoding="utf-8").splitlines():
        if row.startswith("frame "):
            frames.append(b"")
        elif not row.startswith("#"):
            frames[-1] += bytes.fromhex(row.split("|")[0])
    return frames


problems = []
if "--write" in sys.argv:
    FOLDER.mkdir(exist_ok=True)
    for name in MESSAGES:
        (FOLDER / f"{name}.hex").write_text(text_of(name), encoding="utf-8")
files = {path.stem for path in FOLDER.glob("*.hex")}
if files != set(MESSAGES):
    problems.append(f"files and messages differ: {sorted(files ^ set(MESSAGES))}")
for name in sorted(files & set(MESSAGES)):
    purpose, header, frames = MESSAGES[name]
    if (FOLDER / f"{name}.hex").read_text(encoding="utf-8") != text_of(name):
        problems.append(f"{name}.hex is not what Python makes of this message (--write would make it anew)")
    first, *arrays = read(FOLDER / f"{name}.hex")
    if type(header).FromString(first) != header:
        problems.append(f"{name}.hex: its header reads back as another message")
    if [np.frombuffer(a, f.dtype).tolist() for a, f in zip(arrays, frames)] != [f.ravel().tolist() for f in frames]:
        problems.append(f"{name}.hex: its arrays read back as others")
print("\n".join(problems) or f"{len(files)} golden messages")
sys.exit(bool(problems))
