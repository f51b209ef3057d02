"""The surface of a brain as VTK has it, or PyVista where that is installed.

brainSurface.py [IMAGE [LEVEL]]: writes brain.vtp, colours it by how much it bends, and opens a window
where there is a display.
"""

import importlib.util
import os
import sys

import adaptiso
from vtkmodules.vtkFiltersGeneral import vtkCurvatures
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

image = sys.argv[1] if len(sys.argv) > 1 else "/usr/share/mricron/templates/ch2bet.nii.gz"
level = float(sys.argv[2]) if len(sys.argv) > 2 else 90

mesh = adaptiso.surface(image, level, max_error=0.3, largest=True, fill_cavities=True)
print(mesh)

bends = vtkCurvatures()  # of a closed surface it needs no more: every edge has two triangles
bends.SetInputData(mesh.to_vtk())
bends.SetCurvatureTypeToMean()
bends.Update()
writer = vtkXMLPolyDataWriter()
writer.SetFileName("brain.vtp")
writer.SetInputData(bends.GetOutput())
writer.Write()
if writer.GetErrorCode():
    sys.exit("brain.vtp can't be written")
print(f"brain.vtp: {bends.GetOutput().GetNumberOfCells():,} triangles, "
      f"{mesh.volume / 1000:.0f} cm3, {mesh.area / 100:.0f} cm2")

if importlib.util.find_spec("pyvista"):
    import pyvista
    pyvista.OFF_SCREEN = "DISPLAY" not in os.environ
    pyvista.wrap(bends.GetOutput()).plot(scalars="Mean_Curvature", clim=(-0.5, 0.5), cmap="coolwarm",
                                         screenshot="brain.png")
elif "DISPLAY" in os.environ:
    import vtkmodules.vtkInteractionStyle
    import vtkmodules.vtkRenderingOpenGL2
    from vtkmodules.vtkRenderingCore import (vtkActor, vtkPolyDataMapper, vtkRenderer,
                                             vtkRenderWindow, vtkRenderWindowInteractor)
    mapper = vtkPolyDataMapper()
    mapper.SetInputData(bends.GetOutput())
    mapper.SetScalarRange(-0.5, 0.5)
    actor = vtkActor()
    actor.SetMapper(mapper)
    renderer = vtkRenderer()
    renderer.AddActor(actor)
    window = vtkRenderWindow()
    window.AddRenderer(renderer)
    interactor = vtkRenderWindowInteractor()
    interactor.SetRenderWindow(window)
    interactor.Start()
