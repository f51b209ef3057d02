#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Core/TriangleMesh.h"

namespace adaptiso::selftest {

/// A solid whose size is known on paper.
struct Solid {
    /// How deep a point (LPS mm) lies inside, mm; negative outside. The distance to the surface.
    std::function<double(const Vec3&)> depthMm;
    Vec3 centreMm;  ///< LPS
    double volumeMm3 = 0;
    double areaMm2 = 0;
    double smallestRadiusMm = 0;  ///< of its surface's curvature
    int pieces = 1;               ///< of its surface
    int genus = 0;
};

Solid sphere(const Vec3& centreMm, double radiusMm);
/// Ring about an axis along z. \pre majorRadiusMm > minorRadiusMm
Solid torus(const Vec3& centreMm, double majorRadiusMm, double minorRadiusMm);

/// An image in memory, int16 as a CT has it.
struct Phantom {
    ImageGeometry geometry;
    std::vector<std::int16_t> samples;  ///< x fastest
};

/// Axes at right angles that lie along none of space's, the middle of the image at `centreMm`.
ImageGeometry obliqueGeometry(const Index3& size, const Vec3& spacingMm, const Vec3& centreMm);

/// Samples of distance: kSurface on the solid's surface, kPerMm more for each mm inwards.
inline constexpr double kSurface = 1000, kPerMm = 100;
Phantom distancePhantom(const Solid& solid, const ImageGeometry& geometry);

/// Two steel balls of this diameter (mm) in air as a CT sees them: each sample is the mean over its
/// voxel, with noise of 20 HU; -1000 in air, 3000 in the balls. 0.5 mm voxels.
Phantom bearingBalls(double diameterMm);
inline constexpr double kBallSurface = 1000;  ///< half of a voxel is ball

/// The image as an uncompressed NIfTI-1 file.
std::string niftiFile(const Phantom& phantom);

/// `mesh` moved by `byMm`.
TriangleMesh translated(TriangleMesh mesh, const Vec3& byMm);

/// A mesh with one defect, and the name of the check that has to find it.
struct PlantedDefect {
    std::string name;
    std::string_view key;  ///< Check::key
    TriangleMesh mesh;
};

/// One for each check of a single surface.
/// \param ball  closed and sound, one piece of genus 0, 60 mm wide
/// \param ring  the same of genus 1
std::vector<PlantedDefect> plantDefects(const TriangleMesh& ball, const TriangleMesh& ring);

}  // namespace adaptiso::selftest
