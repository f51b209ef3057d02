#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_map>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Extraction/Tiles.h"
#include "adaptiso/Extraction/detail/SimplifyKeeping.h"
#include "adaptiso/SurfaceProof/HalfEdges.h"
#include "adaptive/mesh/MetricFrame.h"
#include "repair/HashOfPoint.h"
#include "tiles/TileGrid.h"

namespace adaptiso {
namespace {

using namespace detail;

/// New vertices keep this far from the box's walls, in cells: less than vertices of full resolution
/// keep from them (kHair).
constexpr double kWithin = 1e-4;

/// How far the walls of an index box are from being axis-aligned in the metric frame, mm.
Vec3 slantMm(const ImageGeometry& geometry) {
    const MetricFrame frame(geometry);
    Vec3 slant;
    for (int a = 0; a < 3; ++a) {
        for (int b = 0; b < 3; ++b) {
            if (a == b) continue;
            Vec3 step;
            step[b] = static_cast<double>(geometry.size[b]) + 2;
            slant[a] += std::abs(frame.fromIndex(step)[a]);
        }
    }
    return slant;
}

}  // namespace

BoundingBox detail::boxWithin(const BoundingBox& box, const ImageGeometry& geometry) {
    const MetricFrame frame(geometry);
    const Vec3 slant = slantMm(geometry);
    BoundingBox within;
    for (int a = 0; a < 3; ++a) {
        Vec3 low, high;
        low[a] = box.minimum[a] + kWithin;
        high[a] = box.maximum[a] - kWithin;
        within.minimum[a] = frame.fromIndex(low)[a] + slant[a];
        within.maximum[a] = frame.fromIndex(high)[a] - slant[a];
    }
    return within;
}

namespace {

/// The triangles that a run may change, and those that it could come near: cubes of the lattice
/// tell.
class NearPart {
public:
    /// \param reach  how far what is new may lie from what was there, cells
    NearPart(const TriangleMesh& whole, const std::vector<std::uint8_t>& isWholeKept, double reach)
        : whole_(whole), isNear_(isWholeKept.size()) {
        spanCubes(reach);
        std::vector<bool> isMarked(static_cast<std::size_t>(count_[0] * count_[1] * count_[2]));
        const auto extentOf = [&](std::size_t t) {
            const auto& [a, b, c] = whole.triangles[t];
            return boxOf({whole.points[a], whole.points[b], whole.points[c]});
        };
        for (std::size_t t = 0; t < isWholeKept.size(); ++t) {
            if (isWholeKept[t] != 0) continue;
            BoundingBox extent = extentOf(t);
            extent.widen(reach);
            anyCube(extent, [&](std::size_t cube) {
                isMarked[cube] = true;
                return false;
            });
        }
        mesh.points = whole.points;
        mesh.normals = whole.normals;
        for (std::size_t t = 0; t < isWholeKept.size(); ++t) {
            const bool isNear =
                anyCube(extentOf(t), [&](std::size_t cube) { return isMarked[cube]; });
            isNear_[t] = static_cast<std::uint8_t>(isNear);
            if (!isNear) continue;
            mesh.triangles.push_back(whole.triangles[t]);
            isKept.push_back(isWholeKept[t]);
        }
        mesh = withoutUnusedPoints(std::move(mesh));
    }

    /// Joins the part and the triangles that were left out, by the bits of their points.
    SimplifiedPart withRest(const SimplifiedPart& part) const {
        SimplifiedPart all;
        all.errorBoundMm = part.errorBoundMm;
        std::unordered_map<Vec3, VertexId, HashOfPoint> known;
        const auto numberIn = [&](const TriangleMesh& from, VertexId v) {
            const auto [at, isNew] = known.try_emplace(from.points[v], std::ssize(all.mesh.points));
            if (isNew) {
                all.mesh.points.push_back(from.points[v]);
                if (!from.normals.empty()) all.mesh.normals.push_back(from.normals[v]);
            }
            return at->second;
        };
        const auto add = [&](const TriangleMesh& from, const Triangle& t, std::uint8_t wasKept) {
            all.mesh.triangles.push_back(
                {numberIn(from, t[0]), numberIn(from, t[1]), numberIn(from, t[2])});
            all.isKept.push_back(wasKept);
        };
        for (std::size_t t = 0; t < part.mesh.triangles.size(); ++t) {
            add(part.mesh, part.mesh.triangles[t], part.isKept[t]);
        }
        for (std::size_t t = 0; t < isNear_.size(); ++t) {
            if (isNear_[t] == 0) add(whole_, whole_.triangles[t], 1);
        }
        return all;
    }

    TriangleMesh mesh;
    std::vector<std::uint8_t> isKept;

private:
    void spanCubes(double reach) {
        BoundingBox box{whole_.points[0], whole_.points[0]};
        for (const Vec3& p : whole_.points) box.add(p);
        box.widen(reach);
        low_ = box.minimum;
        constexpr double kLeast = 2, kMostAlong = 256;  // cells, cubes
        const Vec3 size = box.size();
        side_ = std::max(kLeast, std::max({size.x, size.y, size.z}) / kMostAlong);
        for (int a = 0; a < 3; ++a) count_[a] = cubeAt(box.maximum, a) + 1;
    }
    std::int64_t cubeAt(const Vec3& index, int axis) const {
        return static_cast<std::int64_t>((index[axis] - low_[axis]) / side_);
    }
    /// \return f(cube) is true of one of the cubes that an extent lies in
    template <class F>
    bool anyCube(const BoundingBox& extent, const F& f) const {
        for (std::int64_t z = cubeAt(extent.minimum, 2); z <= cubeAt(extent.maximum, 2); ++z) {
            for (std::int64_t y = cubeAt(extent.minimum, 1); y <= cubeAt(extent.maximum, 1); ++y) {
                for (std::int64_t x = cubeAt(extent.minimum, 0); x <= cubeAt(extent.maximum, 0);
                     ++x) {
                    if (f(static_cast<std::size_t>(x + count_[0] * (y + count_[1] * z)))) {
                        return true;
                    }
                }
            }
        }
        return false;
    }

    const TriangleMesh& whole_;
    std::vector<std::uint8_t> isNear_;
    Vec3 low_;
    double side_ = 0;
    Index3 count_{};
};

class PartSimplifier {
public:
    PartSimplifier(const TriangleMesh& mesh, std::vector<std::uint8_t> isKept,
                   const ImageGeometry& geometry, const BoundingBox& box)
        : mesh_(mesh), isKept_(std::move(isKept)), frame_(geometry), box_(box) {
        within_ = boxWithin(box, geometry);
        if (isKept_.empty()) keepBorder();
        metric_.triangles = mesh.triangles;
        metric_.normals = mesh.normals;
        metric_.points.reserve(mesh.points.size());
        for (const Vec3& p : mesh.points) metric_.points.push_back(frame_.fromIndex(p));
    }

    SimplifiedPart run(double maxErrorMm) {
        std::optional<KeepingSimplified> made =
            simplifyKeeping(metric_, isKept_, maxErrorMm, &within_);
        if (made) {
            SimplifiedPart part = inIndices(*made);
            if (liesInBox(*made, part)) {
                part.isKept = std::move(made->isKept);
                return part;
            }
        }
        return {mesh_, isKept_, 0, true};
    }

private:
    void keepBorder() {
        std::vector<std::uint8_t> isBorder(mesh_.points.size());
        for (const VertexId v : borderOf(mesh_).vertices) isBorder[v] = 1;
        isKept_.reserve(mesh_.triangles.size());
        for (const auto& [a, b, c] : mesh_.triangles) {
            isKept_.push_back(isBorder[a] | isBorder[b] | isBorder[c]);
        }
    }

    /// Points that are those of the input become those to the bit.
    SimplifiedPart inIndices(const KeepingSimplified& made) const {
        SimplifiedPart part;
        part.errorBoundMm = made.errorBoundMm;
        part.mesh.triangles = made.mesh.triangles;
        for (std::size_t v = 0; v < made.mesh.points.size(); ++v) {
            const std::int64_t known = made.inputPoint[v];
            const bool isNew = known == KeepingSimplified::kNew;
            part.mesh.points.push_back(isNew ? frame_.toIndex(made.mesh.points[v])
                                             : mesh_.points[known]);
            if (mesh_.normals.empty()) continue;
            part.mesh.normals.push_back(isNew ? made.mesh.normals[v] : mesh_.normals[known]);
        }
        return part;
    }

    /// All new points do.
    bool liesInBox(const KeepingSimplified& made, const SimplifiedPart& part) const {
        for (std::size_t v = 0; v < part.mesh.points.size(); ++v) {
            if (made.inputPoint[v] != KeepingSimplified::kNew) continue;
            const Vec3& p = part.mesh.points[v];
            for (int a = 0; a < 3; ++a) {
                if (!(p[a] > box_.minimum[a] && p[a] < box_.maximum[a])) return false;
            }
        }
        return true;
    }

    const TriangleMesh& mesh_;
    std::vector<std::uint8_t> isKept_;
    MetricFrame frame_;
    BoundingBox box_;
    BoundingBox within_;
    TriangleMesh metric_;
};

}  // namespace

BorderEdges borderOf(const TriangleMesh& mesh) {
    std::vector<std::array<std::uint64_t, 3>> triangles;
    triangles.reserve(mesh.triangles.size());
    for (const auto& [a, b, c] : mesh.triangles) {
        triangles.push_back({static_cast<std::uint64_t>(a), static_cast<std::uint64_t>(b),
                             static_cast<std::uint64_t>(c)});
    }
    HalfEdges<std::uint64_t> halfEdges;
    halfEdges.assign(mesh.points.size(), triangles);
    std::vector<std::uint64_t> twin;
    halfEdges.match(twin);
    BorderEdges border;
    for (std::size_t h = 0; h < twin.size(); ++h) {
        if (twin[h] != HalfEdges<std::uint64_t>::kNone) continue;
        const Triangle& t = mesh.triangles[h / 3];
        border.edges.push_back({t[h % 3], t[(h + 1) % 3]});
        border.vertices.push_back(t[h % 3]);
        border.vertices.push_back(t[(h + 1) % 3]);
    }
    std::sort(border.vertices.begin(), border.vertices.end());
    border.vertices.erase(std::unique(border.vertices.begin(), border.vertices.end()),
                          border.vertices.end());
    return border;
}

SimplifiedPart simplifyInBox(const TriangleMesh& mesh, std::vector<std::uint8_t> isKept,
                             const ImageGeometry& geometry, const BoundingBox& box,
                             double maxErrorMm) {
    if (!canSimplifyInBoxes(geometry)) {
        throw InvalidInput("simplifyInBox: the volume's axes are not at right angles");
    }
    if (mesh.triangles.empty()) return {};
    if (isKept.empty()) return PartSimplifier(mesh, {}, geometry, box).run(maxErrorMm);
    // what is new lies within the bound of what was there: it can't cross what is farther away
    constexpr double kBeyond = 0.5;
    const NearPart near(mesh, isKept, maxErrorMm / narrowestSpacingMm(geometry) + kBeyond);
    const SimplifiedPart part =
        PartSimplifier(near.mesh, near.isKept, geometry, box).run(maxErrorMm);
    if (part.isUnchanged) return {mesh, std::move(isKept), 0, true};
    return near.withRest(part);
}

bool canSimplifyInBoxes(const ImageGeometry& geometry) {
    constexpr double kMost = 1;  // cells
    const Vec3 slant = slantMm(geometry), spacing = geometry.spacingMm();
    return slant.x <= kMost * spacing.x && slant.y <= kMost * spacing.y &&
           slant.z <= kMost * spacing.z;
}

double narrowestSpacingMm(const ImageGeometry& geometry) {
    return MetricFrame(geometry).narrowestMm();
}

}  // namespace adaptiso
