"""Draws the picture of docs/simulation.md, which shows VTK's filter beside vtkChronormalInterpolator half-way through a
morph. Prints the table of that page: the errors of the two filters on the built-in morphs.

    vtk.py PROGRAM [--check]
"""

import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from meshes import Steps, degrees, mesh, normals, point_normals
from page import Page
from PIL import Image
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkFiltersHybrid import vtkTemporalInterpolator
from vtkmodules.vtkRenderingCore import (vtkActor, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow, vtkTextActor,
                                         vtkWindowToImageFilter)
import vtkmodules.vtkRenderingFreeType  # noqa: F401: text
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401: the window

from chronormal_vtk.vtkChronormal import vtkChronormalInterpolator

FILTERS = (vtkTemporalInterpolator, vtkChronormalInterpolator)
SIZE = (1200, 520)


def read_morph(program, name):
    """Returns the keyframes of a built-in morph, and the faces of the morph."""
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([program, "convert", "--sample", name, "-o", f"{folder}/morph.npz", "--quiet"], check=True)
        with np.load(f"{folder}/morph.npz") as file:
            return file["positions"], file["faces"].astype(np.int64)


def half_way(keyframes, faces):
    """Returns the results of vtkTemporalInterpolator and vtkChronormalInterpolator in the middle of the first segment.
    The stored normals at both ends of the segment are true."""
    steps = Steps(lambda time: mesh(keyframes[int(time)], faces), times=(0.0, 1.0))
    results = []
    for filter_class in FILTERS:
        between = filter_class()
        between.SetInputConnection(steps.GetOutputPort())
        between.UpdateTimeStep(0.5)
        results.append(between.GetOutputDataObject(0))
    return results


def row(name, keyframes, faces):
    truth = point_normals(keyframes[:2].astype(float).mean(axis=0), faces)
    text = f"{name:<10}"
    for data in half_way(keyframes, faces):
        errors, lengths = degrees(normals(data), truth), np.linalg.norm(normals(data), axis=1)
        style = ".1f" if errors.max() > 0.1 else ".1e"
        text += f"{errors.mean():>12{style}}{errors.max():>9{style}}{lengths.min():>10.3f}"
    return text


def table(program):
    heads = f"{'mean':>12}{'worst':>9}{'shortest':>10}"
    lines = [f"{'':<10}{FILTERS[0].__name__:>31}{FILTERS[1].__name__:>31}", f"{'morph':<10}{heads}{heads}"]
    return "\n".join(lines + [row(name, *read_morph(program, name)) for name in ("twist", "bend", "cloth", "eversion")])


def draw(program):
    """Renders the results of vtkTemporalInterpolator and vtkChronormalInterpolator side by side. Returns the picture as
    an array (height, width, 3)."""
    window = vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(*SIZE)
    for k, data in enumerate(half_way(*read_morph(program, "twist"))):
        mapper, actor, renderer, text = vtkPolyDataMapper(), vtkActor(), vtkRenderer(), vtkTextActor()
        mapper.SetInputData(data)
        mapper.ScalarVisibilityOff()
        actor.SetMapper(mapper)
        shown = actor.GetProperty()
        shown.SetColor(0.75, 0.77, 0.8)
        shown.SetSpecular(0.7)
        shown.SetSpecularPower(30)
        shown.SetAmbient(0.05)
        renderer.AddActor(actor)
        renderer.SetBackground(1, 1, 1)
        renderer.SetViewport(k / 2, 0, (k + 1) / 2, 1)
        text.SetInput(FILTERS[k].__name__)
        text.SetPosition(16, 16)
        text.GetTextProperty().SetFontSize(22)
        text.GetTextProperty().SetColor(0.1, 0.1, 0.1)
        renderer.AddViewProp(text)
        renderer.ResetCamera()
        camera = renderer.GetActiveCamera()
        camera.Azimuth(35)
        camera.Elevation(20)
        camera.Zoom(1.5)
        renderer.ResetCameraClippingRange()
        window.AddRenderer(renderer)
    window.Render()
    taken = vtkWindowToImageFilter()
    taken.SetInput(window)
    taken.ReadFrontBufferOff()
    taken.Update()
    pixels = vtk_to_numpy(taken.GetOutput().GetPointData().GetScalars())
    return pixels.reshape(SIZE[1], SIZE[0], -1)[::-1]


def main():
    page, program = Page("vtk"), sys.argv[1]
    text = table(program)
    print(text)
    page.says(text)
    with tempfile.TemporaryDirectory() as folder:
        drawn = Path(folder) / "vtk.png"
        Image.fromarray(np.ascontiguousarray(draw(program))).quantize(160, dither=Image.Dither.NONE).save(drawn, optimize=True)
        page.take(drawn)
    page.finish()


if __name__ == "__main__":
    main()
