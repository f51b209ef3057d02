// CGAL (GPL) as a referee of distances: this program alone links it, nothing that is installed
// does.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/distance.h>
#include <CGAL/Surface_mesh.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "RandomVolumes.h"
#include "Support/AnalyticVolumes.h"
#include "Support/Meshes.h"
#include "adaptiso/Extraction/Simplify.h"
#include "adaptiso/ImageIO/ReadVolume.h"
#include "adaptiso/Labels/Labels.h"
#include "adaptiso/MeshQuality/HausdorffInterval.h"
#include "adaptiso/Preprocessing/Preprocess.h"

namespace adaptiso::testing {
namespace {

using CgalMesh = CGAL::Surface_mesh<CGAL::Exact_predicates_inexact_constructions_kernel::Point_3>;

constexpr double kCgalErrorMm = 1e-4;

/// The triangles one by one, as they may be no manifold.
CgalMesh toCgal(const TriangleMesh& mesh) {
    CgalMesh cgal;
    for (std::int64_t t = 0; t < std::ssize(mesh.triangles); ++t) {
        const Corners c = cornersOf(mesh, t);
        const auto add = [&](const Vec3& p) { return cgal.add_vertex({p.x, p.y, p.z}); };
        const auto first = add(c[0]), second = add(c[1]);
        cgal.add_face(first, second, add(c[2]));
    }
    return cgal;
}

void expectAgrees(const TriangleMesh& a, const TriangleMesh& b) {
    const CgalMesh cgalA = toCgal(a), cgalB = toCgal(b);
    const HausdorffReport report = hausdorffDistance(a, b);
    const auto expectHolds = [](const HausdorffInterval& interval, double truthMm) {
        EXPECT_TRUE(interval.isComplete);
        EXPECT_LE(interval.lowerMm, truthMm + kCgalErrorMm);
        EXPECT_GE(interval.upperMm, truthMm - kCgalErrorMm);
    };
    namespace pmp = CGAL::Polygon_mesh_processing;
    expectHolds(report.aToB, pmp::bounded_error_Hausdorff_distance<CGAL::Sequential_tag>(
                                 cgalA, cgalB, kCgalErrorMm));
    expectHolds(*report.bToA, pmp::bounded_error_Hausdorff_distance<CGAL::Sequential_tag>(
                                  cgalB, cgalA, kCgalErrorMm));
}

/// A cube of 32 voxels from the middle of a scan of Debian's mricron-data; empty: not installed.
std::optional<Volume> middleOf(const std::string& scan) {
    const std::filesystem::path path = "/usr/share/mricron/templates/" + scan;
    if (!std::filesystem::exists(path)) return {};
    const Volume volume = readVolume(path).volume;
    CropRanges ranges;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::int64_t begin = volume.view().geometry().size[axis] / 2 - 16;
        ranges[axis] = {begin, begin + 32};
    }
    return cropVolume(volume, ranges);
}

TriangleMesh fullSurface(const VolumeView& volume, double isovalue) {
    return extractFrom(volume, isovalue, Method::MarchingCubes, 4, Border::Closed).mesh;
}
TriangleMesh adaptiveSurface(const VolumeView& volume, double isovalue) {
    return extractFrom(volume, isovalue, Method::Adaptive, 4, Border::Closed).mesh;
}

TriangleMesh simplified(const TriangleMesh& mesh, double maxErrorMm) {
    SimplifyOptions options;
    options.maxErrorMm = maxErrorMm;
    return simplify(mesh, options).mesh;
}

TriangleMesh walls(const VolumeView& labels, double maxErrorMm) {
    LabelOptions options;
    options.maxErrorMm = maxErrorMm;
    const LabelComplex complex = extractLabels(labels, options).complex;
    return {complex.points, {}, complex.triangles};
}

}  // namespace

TEST(CgalDistance, OfSurfacesOfRandomVolumes) {
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        SCOPED_TRACE(seed);
        const HardVolume hard = hardVolume(seed, 8);
        const TriangleMesh full = fullSurface(hard.volume, hard.isovalue);
        if (full.triangles.empty()) continue;
        expectAgrees(adaptiveSurface(hard.volume, hard.isovalue), full);
    }
}

TEST(CgalDistance, OfMeshesOnPaper) {
    const TriangleMesh sphere = icosphere(3, {}, 10);
    expectAgrees(sphere, icosphere(3, {0.5, 0.2, 0.1}, 11));
    expectAgrees(sphere, merged({sphere, translated(cubeMesh(), {30, 0, 0})}));
    expectAgrees(planeMesh(5, 10), translated(planeMesh(7, 4, 0.5), {1, 2, 0}));
    expectAgrees(crossingSpheres(2), icosphere(2));
}

TEST(CgalDistance, OfSimplifiedMeshes) {
    for (const TriangleMesh& mesh :
         {icosphere(4, {}, 10), torusMesh(60, 30, 10, 4), crossingSpheres(3)}) {
        for (const double bound : {0.02, 0.3}) expectAgrees(simplified(mesh, bound), mesh);
    }
}

TEST(CgalDistance, OfAScan) {
    const std::optional<Volume> brain = middleOf("ch2bet.nii.gz");
    if (!brain) GTEST_SKIP() << "needs Debian's mricron-data";
    const TriangleMesh full = fullSurface(*brain, 100), adaptive = adaptiveSurface(*brain, 100);
    expectAgrees(adaptive, full);
    expectAgrees(simplified(full, 0.5), adaptive);
}

TEST(CgalDistance, OfWallsBetweenLabels) {
    const std::optional<Volume> atlas = middleOf("aal.nii.gz");
    if (!atlas) GTEST_SKIP() << "needs Debian's mricron-data";
    const TriangleMesh full = walls(*atlas, 0);
    expectAgrees(walls(*atlas, 0.15), full);
    expectAgrees(walls(*atlas, 0.5), full);
}

}  // namespace adaptiso::testing
