// CGAL (GPL) as a referee of crossing triangles: this program alone links it, nothing that is
// installed does.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>
#include <gtest/gtest.h>

#include "AdaptivePromises.h"
#include "RandomVolumes.h"
#include "Support/Meshes.h"
#include "adaptiso/Mending/Mend.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"

namespace adaptiso::testing {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using CgalMesh = CGAL::Surface_mesh<Kernel::Point_3>;

/// \pre mesh is a 2-manifold
CgalMesh asCgalSurface(const TriangleMesh& mesh) {
    CgalMesh cgal;
    for (const Vec3& p : mesh.points) cgal.add_vertex({p.x, p.y, p.z});
    for (const Triangle& t : mesh.triangles) {
        const auto corner = [&](int c) {
            return CgalMesh::Vertex_index(static_cast<CgalMesh::size_type>(t[c]));
        };
        cgal.add_face(corner(0), corner(1), corner(2));
    }
    EXPECT_EQ(cgal.number_of_faces(), mesh.triangles.size());
    return cgal;
}

/// \pre mesh is a 2-manifold
bool crossesByCgal(const TriangleMesh& mesh) {
    return CGAL::Polygon_mesh_processing::does_self_intersect(asCgalSurface(mesh));
}

bool crossesByUs(const TriangleMesh& mesh) {
    return findSelfIntersections(mesh).pairCount > 0;
}

}  // namespace

TEST(CgalReferee, KnowsCrossingSpheresFromOne) {
    EXPECT_TRUE(crossesByCgal(crossingSpheres(2)));
    EXPECT_FALSE(crossesByCgal(icosphere(2)));
}

TEST(CgalReferee, AgreesWithFindSelfIntersections) {
    // boxes may cross: both answers must come up
    int crossing = 0, clear = 0;
    for (std::uint64_t seed = 0; seed < 900; ++seed) {
        const HardVolume hard = hardVolume(seed, 12);
        const Extraction boxes =
            extractFrom(hard.volume, hard.isovalue, Method::Boxes, 2 << seed % 4, Border::Closed);
        const bool crosses = crossesByUs(boxes.mesh);
        ++(crosses ? crossing : clear);
        EXPECT_EQ(crossesByCgal(boxes.mesh), crosses) << "seed " << seed;
    }
    EXPECT_GT(crossing, 10);
    EXPECT_GT(clear, 10);
}

TEST(CgalReferee, FindsNoCrossingOfTheAdaptiveMethod) {
    for (std::uint64_t seed = 5000; seed < 5300; ++seed) {
        const AdaptiveCase adaptive = adaptiveCase(seed, 10);
        EXPECT_TRUE(keepsAdaptivePromises(adaptive, crossesByCgal)) << describe(seed, adaptive);
    }
}

TEST(CgalReferee, FindsMendedMeshesClosedWithoutCrossing) {
    for (unsigned seed = 100; seed < 130; ++seed) {
        TriangleMesh mesh = seed % 2 == 0 ? icosphere(3) : torusMesh(40, 20, 2, 0.8);
        mesh.normals.clear();
        MendOptions options;
        options.maxErrorMm = 0.05;
        options.maxHoleMm = 10;
        const Mended mended = mend(withRandomDamage(mesh, seed), options);
        EXPECT_FALSE(crossesByCgal(mended.mesh)) << "seed " << seed;
        EXPECT_TRUE(CGAL::is_closed(asCgalSurface(mended.mesh))) << "seed " << seed;
    }
}

}  // namespace adaptiso::testing
