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

/// The most points that Cauchy's columns of six digits can number.
inline constexpr std::int64_t kMostCauchyPoints = 999'999;
/// The geometry file of Cauchy (SimBio, DUNEuro: .geo), coordinates in mm.
/// \pre  at most kMostCauchyPoints points
void writeCauchy(const TetrahedralMesh& mesh, const std::filesystem::path& path);
/// The conductivity of each element beside it (.knw), as tensors in S/m: DUNEuro brings both files
/// to S/mm.
/// \param conductivities  of each of `regions`, S/m
void writeCauchyTensors(const TetrahedralMesh& mesh, std::span<const TetrahedraRegion> regions,
                        std::span<const double> conductivities, const std::filesystem::path& path);

}  // namespace adaptiso
