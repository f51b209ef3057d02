"""VTK of any version that has Python: peerVtkPython.py quadric MESH.ply COUNT OUT.ply
                                       peerVtkPython.py surfaceNets MASK.nii OUT.ply
A mask's surface is in voxel indices. Prints one JSON object."""
import json
import sys
import time

from vtkmodules.vtkCommonCore import vtkVersion
from vtkmodules.vtkFiltersCore import vtkQuadricDecimation, vtkTriangleFilter
from vtkmodules.vtkIOPLY import vtkPLYReader, vtkPLYWriter


def quadric(mesh, count):
    reader = vtkPLYReader()
    reader.SetFileName(mesh)
    reader.Update()
    surface = reader.GetOutput()
    quadrics = vtkQuadricDecimation()
    quadrics.SetInputData(surface)
    quadrics.SetTargetReduction(1 - int(count) / surface.GetNumberOfPolys())
    return quadrics


def surface_nets(mask):
    from vtkmodules.vtkFiltersCore import vtkSurfaceNets3D
    from vtkmodules.vtkIOImage import vtkNIFTIImageReader
    reader = vtkNIFTIImageReader()
    reader.SetFileName(mask)
    reader.Update()
    image = reader.GetOutput()
    image.SetSpacing(1, 1, 1)
    nets = vtkSurfaceNets3D()
    nets.SetInputData(image)
    nets.SetValue(0, 1)
    nets.SetOutputMeshTypeToTriangles()
    return nets


def main():
    method, *arguments, output = sys.argv[1:]
    work = {"quadric": quadric, "surfaceNets": surface_nets}[method](*arguments)
    began = time.process_time()
    work.Update()
    seconds = time.process_time() - began
    triangles = vtkTriangleFilter()
    triangles.SetInputData(work.GetOutput())
    writer = vtkPLYWriter()
    writer.SetInputConnection(triangles.GetOutputPort())
    writer.SetFileName(output)
    writer.Write()
    print(json.dumps({"version": vtkVersion.GetVTKVersion(), "cpuSeconds": seconds,
                      "triangles": triangles.GetOutput().GetNumberOfPolys()}))


main()
