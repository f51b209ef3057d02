// OpenVDB: samples into a sparse grid, then volumeToMesh with an adaptivity; quads are halved.
//
// It takes low values for the inside and what lies beyond the volume for background; the surface is
// closed there, up to a voxel outside the last sample.
#include <openvdb/openvdb.h>
#include <openvdb/tools/Dense.h>
#include <openvdb/tools/VolumeToMesh.h>
#include <tbb/global_control.h>

#include <memory>
#include <vector>

#include "PeerRun.h"

namespace adaptiso::benchmarks {
namespace {

struct Polygons {
    std::vector<openvdb::Vec3s> points;  // voxel indices
    std::vector<openvdb::Vec3I> triangles;
    std::vector<openvdb::Vec4I> quads;
};

openvdb::FloatGrid::Ptr gridOf(const VolumeView& volume) {
    const double background = valueRange(volume).minimum;
    auto grid = openvdb::FloatGrid::create(static_cast<float>(background));
    dispatchPixelType(volume, [&](const auto& typed) {
        using Sample = std::remove_cvref_t<decltype(typed.samples[0])>;
        const Index3& n = typed.geometry.size;
        const openvdb::CoordBBox box(0, 0, 0, static_cast<int>(n[0]) - 1,
                                     static_cast<int>(n[1]) - 1, static_cast<int>(n[2]) - 1);
        // NOLINTNEXTLINE(cppcoreguidelines-pro-type-const-cast): Dense has no array of constants
        const openvdb::tools::Dense<Sample, openvdb::tools::LayoutXYZ> dense(
            box, const_cast<Sample*>(typed.samples));
        openvdb::tools::copyFromDense(dense, *grid, 0.0F);
    });
    return grid;
}

TriangleMesh toMesh(const Polygons& polygons, const ImageGeometry& geometry) {
    TriangleMesh mesh;
    for (const openvdb::Vec3s& p : polygons.points) {
        mesh.points.push_back(geometry.toPhysical({p.x(), p.y(), p.z()}));
    }
    for (const openvdb::Vec3I& t : polygons.triangles) mesh.triangles.push_back({t[0], t[1], t[2]});
    for (const openvdb::Vec4I& q : polygons.quads) {
        mesh.triangles.push_back({q[0], q[1], q[2]});
        mesh.triangles.push_back({q[0], q[2], q[3]});
    }
    return mesh;
}

std::function<PeerSurface()> prepare(const VolumeView& volume, const PeerTask& task) {
    openvdb::initialize();
    return [volume, task] {
        const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                          static_cast<std::size_t>(task.threads));
        auto result = std::make_shared<Polygons>();
        openvdb::tools::volumeToMesh(*gridOf(volume), result->points, result->triangles,
                                     result->quads, task.isovalue, task.adaptivity);
        return PeerSurface{
            [result, geometry = volume.geometry()] { return toMesh(*result, geometry); }, {}, {}};
    };
}

}  // namespace
}  // namespace adaptiso::benchmarks

int main(int argc, char** argv) {
    using namespace adaptiso::benchmarks;
    return runPeer(argc, argv, {"peerOpenVdb", {"volumeToMesh"}, prepare});
}
