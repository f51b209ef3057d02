#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "adaptiso/Tetrahedra/Tetrahedra.h"

namespace adaptiso {

/// Writes tetrahedra with their regions. Numbers have nine digits; the same mesh gives the same
/// bytes. \throws FileError  a file can't be written
///
/// Gmsh's .msh 2.2 (SimNIBS, DUNEuro) and 4.1, text; regions are physical volumes with names.
void writeMsh22(const TetrahedralMesh& mesh, std::span<const TetrahedraRegion> regions,
                const std::filesystem::path& path);
void writeMsh41(const TetrahedralMesh& mesh, std::span<const TetrahedraRegion> regions,
                const std::filesystem::path& path);
/// VTK's .vtu, text, with the array "tissue" of labels.
void writeVtu(const TetrahedralMesh& mesh, const std::filesystem::path& path);
/// DUNE's .dgf. Its one parameter is the place of the region in `regions`, from 0: DUNEuro takes it
/// for a place in a list of conductivities.
void writeDgf(const TetrahedralMesh& mesh, std::span<const TetrahedraRegion> regions,
              const std::filesystem::path& path);

}  // namespace adaptiso
