#include "adaptive/collapse/CrossingGuard.h"

#include <algorithm>
#include <optional>

#include "adaptiso/Core/Buckets.h"
#include "adaptiso/Core/Geometry.h"
#include "adaptiso/MeshQuality/Certificate.h"
#include "adaptiso/MeshQuality/CrossingSearch.h"
#include "adaptive/Parameters.h"

namespace adaptiso::detail {
namespace {

constexpr std::uint32_t kNoEntries = 0xFFFFFFFF;

/// The tetrahedron has a volume, and the point lies in it or on it.
bool holds(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, const Vec3& p) {
    const int side = orient3d(a, b, c, d);
    return side != 0 && side * orient3d(a, b, c, p) >= 0 && side * orient3d(a, b, p, d) >= 0 &&
           side * orient3d(a, p, c, d) >= 0 && side * orient3d(p, b, c, d) >= 0;
}

}  // namespace

CrossingGuard::CrossingGuard(const Patch& patch, const PatchTopology& topology,
                             const MetricFrame& frame, bool looksEverywhere)
    : patch_(patch),
      topology_(topology),
      looksEverywhere_(looksEverywhere),
      gapMm_(kProofGap * frame.narrowestMm()),
      cubeMm_(kNearCube * frame.voxelMm()) {}

/// Those whose samples know of no other sheet near them; of those without samples, those between
/// three such ones.
std::vector<std::uint8_t> CrossingGuard::trianglesInSingleSheets() const {
    enum class Sheet : std::uint8_t { Unknown, Single, Other };
    std::vector<Sheet> sheet(patch_.triangles.size(), Sheet::Unknown);
    for (std::size_t s = 0; s < patch_.samples.size(); ++s) {
        Sheet& known = sheet[patch_.sampleTriangle[s]];
        if (!patch_.samples[s].isAlone()) {
            known = Sheet::Other;
        } else if (known == Sheet::Unknown) {
            known = Sheet::Single;
        }
    }
    std::vector<std::uint8_t> isSingle(sheet.size());
    for (std::uint32_t t = 0; t < sheet.size(); ++t) {
        isSingle[t] = static_cast<std::uint8_t>(sheet[t] == Sheet::Single);
        if (sheet[t] != Sheet::Unknown || t >= patch_.ownTriangles) continue;
        bool isBetween = true;
        for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
            const std::uint32_t twin = topology_.twin(h);
            isBetween =
                isBetween && twin != PatchTopology::kNone && sheet[twin / 3] == Sheet::Single;
        }
        isSingle[t] = static_cast<std::uint8_t>(isBetween);
    }
    return isSingle;
}

void CrossingGuard::buildGrid() {
    known_.resize(patch_.triangles.size());
    entered_.resize(patch_.triangles.size());
    entries_.reserve(patch_.triangles.size() / 2);  // a triangle is in three cubes in the mean
    // no star reaches beyond the patch's own triangles; what lies outside is in the outermost cubes
    std::optional<BoundingBox> own;
    double sides = 0, triangles = 0;
    for (std::uint32_t t = 0; t < patch_.ownTriangles; ++t) {
        if (patch_.triangles[t][0] == Patch::kGone) continue;
        const BoundingBox box = boxOf(cornersOf(t));
        if (!own) own = box;
        own->add(box);
        const Vec3 size = box.size();
        sides += std::max({size.x, size.y, size.z});
        ++triangles;
    }
    cubeMm_ = std::max(cubeMm_, kNearSides * sides / std::max(1.0, triangles));
    const BoundingBox all = own.value_or(BoundingBox{});
    low_ = all.minimum;
    const Vec3 extent = all.size();
    std::size_t cubes = 1;
    for (int a = 0; a < 3; ++a) {
        count_[a] = 1 + static_cast<std::int32_t>(extent[a] / cubeMm_);
        cubes *= static_cast<std::size_t>(count_[a]);
    }
    entriesAt_.assign(cubes, kNoEntries);
    const std::vector<std::uint8_t> isSingle =
        looksEverywhere_ ? std::vector<std::uint8_t>(patch_.triangles.size(), 0)
                         : trianglesInSingleSheets();
    for (std::uint32_t t = 0; t < patch_.triangles.size(); ++t) {
        if (patch_.triangles[t][0] == Patch::kGone) continue;
        if (isSingle[t] == 0) enter(t);
    }
    markPieces();
}

/// Where all vertices hang together there is nothing to mark.
void CrossingGuard::markPieces() {
    DisjointSets sets(std::ssize(patch_.points));
    for (const auto& t : patch_.triangles) {
        if (t[0] == Patch::kGone) continue;
        sets.join(t[0], t[1]);
        sets.join(t[0], t[2]);
    }
    std::vector<std::uint32_t> numbers(patch_.points.size(), kNoEntries);
    for (const auto& t : patch_.triangles) {
        if (t[0] == Patch::kGone) continue;
        std::uint32_t& number = numbers[sets.find(t[0])];
        if (number != kNoEntries) continue;
        number = static_cast<std::uint32_t>(marks_.size());
        marks_.push_back(t[0]);
    }
    if (marks_.size() < 2) return;
    pieceOf_.resize(patch_.points.size());
    for (std::size_t v = 0; v < pieceOf_.size(); ++v) {
        pieceOf_[v] = numbers[sets.find(static_cast<std::int64_t>(v))];
    }
    marksAt_.resize(entriesAt_.size());
    for (std::uint32_t piece = 0; piece < marks_.size(); ++piece) enterMark(piece);
}

void CrossingGuard::enterMark(std::uint32_t piece) {
    const Vec3& p = patch_.points[marks_[piece]];
    const Cubes at = cubesOf(rounded({p, p}));
    forEachRow(at, [&](std::size_t row, std::int32_t, std::int32_t) {
        marksAt_[row + static_cast<std::size_t>(at.first[0])].push_back(piece);
    });
}

/// A mark that the change moves goes to the ring, which stays.
void CrossingGuard::moveMark(const Star& star) {
    if (pieceOf_.empty()) return;
    const std::uint32_t piece = pieceOf_[star.ring[0]];
    const auto end = star.apex.begin() + star.count;
    if (!star.isOpen && std::find(star.apex.begin(), end, marks_[piece]) == end) return;
    marks_[piece] = star.ring[0];
    enterMark(piece);
}

CrossingGuard::Cubes CrossingGuard::cubesOf(const Box& box) const {
    Cubes cubes{};
    for (int a = 0; a < 3; ++a) {
        const auto at = [&](float position) {
            const double cube = (position - low_[a]) / cubeMm_;
            return static_cast<std::int32_t>(
                std::clamp(cube, 0.0, static_cast<double>(count_[a] - 1)));
        };
        cubes.first[a] = at(box.low[a]);
        cubes.last[a] = at(box.high[a]);
    }
    return cubes;
}

/// Calls f(number of the cube at x = 0, y, z) for the rows along x.
template <class F>
void CrossingGuard::forEachRow(const Cubes& cubes, const F& f) const {
    for (std::int32_t z = cubes.first[2]; z <= cubes.last[2]; ++z) {
        for (std::int32_t y = cubes.first[1]; y <= cubes.last[1]; ++y) {
            f(static_cast<std::size_t>(count_[0]) *
                  static_cast<std::size_t>(y + static_cast<std::int64_t>(count_[1]) * z),
              y, z);
        }
    }
}

/// Lists a triangle in the cubes that do not have it since it was last entered.
void CrossingGuard::enter(std::uint32_t triangle) {
    const Cubes cubes = cubesOf(boxAt(triangle)), before = entered_[triangle];
    entered_[triangle] = cubes;
    forEachRow(cubes, [&](std::size_t row, std::int32_t y, std::int32_t z) {
        const bool hadRow = before.hasRow(y, z);
        for (std::int32_t x = cubes.first[0]; x <= cubes.last[0]; ++x) {
            if (hadRow && before.first[0] <= x && x <= before.last[0]) continue;
            std::uint32_t& at = entriesAt_[row + x];
            if (at == kNoEntries || entries_[at].count == Entries::kMost) {
                entries_.push_back({at, 0, {}});
                at = static_cast<std::uint32_t>(entries_.size() - 1);
            }
            entries_[at].triangle[entries_[at].count++] = triangle;
        }
    });
}

const CrossingGuard::Box& CrossingGuard::boxAt(std::uint32_t triangle) {
    Known& known = known_[triangle];
    if (!known.hasBox) {
        known.box = rounded(boxOf(cornersOf(triangle)));
        known.hasBox = true;
    }
    return known.box;
}

CrossingGuard::Box CrossingGuard::rounded(const BoundingBox& box) {
    Box result;
    for (int a = 0; a < 3; ++a) {
        result.low[a] = floatBelow(box.minimum[a]);
        result.high[a] = floatAbove(box.maximum[a]);
    }
    return result;
}

void CrossingGuard::commit(const ChangedStar& changed, bool isSingleSheet) {
    if (known_.empty()) return;
    const Star& star = changed.star;
    moveMark(star);
    for (int i = 0; i < star.count; ++i) {
        const std::uint32_t t = star.triangle[i];
        known_[t].hasBox = false;
        if (isSingleSheet && !looksEverywhere_) continue;
        known_[t].box = rounded(
            boxOf({changed.vertex, patch_.points[star.ring[i]], patch_.points[star.ring[i + 1]]}));
        known_[t].hasBox = true;
        enter(t);
    }
    for (int i = 0; i < star.removedCount; ++i) known_[star.removed[i]].isGone = true;
}

bool CrossingGuard::crossesNothing(const ChangedStar& changed) {
    if (!changed.isGraph && !wedgesAreClear(changed)) return false;
    if (known_.empty()) buildGrid();
    collectNear(changed);
    const int n = changed.star.count;
    for (const std::uint32_t other : near_) {
        const Box& box = known_[other].box;
        std::array<std::uint8_t, Star::kMost> overlaps;
        for (int i = 0; i < n; ++i) {
            overlaps[i] = static_cast<std::uint8_t>(
                int{wedgeLow_[0][i] <= box.high[0]} &  // int: Clang warns of & between bools
                (box.low[0] <= wedgeHigh_[0][i]) & (wedgeLow_[1][i] <= box.high[1]) &
                (box.low[1] <= wedgeHigh_[1][i]) & (wedgeLow_[2][i] <= box.high[2]) &
                (box.low[2] <= wedgeHigh_[2][i]));
        }
        for (int i = 0; i < n; ++i) {
            if (overlaps[i] != 0 && !isClear(changed, i, other)) return false;
        }
    }
    return !sweepsOver(changed);
}

bool CrossingGuard::sweepsOver(const ChangedStar& changed) const {
    if (pieceOf_.empty()) return false;
    const Star& star = changed.star;
    BoundingBox swept{changed.vertex, changed.vertex};
    for (int i = 0; i < star.ringCount(); ++i) swept.add(patch_.points[star.ring[i]]);
    for (int i = 0; i < star.count; ++i) swept.add(patch_.points[star.apex[i]]);
    for (int i = 0; i < star.removedCount; ++i) swept.add(boxOf(cornersOf(star.removed[i])));
    const auto isSwept = [&](const Vec3& p) {
        if (!swept.contains(p)) return false;
        const auto isBehind = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
            return holds(a, b, c, changed.vertex, p);
        };
        for (int i = 0; i < star.count; ++i) {
            if (isBehind(patch_.points[star.apex[i]], patch_.points[star.ring[i]],
                         patch_.points[star.ring[i + 1]])) {
                return true;
            }
        }
        return std::any_of(star.removed.begin(), star.removed.begin() + star.removedCount,
                           [&](std::uint32_t t) {
                               const Corners old = cornersOf(t);
                               return isBehind(old[0], old[1], old[2]);
                           });
    };
    const std::uint32_t own = pieceOf_[star.ring[0]];
    const Cubes cubes = cubesOf(rounded(swept));
    bool found = false;
    forEachRow(cubes, [&](std::size_t row, std::int32_t, std::int32_t) {
        for (std::int32_t x = cubes.first[0]; x <= cubes.last[0]; ++x) {
            for (const std::uint32_t piece : marksAt_[row + x]) {
                found = found || (piece != own && isSwept(patch_.points[marks_[piece]]));
            }
        }
    });
    return found;
}

/// Some triangle across an edge of the ring faces away from the star.
bool CrossingGuard::foldsBack(const ChangedStar& changed) const {
    const Star& star = changed.star;
    for (int i = 0; i < star.count; ++i) {
        const std::uint32_t twin =
            topology_.twin(topology_.leavingIn(star.triangle[i], star.ring[i]));
        if (twin == PatchTopology::kNone) continue;
        const Corners beside = cornersOf(twin / 3);
        const Vec3 area2 = areaVector2(beside[0], beside[1], beside[2]);
        if (dot(area2, changed.normal) < 0) return true;
    }
    return false;
}

/// The triangles around a vertex of the ring share no more than it and their edges.
bool CrossingGuard::fanIsClear(const ChangedStar& changed, int at) const {
    const Star& star = changed.star;
    const std::uint32_t r = star.ring[at];
    if (star.isOpen || !topology_.isMovable(r) || topology_.isOnBorder(r)) return false;
    const Vec3 centre = patch_.points[r];
    std::array<Vec3, kMostOfFan> spokes{changed.vertex - centre};
    std::size_t count = 1;
    // round from the star to the star
    const auto next = [&](std::uint32_t h) { return topology_.twin(PatchTopology::previous(h)); };
    const int before = (at + star.count - 1) % star.count;
    for (std::uint32_t h = next(topology_.leavingIn(star.triangle[before], r));; h = next(h)) {
        if (count == kMostOfFan) return false;
        spokes[count++] = patch_.points[topology_.to(h)] - centre;
        if (h / 3 == star.triangle[at]) return goesRoundOnce({spokes.data(), count});
    }
}

/// The star's triangles among themselves.
bool CrossingGuard::wedgesAreClear(const ChangedStar& changed) const {
    const Star& star = changed.star;
    const int n = star.count;
    const Vec3& p = changed.vertex;
    const auto ring = [&](int i) { return patch_.points[star.ring[i]]; };
    for (int i = 0; i < n; ++i) {
        for (int j = i + 1; j < n; ++j) {
            bool isClear = false;
            if (j == i + 1) {
                isClear = touchAtEdgeOnly({ring(j), p, ring(i)}, {p, ring(j), ring(j + 1)});
            } else if (i == 0 && j == n - 1 && !star.isOpen) {
                isClear = touchAtEdgeOnly({p, ring(0), ring(1)}, {ring(0), p, ring(j)});
            } else {
                isClear =
                    touchAtVertexOnly({p, ring(i), ring(i + 1)}, {p, ring(j), ring(j + 1)}, gapMm_);
            }
            if (!isClear) return false;
        }
    }
    return true;
}

bool CrossingGuard::isClear(const ChangedStar& changed, int wedge, std::uint32_t other) const {
    const Star& star = changed.star;
    const std::uint32_t r = star.ring[wedge], s = star.ring[wedge + 1];
    const Vec3 &p = changed.vertex, &pr = patch_.points[r], &ps = patch_.points[s];
    const auto& o = patch_.triangles[other];
    const auto corner = [&](int c) { return patch_.points[o[c % 3]]; };
    int atR = -1, atS = -1;
    for (int c = 0; c < 3; ++c) {
        if (o[c] == r) atR = c;
        if (o[c] == s) atS = c;
    }
    const bool isInFan = (atR >= 0 && fanIsClear_[wedge]) || (atS >= 0 && fanIsClear_[wedge + 1]);
    if (isInFan) return true;
    if (atR >= 0 && atS >= 0) {
        return touchAtEdgeOnly({pr, ps, p}, {ps, pr, corner(3 - atR - atS)});
    }
    if (atR >= 0) {
        return touchAtVertexOnly({pr, ps, p}, {pr, corner(atR + 1), corner(atR + 2)}, gapMm_);
    }
    if (atS >= 0) {
        return touchAtVertexOnly({ps, p, pr}, {ps, corner(atS + 1), corner(atS + 2)}, gapMm_);
    }
    return areApart({p, pr, ps}, cornersOf(other), gapMm_);
}

void CrossingGuard::collectNear(const ChangedStar& changed) {
    const Star& star = changed.star;
    ++now_;
    near_.clear();
    BoundingBox whole{changed.vertex, changed.vertex};
    for (int i = 0; i < star.count; ++i) {
        const Vec3 &r = patch_.points[star.ring[i]], &s = patch_.points[star.ring[i + 1]];
        BoundingBox wedge = boxOf({changed.vertex, r, s});
        wedge.widen(gapMm_);
        const Box box = rounded(wedge);
        for (int a = 0; a < 3; ++a) {
            wedgeLow_[a][i] = box.low[a];
            wedgeHigh_[a][i] = box.high[a];
        }
        whole.add(r);
        known_[star.triangle[i]].stamp = now_;
    }
    whole.add(patch_.points[star.ring[star.count]]);
    for (int i = 0; i < star.removedCount; ++i) known_[star.removed[i]].stamp = now_;
    whole.widen(gapMm_);
    starBox_ = rounded(whole);
    for (int i = 0; i < star.count; ++i) fanIsClear_[i] = fanIsClear(changed, i);
    fanIsClear_[star.count] = !star.isOpen && fanIsClear_[0];
    collectAroundRing(star);
    collectFromGrid();
}

void CrossingGuard::collectAroundRing(const Star& star) {
    for (int i = 0; i < star.ringCount(); ++i) {
        if (!topology_.isMovable(star.ring[i])) continue;  // its triangles are in the grid's hands
        topology_.forEachLeaving(star.ring[i], [&](std::uint32_t h) { addNear(h / 3); });
    }
}

void CrossingGuard::collectFromGrid() {
    const Cubes cubes = cubesOf(starBox_);
    forEachRow(cubes, [&](std::size_t row, std::int32_t, std::int32_t) {
        for (std::int32_t x = cubes.first[0]; x <= cubes.last[0]; ++x) {
            for (std::uint32_t at = entriesAt_[row + x]; at != kNoEntries; at = entries_[at].next) {
                Entries& some = entries_[at];
                for (std::uint32_t e = 0; e < some.count;) {
                    if (known_[some.triangle[e]].isGone) {
                        some.triangle[e] = some.triangle[--some.count];
                    } else {
                        addNear(some.triangle[e++]);
                    }
                }
            }
        }
    });
}

void CrossingGuard::addNear(std::uint32_t triangle) {
    if (known_[triangle].stamp == now_) return;
    known_[triangle].stamp = now_;
    if (boxAt(triangle).overlaps(starBox_)) near_.push_back(triangle);
}

}  // namespace adaptiso::detail
