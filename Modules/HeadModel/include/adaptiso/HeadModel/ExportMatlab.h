#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/HeadModel/HeadBoundaries.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/MeshIO/PointFiles.h"

namespace adaptiso {

/// A surface of a head model, and what conducts within it.
struct HeadLayer {
    HeadSurface surface = HeadSurface::InnerSkull;
    double conductivity = 0;  ///< S/m
    TriangleMesh mesh;        ///< in the frame and unit of the file
};

/// FieldTrip's word for a frame: "scanras", "scanlps", and "ras" of tkRAS, whose axes it has and
/// whose origin it does not name.
std::string fieldTripCoordsys(CoordinateFrame frame);

/// Writes a head model as FieldTrip keeps one: a MATLAB file with the variable `headmodel`, a
/// struct of
///   bnd           1 x N structs of pos (V x 3), tri (T x 3, from 1, outward), unit, coordsys
///   cond          S/m, of the compartment within each
///   tissue        {'scalp', 'skull', 'csf', 'brain'}, as far as there are layers; of five
///                 'gray', 'white' last
///   skin_surface  1: surfaces go from the outermost to the innermost
///   source        N
///   type          'openmeeg', or 'singleshell' of one surface, which FieldTrip solves as it is
///   unit          'mm'
///   coordsys      as fieldTripCoordsys() has it
/// There is no `mat`: ft_headmodel_openmeeg, _dipoli and _bemcp compute it from bnd and cond.
/// \param layers  inside out, mm
/// \throws InvalidInput  no layer   \throws FileError  the file can't be written
void writeFieldTripModel(std::span<const HeadLayer> layers, const std::filesystem::path& path,
                         CoordinateFrame frame);

/// Reads a file of writeFieldTripModel(), inside out; surfaces are recognised by their tissue.
/// \throws FileError
std::vector<HeadLayer> readFieldTripModel(const std::filesystem::path& path);

/// Writes a surface as Brainstorm keeps one: Comment, Vertices (V x 3, metres), Faces (T x 3, from
/// 1, clockwise seen from outside, as Brainstorm has them), VertNormals (V x 3, outward).
/// Brainstorm takes the points of such files for its own (SCS) coordinates.
/// \param metres  with one outward normal a point
/// \throws FileError  the file can't be written
void writeBrainstormSurface(const TriangleMesh& metres, const std::filesystem::path& path,
                            const std::string& comment);

/// Reads a file of writeBrainstormSurface(), counter-clockwise, without normals. \throws FileError
TriangleMesh readBrainstormSurface(const std::filesystem::path& path);

/// Potentials of unit dipoles at electrodes, without a reference.
struct LeadField {
    std::string solver;        ///< "MNE-Python 1.3.0"
    std::vector<double> gain;  ///< V/(A m), a row an electrode; column by column, one a dipole
    std::vector<NamedPoint> electrodes;    ///< mm
    std::vector<Vec3> places, directions;  ///< of the dipoles, mm
};

/// Writes a lead field for MATLAB and SciPy: gain, gain_unit, reference, solver and, by FieldTrip's
/// names, label and elecpos of the rows, pos and ori of the columns, their unit and coordsys.
/// \throws FileError  the file can't be written
void writeLeadField(const LeadField& field, const std::filesystem::path& path,
                    CoordinateFrame frame);

/// The gain of writeLeadField()'s file. \throws FileError
std::vector<double> readLeadFieldGain(const std::filesystem::path& path);

}  // namespace adaptiso
