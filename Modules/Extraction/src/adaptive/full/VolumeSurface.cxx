#include "adaptive/full/VolumeSurface.h"

#include <cmath>

#include "adaptiso/Core/HugePages.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptive/proof/ErrorBound.h"
#include "adaptive/rounds/BorderMarks.h"
#include "adaptive/rounds/BrickRound.h"
#include "filling/MeshRepair.h"

namespace adaptiso::detail {
namespace {

constexpr std::int64_t kPiece = 1 << 14;

/// Drops vertices without a triangle.
void dropUnusedVertices(TriangleMesh& mesh) {
    constexpr VertexId kUnused = -1;
    std::vector<VertexId> number(mesh.points.size(), kUnused);
    for (const auto& t : mesh.triangles) {
        for (const VertexId v : t) number[v] = 0;
    }
    VertexId used = 0;
    for (std::size_t v = 0; v < number.size(); ++v) {
        if (number[v] == kUnused) continue;
        number[v] = used++;
        mesh.points[number[v]] = mesh.points[v];
        mesh.normals[number[v]] = mesh.normals[v];
    }
    if (used == std::ssize(mesh.points)) return;
    mesh.points.resize(used);
    mesh.normals.resize(used);
    for (auto& t : mesh.triangles) {
        for (VertexId& v : t) v = number[v];
    }
}

TriangleMesh toMesh(const SimplifiedSurface& surface, const ImageGeometry& geometry,
                    const MetricFrame& frame, const LatticeSampler& sampler) {
    TriangleMesh mesh;
    assignInHugePages(mesh.points, surface.points.size());
    assignInHugePages(mesh.normals, surface.points.size());
    parallelForPieces(std::ssize(mesh.points), kPiece, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t v = begin; v < end; ++v) {
            const Vec3 index = frame.toIndex(surface.points[v]);
            mesh.points[v] = geometry.toPhysical(index);
            mesh.normals[v] = toNormal(sampler.normalAt(index));
        }
    });
    reserveInHugePages(mesh.triangles, surface.triangles.size());
    const bool isMirrored = geometry.isMirrored();
    for (const auto& t : surface.triangles) {
        const auto id = [&](int c) { return static_cast<VertexId>(t[c]); };
        mesh.triangles.push_back(isMirrored ? adaptiso::Triangle{id(0), id(2), id(1)}
                                            : adaptiso::Triangle{id(0), id(1), id(2)});
    }
    dropUnusedVertices(mesh);
    completeNormals(mesh);
    return mesh;
}

}  // namespace

VolumeSurface::VolumeSurface(const ImageGeometry& geometry, const LatticeSampler& sampler,
                             const Bricks& bricks)
    : FullSurface(MetricFrame(geometry)), geometry_(geometry), sampler_(sampler), bricks_(bricks) {}

void VolumeSurface::stayIn(const BoundingBox& moving, const BoundingBox& box) {
    moving_ = moving;
    keepIn(box);
}

SimplifiedSurface VolumeSurface::firstRound(const TightPlaces& tight, const PatchLimits& limits,
                                            CollapseCosts* costs) const {
    SimplifiedSurface surface = simplifyBricks(sampler_, bricks_, frame(), tight, limits, costs,
                                               moving_ ? &*moving_ : nullptr);
    if (bricks_.grid().border == Border::Open) {
        std::vector<std::uint8_t> faces(surface.points.size());
        parallelForPieces(std::ssize(faces), kPiece, [&](std::int64_t begin, std::int64_t end) {
            for (std::int64_t v = begin; v < end; ++v) faces[v] = facesAt(surface.points[v]);
        });
        markBorders(openHalfEdges(surface, faces), surface);
        // the border is to lie on the volume's faces
        for (std::size_t v = 0; v < faces.size(); ++v) {
            if (surface.marks[v] == Patch::kBorder && faces[v] > 1) {
                surface.states[v] = Patch::State::Final;
            }
        }
    }
    return surface;
}

/// How many faces of the volume a point lies on.
std::uint8_t VolumeSurface::facesAt(const Vec3& point) const {
    constexpr double kOnFace = 1e-6;
    const Vec3 index = frame().toIndex(point);
    std::uint8_t faces = 0;
    for (int a = 0; a < 3; ++a) {
        const auto last = static_cast<double>(geometry_.size[a] - 1);
        if (std::abs(index[a]) < kOnFace || std::abs(index[a] - last) < kOnFace) ++faces;
    }
    return faces;
}

std::unique_ptr<DistanceProof> VolumeSurface::proof(double limitMm) const {
    return std::make_unique<ErrorProof>(sampler_, bricks_, frame(), limitMm);
}

TriangleMesh VolumeSurface::meshOf(const SimplifiedSurface& surface) const {
    return toMesh(surface, geometry_, frame(), sampler_);
}

double VolumeSurface::largestExtentMm() const {
    const Index3& size = geometry_.size;
    return norm(frame().fromIndex({static_cast<double>(size[0]), static_cast<double>(size[1]),
                                   static_cast<double>(size[2])}));
}

}  // namespace adaptiso::detail
