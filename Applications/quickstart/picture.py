#!/usr/bin/python3
"""Draws a surface to a PNG: the whole of it shaded, and a close-up with its triangles' edges.

usage: picture.py SURFACE.vtp PICTURE.png [CAPTION]

SURFACE is in RAS millimetres, as adaptiso-mesh writes it. VTK as Debian builds it needs an X
server; without a screen: xvfb-run -a picture.py ...
"""
import sys

from vtkmodules.vtkFiltersCore import vtkPolyDataNormals
from vtkmodules.vtkImagingCore import vtkImageResize
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
from vtkmodules.vtkRenderingCore import (vtkActor, vtkLight, vtkPolyDataMapper, vtkRenderer,
                                         vtkRenderWindow, vtkTextActor, vtkWindowToImageFilter)
import vtkmodules.vtkInteractionStyle  # noqa: F401  the render window's factory
import vtkmodules.vtkRenderingFreeType  # noqa: F401  text
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401  the drawing itself

WIDTH, HEIGHT = 1600, 800  # of the picture; drawn at twice that and averaged
OVERSAMPLING = 2


def readSurface(path):
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(path)
    reader.Update()
    surface = reader.GetOutput()
    if surface.GetNumberOfCells() == 0:
        sys.exit(f"picture.py: {path} holds no triangle")
    if surface.GetPointData().GetNormals() is None:
        normals = vtkPolyDataNormals()
        normals.SetInputData(surface)
        normals.SplittingOff()
        normals.Update()
        surface = normals.GetOutput()
    return surface


def surfaceActor(surface, color):
    mapper = vtkPolyDataMapper()
    mapper.SetInputData(surface)
    mapper.ScalarVisibilityOff()
    actor = vtkActor()
    actor.SetMapper(mapper)
    look = actor.GetProperty()
    look.SetInterpolationToPhong()
    look.SetColor(color)
    look.SetAmbient(0.06)
    look.SetDiffuse(0.9)
    look.SetSpecular(0.12)
    look.SetSpecularPower(18)
    return actor


def caption(text, size, x, y):
    actor = vtkTextActor()
    actor.SetInput(text)
    actor.SetPosition(x * OVERSAMPLING, y * OVERSAMPLING)
    actor.GetTextProperty().SetFontSize(size * OVERSAMPLING)
    actor.GetTextProperty().SetColor(0.12, 0.14, 0.18)
    actor.GetTextProperty().SetBackgroundColor(0.95, 0.96, 0.97)
    actor.GetTextProperty().SetBackgroundOpacity(0.8)
    return actor


def addLight(renderer, position, intensity):
    light = vtkLight()
    light.SetLightTypeToCameraLight()
    light.SetPosition(*position)
    light.SetIntensity(intensity)
    renderer.AddLight(light)


def panel(window, surface, left, closeUp, text):
    """One half of the picture. The viewer stands to the left front of the head, a little above:
    patient left is -x, front +y, up +z (RAS)."""
    renderer = vtkRenderer()
    renderer.SetViewport(left, 0, left + 0.5, 1)
    renderer.GradientBackgroundOn()
    renderer.SetBackground(0.86, 0.88, 0.91)
    renderer.SetBackground2(0.98, 0.98, 0.99)
    renderer.AutomaticLightCreationOff()
    addLight(renderer, (-0.6, 0.9, 1.0), 1.0)
    addLight(renderer, (0.9, -0.2, 0.8), 0.35)
    actor = surfaceActor(surface, (0.96, 0.84, 0.74))
    if closeUp:
        look = actor.GetProperty()
        look.EdgeVisibilityOn()
        look.SetEdgeColor(0.10, 0.20, 0.42)
        look.SetLineWidth(1.1 * OVERSAMPLING)
    renderer.AddActor(actor)
    renderer.AddViewProp(caption(f" {text} ", 20, 24, 20))
    camera = renderer.GetActiveCamera()
    x0, x1, y0, y1, z0, z1 = surface.GetBounds()
    center = ((x0 + x1) / 2, (y0 + y1) / 2, (z0 + z1) / 2)
    camera.SetFocalPoint(center)
    camera.SetPosition(center[0] - 1.0, center[1] + 0.55, center[2] + 0.35)
    camera.SetViewUp(0, 0, 1)
    camera.SetViewAngle(24)
    renderer.ResetCamera()
    camera.Zoom(1.42)
    if closeUp:
        camera.Zoom(5)
        renderer.ResetCameraClippingRange()
    window.AddRenderer(renderer)


def draw(surface, path, text):
    window = vtkRenderWindow()
    window.SetOffScreenRendering(True)
    window.SetSize(WIDTH * OVERSAMPLING, HEIGHT * OVERSAMPLING)
    window.SetMultiSamples(0)
    panel(window, surface, 0.0, False, text)
    panel(window, surface, 0.5, True, "close-up with edges")
    window.Render()
    grab = vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.SetInputBufferTypeToRGB()
    grab.ReadFrontBufferOff()
    smaller = vtkImageResize()
    smaller.SetInputConnection(grab.GetOutputPort())
    smaller.SetOutputDimensions(WIDTH, HEIGHT, 1)
    writer = vtkPNGWriter()
    writer.SetInputConnection(smaller.GetOutputPort())
    writer.SetFileName(path)
    writer.Write()
    if writer.GetErrorCode():
        sys.exit(f"picture.py: cannot write {path}")


def main():
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    surface = readSurface(sys.argv[1])
    count = surface.GetNumberOfCells()
    draw(surface, sys.argv[2], sys.argv[3] if len(sys.argv) == 4 else f"{count:,} triangles")


main()
