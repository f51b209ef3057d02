"""ParaView's plugin: the filters Adaptiso Isosurface and Adaptiso Simplify (menu Filters > Adaptiso).

Tools > Manage Plugins > Load New, and this file; in scripts paraview.simple.LoadPlugin(its path,
ns=globals()). ParaView's Python must find the package adaptiso: that of Debian's python3-adaptiso
does; from elsewhere, PYTHONPATH.
"""

from paraview.util.vtkAlgorithm import smdomain, smhint, smproperty, smproxy

from adaptiso import vtk

_HINTS = '<ShowInMenu category="Adaptiso"/>'

_AIMS = """
  <DoubleVectorProperty name="MaximumError" label="Maximum Error (mm)" command="SetMaximumError"
                        number_of_elements="1" default_values="0">
    <DoubleRangeDomain name="range" min="0"/>
    <Documentation>Largest distance to {surface}, both ways, in the data's unit (mm for scans).
      {zero}</Documentation>
  </DoubleVectorProperty>
  <DoubleVectorProperty name="TargetReduction" label="Target Reduction"
                        command="SetTargetReduction" number_of_elements="1" default_values="{share}">
    <DoubleRangeDomain name="range" min="0" max="1"/>
    <Documentation>Share of the triangles to drop, 0 to 1; ends earlier at Maximum Error where that is above
      0. 0: as many as Maximum Error allows.</Documentation>
  </DoubleVectorProperty>"""

_FLAG = """
  <IntVectorProperty name="{name}" command="Set{name}" number_of_elements="1"
                     default_values="{value}">
    <BooleanDomain name="bool"/>
    <Documentation>{text}</Documentation>
  </IntVectorProperty>"""

_ISOSURFACE = """
  <StringVectorProperty name="SelectInputScalars" label="Contour By" animateable="0"
                        command="SetInputArrayToProcess" element_types="0 0 0 0 2"
                        number_of_elements="5">
    <ArrayListDomain attribute_type="Scalars" name="array_list">
      <RequiredProperties><Property function="Input" name="Input"/></RequiredProperties>
    </ArrayListDomain>
    <Documentation>The scalars; inside is where they are &gt;= the isovalue.</Documentation>
  </StringVectorProperty>
  <DoubleVectorProperty name="Isovalues" animateable="1"
                        command="SetValue" set_number_command="SetNumberOfContours"
                        number_of_elements="0" number_of_elements_per_command="1"
                        repeat_command="1" use_index="1">
    <ArrayRangeDomain name="scalar_range">
      <RequiredProperties>
        <Property function="Input" name="Input"/>
        <Property function="ArraySelection" name="SelectInputScalars"/>
      </RequiredProperties>
    </ArrayRangeDomain>
    <Documentation>One closed surface for each, in the scalars' unit.</Documentation>
  </DoubleVectorProperty>
  <IntVectorProperty name="CoordinateFrame" command="SetCoordinateFrame" number_of_elements="1"
                     default_values="0">
    <EnumerationDomain name="enum">
      <Entry value="0" text="As the data say"/>
      <Entry value="1" text="RAS (mm)"/>
      <Entry value="2" text="LPS (mm)"/>
    </EnumerationDomain>
    <Documentation>What the image's coordinates are. It goes into the field data (CoordinateFrame,
      and SPACE for 3D Slicer).</Documentation>
  </IntVectorProperty>"""


@smproxy.filter(name="AdaptisoIsosurface", label="Adaptiso Isosurface")
@smhint.xml(_HINTS)
@smproperty.xml(_FLAG.format(name="ComputeScalars", value=1,
                             text="Point scalars that hold the isovalue."))
@smproperty.xml(_FLAG.format(name="ComputeNormals", value=1,
                             text="Point normals from the image's gradient."))
@smproperty.xml(_AIMS.format(surface="the surface of marching cubes", share=0,
                             zero="0: 0.15 of the least distance between planes of samples."))
@smproperty.xml(_ISOSURFACE)
@smproperty.input(name="Input", port_index=0)
@smdomain.xml('<InputArrayDomain attribute_type="point" number_of_components="1" name="scalars"/>')
@smdomain.datatype(dataTypes=["vtkImageData"], composite_data_supported=False)
class AdaptisoIsosurface(vtk.Isosurface):
    """Adaptive isosurfaces of an image: closed, within a proved distance of marching cubes."""


@smproxy.filter(name="AdaptisoSimplify", label="Adaptiso Simplify")
@smhint.xml(_HINTS)
@smproperty.xml(_FLAG.format(name="KeepBorders", value=0,
                             text="Points on open borders stay as they are."))
@smproperty.xml(_AIMS.format(surface="the input", share=0.9,
                             zero="0: no bound; then Target Reduction must be above 0."))
@smproperty.input(name="Input", port_index=0)
@smdomain.datatype(dataTypes=["vtkPolyData"], composite_data_supported=False)
class AdaptisoSimplify(vtk.Simplify):
    """Fewer triangles within a proved distance; point data come along."""
