"""What ParaView reads: pvpython look.py FILE.xdmf… prints one JSON object, reader → file → time steps and their arrays.

--colours FILE.png: the number of different colours of a picture.
"""
import json
import sys

from paraview import simple as pv


def open_with(reader, path):
    if reader == "XDMFReader":
        return pv.XDMFReader(FileNames=[path])
    return getattr(pv, reader)(FileName=[path] if reader == "Xdmf3ReaderS" else path)


def look(reader, path):
    source = open_with(reader, path)
    source.UpdatePipelineInformation()
    times = list(source.TimestepValues)
    steps = []
    for time in times:
        source.UpdatePipeline(time)
        data = source.GetDataInformation()
        arrays = {}
        for k in range(source.PointData.NumberOfArrays):
            array = source.PointData[k]
            arrays[array.Name] = [list(array.GetRange(c)) for c in range(array.GetNumberOfComponents())]
        steps.append({"points": data.GetNumberOfPoints(), "cells": data.GetNumberOfCells(), "bounds": list(data.GetBounds()),
                      "arrays": arrays})
    pv.Delete(source)
    return {"times": times, "steps": steps}


def colours(path):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOImage import vtkPNGReader
    reader = vtkPNGReader()
    reader.SetFileName(path)
    reader.Update()
    pixels = vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars())
    return len({tuple(pixel) for pixel in pixels[:, :3]})


if sys.argv[1] == "--colours":
    print(json.dumps(colours(sys.argv[2])))
else:
    print(json.dumps({reader: {path: look(reader, path) for path in sys.argv[1:]}
                      for reader in ("XDMFReader", "Xdmf3ReaderS", "Xdmf3ReaderT")}))
