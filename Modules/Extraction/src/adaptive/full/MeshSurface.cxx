#include "adaptive/full/MeshSurface.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Core/Memory.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"
#include "adaptive/Parameters.h"
#include "adaptive/rounds/BorderMarks.h"
#include "adaptive/rounds/PatchRound.h"

namespace adaptiso::detail {
namespace {

/// An order of triangles by their corners' coordinates, to find equal ones.
bool isBefore(const Corners& a, const Corners& b) {
    return std::lexicographical_compare(
        a.begin(), a.end(), b.begin(), b.end(), [](const Vec3& p, const Vec3& q) {
            return std::tie(p.x, p.y, p.z) < std::tie(q.x, q.y, q.z);
        });
}

constexpr std::int64_t kSamplePiece = 1 << 12;

/// The side of a voxel of the volume that such triangles would come from: marching cubes makes
/// about three triangles for each voxel's face that the surface covers.
double voxelOf(const MeshParts& parts, std::optional<double> boundMm) {
    std::vector<double> areas;
    assignInHugePages(areas, parts.triangles.size());
    parallelForPieces(std::ssize(areas), kSamplePiece, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t t = begin; t < end; ++t) {
            const Corners c = parts.view().cornersOf(t);
            areas[t] = 0.5 * norm(areaVector2(c[0], c[1], c[2]));
        }
    });
    const auto middle = areas.begin() + std::ssize(areas) / 2;
    std::nth_element(areas.begin(), middle, areas.end());
    BoundingBox box{parts.points[0], parts.points[0]};
    for (const Vec3& p : parts.points) box.add(p);
    const double voxel =
        std::max(std::sqrt(kTrianglesPerFace * *middle), kLeastVoxel * norm(box.size()));
    // single sheets are looked for within a voxel, and serve distances of half of it
    return std::clamp(boundMm.value_or(0) / kSheetDistance, voxel, kWidestVoxel * voxel);
}

MetricFrame frameOf(double voxel) {
    ImageGeometry geometry;
    for (int a = 0; a < 3; ++a) geometry.indexToPhysical.column[a] = {};
    geometry.indexToPhysical.column[0].x = geometry.indexToPhysical.column[1].y =
        geometry.indexToPhysical.column[2].z = voxel;
    return MetricFrame(geometry);
}

}  // namespace

MeshSurface::MeshSurface(const TriangleMesh& input, const MeshParts& parts,
                         std::optional<double> boundMm)
    : FullSurface(frameOf(voxelOf(parts, boundMm))), input_(input), parts_(parts) {
    for (const auto* const triangles : {&parts.crossing.found, &parts.crossing.undecided}) {
        for (const std::int64_t t : *triangles) {
            Corners corners = parts.view().cornersOf(t);
            for (Vec3& p : corners) p = p + parts.origin;
            crossing_.push_back(corners);
        }
    }
    std::sort(crossing_.begin(), crossing_.end(), isBefore);
    std::vector<std::uint32_t> marks = parts.marks;
    if (!parts.borderEdges.empty()) marks.resize(parts.points.size(), Patch::kPlain);
    for (const std::uint64_t h : parts.borderEdges) {
        marks[parts.triangles[h / 3][h % 3]] = Patch::kBorder;
    }
    const InsideOutPieces before = judge(parts.view(), marks);
    mostInsideOut_ = before.count + before.flat;
}

/// Leaves out pieces that are open, were cut apart, or cross others.
InsideOutPieces MeshSurface::judge(const TriangleView& surface,
                                   std::span<const std::uint32_t> marks) const {
    std::vector<std::uint8_t> isLeftOut(marks.size());
    for (std::size_t v = 0; v < marks.size(); ++v) {
        isLeftOut[v] = static_cast<std::uint8_t>(marks[v] != Patch::kPlain);
    }
    if (!crossing_.empty()) {
        isLeftOut.resize(surface.points.size());
        for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
            Corners corners = surface.cornersOf(t);
            for (Vec3& p : corners) p = p + parts_.origin;
            if (std::binary_search(crossing_.begin(), crossing_.end(), corners, isBefore)) {
                isLeftOut[surface.triangles[t][0]] = 1;
            }
        }
    }
    return findInsideOutPieces(surface, isLeftOut);
}

std::vector<std::int64_t> MeshSurface::insideOut(const SimplifiedSurface& surface) const {
    InsideOutPieces now = judge(surface.view(), surface.marks);
    if (now.count <= mostInsideOut_) return {};
    return std::move(now.triangles);
}

SimplifiedSurface MeshSurface::firstRound(const PatchLimits& limits, CollapseCosts* costs) const {
    SimplifiedSurface surface = unchanged(limits.keepsHeirs);
    runPatchRound(surface, {}, frame(), {limits}, costs);
    return surface;
}

/// The mesh as it is.
SimplifiedSurface MeshSurface::unchanged(bool keepsHeirs) const {
    SimplifiedSurface surface;
    reserveInHugePages(surface.points, parts_.points.size());
    surface.points = parts_.points;
    surface.marks = parts_.marks;
    reserveInHugePages(surface.triangles, parts_.triangles.size());
    surface.triangles = parts_.triangles;
    surface.fineTriangles = surface.tableTriangles = std::ssize(surface.triangles);
    setQuadrics(surface);
    surface.states.assign(surface.points.size(), Patch::State::Open);
    addSamples(areasAround(parts_.view()), surface);
    for (std::size_t v = 0; v < surface.points.size(); ++v) {
        if (!parts_.isKept.empty() && parts_.isKept[v] != 0) {
            surface.states[v] = Patch::State::Final;
        }
    }
    if (keepsHeirs) {
        surface.heirs.resize(parts_.points.size());
        std::iota(surface.heirs.begin(), surface.heirs.end(), SurfaceState::Number{0});
    }
    if (!parts_.borderEdges.empty()) markBorders(parts_.borderEdges, surface);
    return surface;
}

/// \param areas  the sums of area vectors around each point \return of each triangle
std::vector<std::uint8_t> MeshSurface::bentTriangles(const std::vector<Vec3>& areas) const {
    std::vector<std::uint8_t> isBent(parts_.triangles.size());
    parallelForPieces(std::ssize(isBent), kSamplePiece, [&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t t = begin; t < end; ++t) {
            const MeshParts::Triangle& v = parts_.triangles[t];
            isBent[t] =
                static_cast<std::uint8_t>(cornersBend(areas[v[0]], areas[v[1]], areas[v[2]]));
        }
    });
    return isBent;
}

/// All points; and the middles of triangles in which the surface bends, as a ridge could pass
/// unseen there.
void MeshSurface::addSamples(const std::vector<Vec3>& areas, SimplifiedSurface& surface) const {
    std::vector<std::uint8_t> clearances(parts_.points.size(), 0);
    SheetClearance::fillIn(parts_.points, areas, frame(), clearances);
    const std::vector<std::uint8_t> isBent = bentTriangles(areas);
    // to the sample: noise bends all triangles
    const std::size_t count =
        parts_.points.size() + std::count(isBent.begin(), isBent.end(), std::uint8_t{1});
    reserveInHugePages(surface.samples, count);
    reserveInHugePages(surface.sampleTriangle, count);
    surface.samples.resize(parts_.points.size());
    surface.sampleTriangle.resize(parts_.points.size());
    parallelForPieces(
        std::ssize(surface.samples), kSamplePiece, [&](std::int64_t begin, std::int64_t end) {
            for (std::int64_t v = begin; v < end; ++v) {
                surface.samples[v] = Sample::at(parts_.points[v], areas[v], clearances[v]);
            }
        });
    for (std::size_t t = isBent.size(); t-- > 0;) {
        for (const std::uint32_t v : parts_.triangles[t]) {
            surface.sampleTriangle[v] = static_cast<SurfaceState::Number>(t);
        }
    }
    for (std::size_t t = 0; t < isBent.size(); ++t) {
        if (isBent[t] == 0) continue;
        const MeshParts::Triangle& v = parts_.triangles[t];
        surface.samples.push_back(
            Sample::middleOf(parts_.view().cornersOf(t),
                             std::min({clearances[v[0]], clearances[v[1]], clearances[v[2]]})));
        surface.sampleTriangle.push_back(static_cast<SurfaceState::Number>(t));
    }
}

/// Points that were cut apart become one again.
TriangleMesh MeshSurface::meshOf(const SimplifiedSurface& surface) const {
    constexpr VertexId kUnused = -1, kUsed = 0;
    std::vector<VertexId> number(surface.points.size(), kUnused),
        ofMark(parts_.nonManifold.size(), kUnused);
    for (const auto& t : surface.triangles) {
        for (const std::uint64_t v : t) number[v] = kUsed;
    }
    TriangleMesh mesh;
    for (std::size_t v = 0; v < number.size(); ++v) {
        if (number[v] == kUnused) continue;
        const std::uint32_t mark = surface.marks.empty() ? Patch::kPlain : surface.marks[v];
        VertexId* known = mark > Patch::kBorder ? &ofMark[mark - Patch::kBorder - 1] : nullptr;
        if (known != nullptr && *known != kUnused) {
            number[v] = *known;
            continue;
        }
        number[v] = std::ssize(mesh.points);
        if (known != nullptr) *known = number[v];
        mesh.points.push_back(surface.points[v] + parts_.origin);
    }
    mesh.triangles.reserve(surface.triangles.size());
    for (const auto& [a, b, c] : surface.triangles) {
        mesh.triangles.push_back({number[a], number[b], number[c]});
    }
    return mesh;
}

std::vector<std::int64_t> MeshSurface::crossingTriangles(const SimplifiedSurface& surface,
                                                         const std::vector<std::uint8_t>&) const {
    const TriangleMesh mesh = meshOf(surface);
    std::vector<std::int64_t> crossing = adaptiso::crossingTriangles(mesh);
    std::erase_if(crossing, [&](std::int64_t t) {
        return std::binary_search(crossing_.begin(), crossing_.end(), cornersOf(mesh, t), isBefore);
    });
    return crossing;
}

double MeshSurface::largestExtentMm() const {
    const BoundingBox box = boundingBox(input_);
    return norm(box.size());
}

}  // namespace adaptiso::detail
