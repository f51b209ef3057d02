#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/HeadModel/ConductivityModel.h"
#include "adaptiso/HeadModel/HeadBoundaries.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"

namespace adaptiso {

/// OpenMEEG computes in the unit that it is given: with metres potentials come out in volts;
/// millimetres are what MNE's and FieldTrip's users hand it.
enum class OpenMeegUnit { Millimetres, Metres };

/// The texts of a model's .geom (Domain Description 1.1, with relative names) and .cond, for one
/// surface (domains Brain, Air), three (Brain, Skull, Skin, Air), four (Brain, CSF, Skull, Skin,
/// Air) or five (White, Gray, CSF, ...), from inside out. \pre 1, 3, 4 or 5 files \throws
/// InvalidInput otherwise; checkConductivities()
std::string openMeegGeometry(std::span<const std::string> triangleFiles);
std::string openMeegConductivities(std::size_t surfaces, const ConductivityModel& model);

/// Writes a surface (LPS mm) as .tri, with normals, in the frame and unit given. Nothing in the
/// file says either.
/// \param volume  as lpsToFrame() needs it   \throws InvalidInput, FileError  as writeMesh()
void writeOpenMeegSurface(const TriangleMesh& surface, const std::filesystem::path& path,
                          CoordinateFrame frame, OpenMeegUnit unit,
                          const std::optional<ImageGeometry>& volume = std::nullopt);

/// A domain: inside of some interfaces, outside of others.
struct OpenMeegDomain {
    std::string name;
    std::vector<std::size_t> inside;   ///< interfaces with "-"
    std::vector<std::size_t> outside;  ///< interfaces with "+"
    double conductivity = 0;           ///< S/m
};

/// A set of .geom, .cond and .tri as read.
struct OpenMeegModel {
    struct Interface {
        std::string name;
        std::string file;
        TriangleMesh mesh;  ///< as stored: unit and frame are not known
    };
    std::vector<Interface> interfaces;
    std::vector<OpenMeegDomain> domains;
};

/// Reads a model back and checks every rule that OpenMEEG's readers have or rely on:
///   .geom  first line exactly "# Domain Description 1.1"; "Interfaces N" and N lines
///          'Interface Name: "file"'; "Domains M" and M lines "Domain Name: -A +B ..."; names of
///          letters, digits, '_' and '-', each given once; nothing after the last domain; each
///          interface is the border of exactly two domains, '-' of one and '+' of the other;
///          exactly one domain is inside nothing (the air); file names relative, without "..",
///          ending in .tri
///   .tri   as decodeMesh() reads it; triangles outward, unit normals that point outward as well
///   .cond  first line exactly "# Properties Description 1.0 (Conductivities)"; "Name value" once
///          for every domain and for nothing else; 0 for the air, finite and above 0 for the rest
/// Blank lines are skipped everywhere, lines that begin with '#' nowhere but where they are asked
/// for.
/// \throws FileError  "<file>: line n: what is wrong"; only regular files below the .geom's folder
///         are opened
OpenMeegModel readOpenMeegModel(const std::filesystem::path& geometry,
                                const std::filesystem::path& conductivities);

}  // namespace adaptiso
