"""Shows a run in ParaView: water particles coloured by pressure, the structure by its von Mises stress.

In the window, with all time steps and every property at hand:
    STRAKE_RUN=runs/plate_entry paraview --script=cases/paraview/show.py
As a picture, without a window (Debian: python3-paraview):
    pvpython cases/paraview/show.py runs/plate_entry -o plate.png --time 2.3e-3
More: --help. ParaView 5.11 or newer.
"""
import argparse
import os
import pathlib
import sys

from paraview import simple as pv

WATER = 0  # the values of `kind` in the fluid's frames: water, wall, and what moves
WALL = 1


def number_in(case, key):
    """A number of the top of a table of case.toml, `key` "fluid.spacing"; None where it is not there."""
    table, name = key.rsplit(".", 1)
    inside = False
    for line in case.read_text(encoding="utf-8").splitlines():
        words = line.split("#")[0].strip()
        if words.startswith("["):
            inside = words == f"[{table}]"
        elif inside and words.split("=")[0].strip() == name:
            return float(words.split("=")[1])
    return None


def open_frames(path):
    reader = pv.XDMFReader(registrationName=path.stem, FileNames=[str(path)])
    reader.UpdatePipelineInformation()
    return reader


def arrays_of(source):
    return {source.PointData[i].Name for i in range(source.PointData.NumberOfArrays)}


def only(source, name, lowest, highest):
    """The points whose `kind` is between the two."""
    part = pv.Threshold(registrationName=name, Input=source)
    part.Scalars = ["POINTS", "kind"]
    part.ThresholdMethod = "Between"
    part.LowerThreshold, part.UpperThreshold = lowest, highest
    return part


def as_particles(part, view, spacing):
    """Discs (in space: balls) of the size of the particles."""
    shown = pv.Show(part, view)
    shown.SetRepresentationType("Point Gaussian")
    shown.GaussianRadius = 0.72 * spacing  # no gaps on a square lattice
    shown.ShaderPreset = "Plain circle"
    return shown


def coloured(shown, view, field, title, preset, limits, place):
    """place: the end of the window where the bar stands, 0 left, 1 right."""
    pv.ColorBy(shown, ("POINTS", field))
    colours = pv.GetColorTransferFunction(field)
    colours.ApplyPreset(preset, True)
    if limits:
        colours.RescaleTransferFunction(*limits)
    else:
        shown.RescaleTransferFunctionToDataRange(False, True)
    bar = pv.GetScalarBar(colours, view)
    bar.Title, bar.ComponentTitle = title, ""
    bar.Orientation = "Horizontal"
    bar.WindowLocation = "Any Location"
    bar.Position = [0.08 + 0.46 * place, 0.03]
    bar.ScalarBarLength = 0.38
    bar.TitleColor = bar.LabelColor = [0.1, 0.1, 0.1]
    bar.TitleFontSize, bar.LabelFontSize = 16, 14
    bar.AddRangeLabels = 0
    shown.SetScalarBarVisibility(view, True)


def show(run, options):
    run = pathlib.Path(run)
    case = run / "case.toml"
    spacing = number_in(case, "fluid.spacing") if case.exists() else None
    sources, times, three = [], [], False
    view = pv.GetActiveViewOrCreate("RenderView")
    view.Background = [1, 1, 1]
    view.UseColorPaletteForBackground = 0
    view.OrientationAxesVisibility = 0
    view.ViewSize = options.size
    for side in ("fluid", "structure"):
        if not (run / f"{side}.xdmf").exists():
            continue
        reader = open_frames(run / f"{side}.xdmf")
        if not reader.TimestepValues:
            continue
        times.append(list(reader.TimestepValues))
        sources.append((side, reader))
    if not sources:
        sys.exit(f"{run}: holds no fluid.xdmf or structure.xdmf with a frame; name the folder of a run")
    # Without a time the last one that all have.
    time = min(t[-1] for t in times) if options.time is None else options.time
    time = min(times[0], key=lambda t: abs(t - time))
    pv.GetAnimationScene().UpdateAnimationUsingDataTimeSteps()
    view.ViewTime = time
    whole = [float("inf"), float("-inf")] * 3  # what all of it spans [m]
    for side, reader in sources:
        reader.UpdatePipeline(time)
        box = reader.GetDataInformation().GetBounds()
        whole = [min(a, b) if k % 2 == 0 else max(a, b) for k, (a, b) in enumerate(zip(whole, box))]
        three = three or box[5] - box[4] > 1e-9
        if side == "fluid":
            water, wall = only(reader, "water", WATER, WATER), only(reader, "walls", WALL, WALL)
            water.UpdatePipeline(time)
            high = water.GetDataInformation().GetBounds()[3]  # walls may stand far above it
            box = [*box[:3], high + 0.15 * (high - box[2]), *box[4:]]
            size = spacing or (box[1] - box[0]) / 200
            if three:  # the front half is removed, so that the inside of the water is visible
                half = pv.Clip(registrationName="half of the water", Input=water)
                half.ClipType = "Plane"
                half.ClipType.Origin = [0, 0, 0.5 * (box[4] + box[5])]
                half.ClipType.Normal = [0, 0, 1]
                water = half
            else:
                shown = as_particles(wall, view, size)
                pv.ColorBy(shown, None)
                shown.AmbientColor = shown.DiffuseColor = [0.6, 0.62, 0.66]
            shown = as_particles(water, view, size)
            if three:
                shown.ShaderPreset = "Sphere"
            field = "pressure" if options.field is None else options.field
            unit = " [Pa]" if field == "pressure" else " [m/s]" if field == "velocity" else ""
            coloured(shown, view, field, field.replace("_", " ").capitalize() + " of the water" + unit, "Viridis (matplotlib)",
                     options.range, 0)
        else:
            known = arrays_of(reader)
            field = options.solid or next((f for f in ("von_mises", "damage") if f in known), None)
            if reader.GetDataInformation().GetNumberOfCells() == reader.GetDataInformation().GetNumberOfPoints():
                size = (number_in(case, "structure.particle.spacing") if case.exists() else None) or spacing
                shown = as_particles(reader, view, size or (box[1] - box[0]) / 100)
            else:
                shown = pv.Show(reader, view)
                shown.SetRepresentationType("Surface")
            if field in known:
                title = "Von Mises stress of the structure [Pa]" if field == "von_mises" else field.replace("_", " ").capitalize() + " of the structure"
                coloured(shown, view, field, title, "Inferno (matplotlib)", options.solid_range, 1)
            else:
                pv.ColorBy(shown, None)
                shown.AmbientColor = shown.DiffuseColor = [0.35, 0.37, 0.40]
    label = pv.AnnotateTimeFilter(registrationName="time", Input=sources[0][1])
    label.Format = "t = {time:g} s"
    words = pv.Show(label, view)
    words.Color, words.FontSize = [0.1, 0.1, 0.1], 18
    words.WindowLocation = "Upper Left Corner"
    pv.Render(view)  # the first time it looks at everything
    if three:
        camera = view.GetActiveCamera()
        camera.Azimuth(25)
        camera.Elevation(20)
        view.ResetCamera()
    else:
        view.InteractionMode = "2D"
        left, low, right, high = options.view or (whole[0], whole[2], whole[1], whole[3])
        # The colour bars take the lowest fifth of the window, the time its upper edge.
        bars, edge = 0.2, 0.06
        height = max((high - low) / (1 - bars - edge), 1.04 * (right - left) * options.size[1] / options.size[0])
        middle = 0.5 * (low + high) - 0.5 * (bars - edge) * height
        view.CameraFocalPoint = [0.5 * (left + right), middle, 0]
        view.CameraPosition = [0.5 * (left + right), middle, 10]
        view.CameraViewUp = [0, 1, 0]
        view.CameraParallelScale = 0.5 * height
        view.CameraParallelProjection = 1
    pv.Render(view)
    if options.out:
        pv.SaveScreenshot(options.out, view, ImageResolution=options.size)
        print(f"{options.out}: t = {time:.6g} s, {len(times[0])} time steps")


def numbers(count):
    def read(text):
        values = [float(word) for word in text.split(",")]
        if len(values) != count:
            raise argparse.ArgumentTypeError(f"{count} numbers with commas between them")
        return values
    return read


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run", nargs="?", default=os.environ.get("STRAKE_RUN"), help="folder of a run")
    parser.add_argument("-o", dest="out", help="picture to write, .png")
    parser.add_argument("--time", type=float, help="s, the frame next to it; default the last")
    parser.add_argument("--field", help="of the water; default pressure")
    parser.add_argument("--range", type=numbers(2), help="of its colours: lo,hi")
    parser.add_argument("--solid", help="field of the structure; default von_mises, else damage")
    parser.add_argument("--solid-range", type=numbers(2), help="of its colours: lo,hi")
    parser.add_argument("--view", type=numbers(4), help="x0,y0,x1,y1 in m, of two dimensions")
    parser.add_argument("--size", type=lambda text: [int(n) for n in text.split("x")], default=[1280, 720], help="pixels, 1280x720")
    options = parser.parse_args()
    if not options.run:
        parser.error("name the folder of a run (as the word after the script, or in STRAKE_RUN)")
    show(options.run, options)


main()
