#include "CrossingGuard.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace adaptiso::detail {
namespace {

/// Side of the cubes in which samples are looked up, and how far around a star, in voxels.
constexpr double kCube = 1, kReach = 0.5;

/// Room that proofs leave, as a part of the distance between sample planes.
constexpr double kGap = 1e-4;

std::int64_t cubeOf(double index) {
    return static_cast<std::int64_t>(std::floor(index / kCube));
}

}  // namespace

CrossingGuard::CrossingGuard(const Patch& patch, const PatchTopology& topology,
                             const MetricFrame& frame, bool looksEverywhere)
    : patch_(patch),
      topology_(topology),
      frame_(frame),
      looksEverywhere_(looksEverywhere),
      gapMm_(kGap * frame.narrowestMm()) {}

void CrossingGuard::buildGrid() {
    stamp_.assign(patch_.triangles.size(), 0);
    std::vector<std::uint32_t> members;
    std::vector<Index3> cubes;
    Index3 high{};
    for (std::uint32_t s = 0; s < patch_.samples.size(); ++s) {
        if (patch_.samples[s].isAlone() && !looksEverywhere_) continue;
        const Vec3 index = frame_.toIndex(patch_.samples[s].point());
        const Index3 cube{cubeOf(index.x), cubeOf(index.y), cubeOf(index.z)};
        for (int a = 0; a < 3; ++a) {
            grid_.low[a] = members.empty() ? cube[a] : std::min(grid_.low[a], cube[a]);
            high[a] = members.empty() ? cube[a] : std::max(high[a], cube[a]);
        }
        members.push_back(s);
        cubes.push_back(cube);
    }
    if (members.empty()) {
        grid_.begin.assign(2, 0);
        return;
    }
    for (int a = 0; a < 3; ++a) grid_.count[a] = high[a] - grid_.low[a] + 1;
    const auto number = [&](const Index3& c) {
        return static_cast<std::size_t>(
            c[0] - grid_.low[0] +
            grid_.count[0] * (c[1] - grid_.low[1] + grid_.count[1] * (c[2] - grid_.low[2])));
    };
    grid_.begin.assign(
        static_cast<std::size_t>(grid_.count[0] * grid_.count[1] * grid_.count[2]) + 1, 0);
    for (const Index3& cube : cubes) ++grid_.begin[number(cube) + 1];
    for (std::size_t i = 1; i < grid_.begin.size(); ++i) grid_.begin[i] += grid_.begin[i - 1];
    std::vector<std::uint32_t> at(grid_.begin.begin(), grid_.begin.end() - 1);
    grid_.samples.resize(members.size());
    for (std::size_t i = 0; i < members.size(); ++i) {
        grid_.samples[at[number(cubes[i])]++] = members[i];
    }
}

Corners CrossingGuard::cornersOf(std::uint32_t triangle) const {
    const auto& t = patch_.triangles[triangle];
    return {patch_.points[t[0]], patch_.points[t[1]], patch_.points[t[2]]};
}

CrossingGuard::Box CrossingGuard::rounded(const CornerBox& box) {
    constexpr float kMore = 2 * std::numeric_limits<float>::epsilon(),
                    kLeast = std::numeric_limits<float>::min();
    Box result;
    for (int a = 0; a < 3; ++a) {
        const auto low = static_cast<float>(box.low[a]), high = static_cast<float>(box.high[a]);
        result.low[a] = low - (kMore * std::abs(low) + kLeast);
        result.high[a] = high + (kMore * std::abs(high) + kLeast);
    }
    return result;
}

void CrossingGuard::commit(const ChangedStar& changed) {
    if (hasBox_.empty()) return;
    for (int i = 0; i < changed.star.count; ++i) hasBox_[changed.star.triangle[i]] = 0;
}

/// Few triangles are ever asked for.
const CrossingGuard::Box& CrossingGuard::boxAt(std::uint32_t triangle) {
    if (hasBox_[triangle] == 0) {
        box_[triangle] = rounded(boxOf(cornersOf(triangle)));
        hasBox_[triangle] = 1;
    }
    return box_[triangle];
}

bool CrossingGuard::crossesNothing(const ChangedStar& changed) {
    if (!changed.isGraph && !wedgesAreClear(changed)) return false;
    collectNear(changed);
    const int n = changed.star.count;
    for (const std::uint32_t other : near_) {
        const Box& box = box_[other];
        std::array<std::uint8_t, Star::kMost> overlaps;
        for (int i = 0; i < n; ++i) {
            overlaps[i] = static_cast<std::uint8_t>(
                (wedgeLow_[0][i] <= box.high[0]) & (box.low[0] <= wedgeHigh_[0][i]) &
                (wedgeLow_[1][i] <= box.high[1]) & (box.low[1] <= wedgeHigh_[1][i]) &
                (wedgeLow_[2][i] <= box.high[2]) & (box.low[2] <= wedgeHigh_[2][i]));
        }
        for (int i = 0; i < n; ++i) {
            if (overlaps[i] != 0 && !isClear(changed, i, other)) return false;
        }
    }
    return true;
}

/// The triangles around a vertex of the ring share no more than it and their edges: seen along one
/// direction all are upright and go round the vertex once.
/// \pre the star's old triangles carry the stamp, and no others
bool CrossingGuard::fanIsClear(const ChangedStar& changed, int at) const {
    constexpr int kMost = 24;
    constexpr double kLeastCosine = 0.02;
    const Star& star = changed.star;
    const std::uint32_t r = star.ring[at];
    if (!topology_.isMovable(r)) return false;
    const Vec3 centre = patch_.points[r];
    struct Sector {
        Vec3 from, to, area2;
    };
    std::array<Sector, kMost> sectors;
    int count = 0;
    Vec3 axis;
    const auto add = [&](const Vec3& from, const Vec3& to) {
        const Vec3 area2 = cross(from, to);
        sectors[count++] = {from, to, area2};
        axis += area2;
    };
    const int before = (at + star.count - 1) % star.count, after = (at + 1) % star.count;
    const Vec3 toVertex = changed.vertex - centre;
    add(patch_.points[star.ring[after]] - centre, toVertex);
    add(toVertex, patch_.points[star.ring[before]] - centre);
    const std::uint32_t begin = topology_.leaving(r);
    std::uint32_t h = begin;
    do {
        const std::uint32_t inwards = PatchTopology::previous(h);
        if (stamp_[h / 3] != now_) {
            if (count == kMost) return false;
            add(patch_.points[topology_.to(h)] - centre,
                patch_.points[topology_.from(inwards)] - centre);
        }
        h = topology_.twin(inwards);
    } while (h != begin);
    const double least = kLeastCosine * norm(axis);
    for (int i = 0; i < count; ++i) {
        const Sector& s = sectors[i];
        const double upright = dot(s.area2, axis);
        if (!(upright > 0 && upright * upright > least * least * squaredNorm(s.area2))) {
            return false;
        }
        // a second way round would pass the spoke again
        if (i >= 2 && dot(cross(s.from, toVertex), axis) >= 0 &&
            dot(cross(toVertex, s.to), axis) >= 0) {
            return false;
        }
    }
    return true;
}

/// The star's triangles among themselves.
bool CrossingGuard::wedgesAreClear(const ChangedStar& changed) const {
    const Star& star = changed.star;
    const int n = star.count;
    const Vec3& p = changed.vertex;
    const auto ring = [&](int i) { return patch_.points[star.ring[i % n]]; };
    for (int i = 0; i < n; ++i) {
        for (int j = i + 1; j < n; ++j) {
            bool isClear = false;
            if (j == i + 1) {
                isClear = touchAtEdgeOnly({ring(j), p, ring(i)}, {p, ring(j), ring(j + 1)});
            } else if (i == 0 && j == n - 1) {
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
    const std::uint32_t r = star.ring[wedge], s = star.ring[(wedge + 1) % star.count];
    const Vec3 &p = changed.vertex, &pr = patch_.points[r], &ps = patch_.points[s];
    const auto& o = patch_.triangles[other];
    const auto corner = [&](int c) { return patch_.points[o[c % 3]]; };
    int atR = -1, atS = -1;
    for (int c = 0; c < 3; ++c) {
        if (o[c] == r) atR = c;
        if (o[c] == s) atS = c;
    }
    const bool isInFan =
        (atR >= 0 && fanIsClear_[wedge]) || (atS >= 0 && fanIsClear_[(wedge + 1) % star.count]);
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
    if (grid_.begin.empty()) {
        buildGrid();
        box_.resize(patch_.triangles.size());
        hasBox_.assign(patch_.triangles.size(), 0);
    }
    const Star& star = changed.star;
    ++now_;
    near_.clear();
    CornerBox whole{changed.vertex, changed.vertex};
    for (int i = 0; i < star.count; ++i) {
        const Vec3 &r = patch_.points[star.ring[i]],
                   &s = patch_.points[star.ring[(i + 1) % star.count]];
        CornerBox wedge = boxOf({changed.vertex, r, s});
        wedge.widen(gapMm_);
        const Box box = rounded(wedge);
        for (int a = 0; a < 3; ++a) {
            wedgeLow_[a][i] = box.low[a];
            wedgeHigh_[a][i] = box.high[a];
        }
        whole.add(r);
        stamp_[star.triangle[i]] = now_;
    }
    for (int i = 0; i < star.removedCount; ++i) stamp_[star.removed[i]] = now_;
    whole.widen(gapMm_);
    starBox_ = rounded(whole);
    for (int i = 0; i < star.count; ++i) fanIsClear_[i] = fanIsClear(changed, i);
    collectAroundRing(star);
    collectFromGrid(changed);
}

void CrossingGuard::collectAroundRing(const Star& star) {
    for (int i = 0; i < star.count; ++i) {
        if (!topology_.isMovable(star.ring[i])) continue;  // its triangles are in the grid's hands
        const std::uint32_t begin = topology_.leaving(star.ring[i]);
        std::uint32_t h = begin;
        do {
            addNear(h / 3);
            h = topology_.twin(PatchTopology::previous(h));
        } while (h != begin);
    }
}

void CrossingGuard::collectFromGrid(const ChangedStar& changed) {
    const Star& star = changed.star;
    Vec3 low = frame_.toIndex(changed.vertex), high = low;
    for (int i = 0; i < star.count; ++i) {
        const Vec3 index = frame_.toIndex(patch_.points[star.ring[i]]);
        for (int a = 0; a < 3; ++a) {
            low[a] = std::min(low[a], index[a]);
            high[a] = std::max(high[a], index[a]);
        }
    }
    Index3 first, last;
    for (int a = 0; a < 3; ++a) {
        first[a] = std::max<std::int64_t>(0, cubeOf(low[a] - kReach) - grid_.low[a]);
        last[a] = std::min(grid_.count[a] - 1, cubeOf(high[a] + kReach) - grid_.low[a]);
    }
    for (std::int64_t z = first[2]; z <= last[2]; ++z) {
        for (std::int64_t y = first[1]; y <= last[1]; ++y) {
            const std::size_t row =
                static_cast<std::size_t>(grid_.count[0] * (y + grid_.count[1] * z));
            if (first[0] > last[0]) continue;
            const std::uint32_t begin = grid_.begin[row + first[0]],
                                end = grid_.begin[row + last[0] + 1];
            for (std::uint32_t i = begin; i < end; ++i) {
                addNear(patch_.sampleTriangle[grid_.samples[i]]);
            }
        }
    }
}

void CrossingGuard::addNear(std::uint32_t triangle) {
    if (stamp_[triangle] == now_) return;
    stamp_[triangle] = now_;
    if (boxAt(triangle).overlaps(starBox_)) near_.push_back(triangle);
}

}  // namespace adaptiso::detail
