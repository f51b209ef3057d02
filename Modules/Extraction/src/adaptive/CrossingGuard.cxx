#include "CrossingGuard.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace adaptiso::detail {
namespace {

/// Side of the cubes in which samples are looked up, and how far around a star, in voxels.
constexpr double kCube = 2, kReach = 1;

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
        if (patch_.sampleIsSingleSheet[s] != 0 && !looksEverywhere_) continue;
        const Vec3 index = frame_.toIndex(patch_.samples[s]);
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

bool CrossingGuard::crossesNothing(const ChangedStar& changed) {
    if (!changed.isGraph && !wedgesAreClear(changed)) return false;
    collectNear(changed);
    for (const std::uint32_t other : near_) {
        const CornerBox box = boxOf(cornersOf(other));
        for (int i = 0; i < changed.star.count; ++i) {
            if (box.overlaps(wedgeBox_[i]) && !isClear(changed, i, other)) return false;
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
    if (grid_.begin.empty()) buildGrid();
    const Star& star = changed.star;
    ++now_;
    near_.clear();
    starBox_ = {changed.vertex, changed.vertex};
    for (int i = 0; i < star.count; ++i) {
        const Vec3 &r = patch_.points[star.ring[i]],
                   &s = patch_.points[star.ring[(i + 1) % star.count]];
        wedgeBox_[i] = boxOf({changed.vertex, r, s});
        wedgeBox_[i].widen(gapMm_);
        starBox_.add(r);
        stamp_[star.triangle[i]] = now_;
    }
    for (int i = 0; i < star.removedCount; ++i) stamp_[star.removed[i]] = now_;
    starBox_.widen(gapMm_);
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
    if (boxOf(cornersOf(triangle)).overlaps(starBox_)) near_.push_back(triangle);
}

}  // namespace adaptiso::detail
