#include "adaptive/full/VolumeSurface.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "adaptiso/Core/Memory.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Extraction/Tiles.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"
#include "adaptiso/MeshQuality/Winding.h"
#include "adaptive/Parameters.h"
#include "adaptive/rounds/BorderMarks.h"
#include "adaptive/rounds/BrickRound.h"
#include "repair/MeshRepair.h"

namespace adaptiso::detail {
namespace {

constexpr std::int64_t kGrain = 1 << 14;

}  // namespace

VolumeSurface::VolumeSurface(const ImageGeometry& geometry, const LatticeSampler& sampler,
                             const Bricks& bricks)
    : FullSurface(MetricFrame(geometry)), geometry_(geometry), sampler_(sampler), bricks_(bricks) {}

void VolumeSurface::stayIn(const BoundingBox& moving, const BoundingBox& box) {
    moving_ = moving;
    keepIn(box);
}

SimplifiedSurface VolumeSurface::firstRound(const PatchLimits& limits, CollapseCosts* costs) const {
    SimplifiedSurface surface =
        simplifyBricks(sampler_, bricks_, frame(), limits, costs, moving_ ? &*moving_ : nullptr);
    if (bricks_.grid().border == Border::Open) {
        std::vector<std::uint8_t> faces(surface.points.size());
        parallelForPieces(std::ssize(faces), kGrain, [&](std::int64_t begin, std::int64_t end) {
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

std::vector<Vec3> VolumeSurface::physicalPoints(const SimplifiedSurface& surface) const {
    std::vector<Vec3> points;
    assignInHugePages(points, surface.points.size());
    parallelForPieces(std::ssize(points), kGrain, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t v = begin; v < end; ++v) {
            points[v] = geometry_.toPhysical(frame().toIndex(surface.points[v]));
        }
    });
    return points;
}

TriangleMesh VolumeSurface::meshOf(const SimplifiedSurface& surface) const {
    TriangleMesh mesh;
    mesh.points = physicalPoints(surface);
    assignInHugePages(mesh.normals, surface.points.size());
    parallelForPieces(std::ssize(mesh.points), kGrain, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t v = begin; v < end; ++v) {
            mesh.normals[v] = toNormal(sampler_.normalAt(frame().toIndex(surface.points[v])));
        }
    });
    assignInHugePages(mesh.triangles, surface.triangles.size());
    const bool isMirrored = geometry_.isMirrored();
    parallelForPieces(surface.triangleCount(), kGrain, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t t = begin; t < end; ++t) {
            const auto& [a, b, c] = surface.triangles[t];
            mesh.triangles[t] =
                isMirrored ? adaptiso::Triangle{a, c, b} : adaptiso::Triangle{a, b, c};
        }
    });
    mesh = withoutUnusedPoints(std::move(mesh));
    completeNormals(mesh);
    return mesh;
}

std::vector<std::int64_t> VolumeSurface::crossingTriangles(
    const SimplifiedSurface& surface, const std::vector<std::uint8_t>& isFine) const {
    const std::vector<Vec3> points = physicalPoints(surface);
    return adaptiso::crossingTriangles(TriangleView{points, surface.triangles},
                                       cellsOf(surface, isFine));
}

/// A triangle of the full surface lies in the cell that marching cubes made it in. Triangles of
/// different cells cannot cross:
///   - A cell's triangles lie in the cell. In a face of it they have its iso-lines and the ends of
///     these, no more: no triangle has a corner off the face nearer to it than kHair / 12 (the
///     middle of a loop of twelve), none has an edge across the face that is no iso-line, and none
///     lies in it (BoxCase::hasChordOnFace).
///   - Both cells at a face have the same iso-lines, with the same ends. Two iso-lines cut off
///     opposite corners of the face: they are kHair / 1.5 apart, as is an iso-line from the end of
///     the other. So triangles of two cells have an iso-line or the end of one in common, or are
///     apart. Cells that have just a lattice edge in common have the one crossing on it.
///   - What is apart is so by more than kHair / 1.5 * kHair / 12 / 4 = 1e-8 cells, however flat the
///     triangles lie to the face; and the angle between triangles with a corner in common is more
///     than kHair / 12 / 2. Rounding by less than kFineRounding changes neither.
/// Which triangles have a corner in common is the mesh's to say: they have the same number.
std::vector<std::uint64_t> VolumeSurface::cellsOf(const SimplifiedSurface& surface,
                                                  const std::vector<std::uint8_t>& isFine) const {
    const auto fine = std::count(isFine.begin(), isFine.end(), 1);
    const double fewest = kFewFinal * static_cast<double>(isFine.size());
    if (!(static_cast<double>(fine) > fewest) || !roundsFinely()) return {};
    std::vector<std::uint64_t> cells(surface.triangles.size(), kNoCell);
    const Index3 count{geometry_.size[0] + 1, geometry_.size[1] + 1, geometry_.size[2] + 1};
    parallelForPieces(std::ssize(cells), kGrain, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t t = begin; t < end; ++t) {
            if (isFine[t] == 0) continue;
            const auto& [a, b, c] = surface.triangles[t];
            const Vec3 middle = frame().toIndex(
                (1.0 / 3) * (surface.points[a] + surface.points[b] + surface.points[c]));
            Index3 cell;  // the first may lie before the first sample
            for (int axis = 0; axis < 3; ++axis) {
                cell[axis] = static_cast<std::int64_t>(std::floor(middle[axis])) + 1;
            }
            cells[t] =
                static_cast<std::uint64_t>(cell[0] + count[0] * (cell[1] + count[1] * cell[2]));
        }
    });
    return cells;
}

/// Points of the surface are rounded by less than kFineRounding, seen in cells: on the way from the
/// lattice to the metric frame, back, and to physical space.
bool VolumeSurface::roundsFinely() const {
    const auto largest = [](const Mat3& m) {
        double sum = 0;
        for (const Vec3& column : m.column) sum += norm(column);
        return sum;
    };
    const Mat3& step = geometry_.indexToPhysical;
    double farthest = 1;  // index
    for (const std::int64_t samples : geometry_.size) {
        farthest = std::max(farthest, static_cast<double>(samples));
    }
    constexpr double kRoundings = 32;  // to units in the last place, all steps together
    const double farthestMm = norm(geometry_.originMm) + largest(step) * farthest;
    return kRoundings * std::numeric_limits<double>::epsilon() * largest(inverse(step)) *
               farthestMm <
           kFineRounding;
}

std::vector<std::int64_t> VolumeSurface::insideOut(const SimplifiedSurface& surface) const {
    if (bricks_.grid().border == Border::Open) return {};
    if (moving_) return {};  // a tile, which is open at its walls
    return findInsideOutPieces(surface.view(), {}).triangles;
}

double VolumeSurface::largestExtentMm() const {
    const Index3& size = geometry_.size;
    return norm(frame().fromIndex({static_cast<double>(size[0]), static_cast<double>(size[1]),
                                   static_cast<double>(size[2])}));
}

}  // namespace adaptiso::detail
