#include "adaptive/mesh/WholeBricks.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "adaptiso/Core/Parallel.h"

namespace adaptiso::detail {
namespace {

constexpr std::int64_t kPiece = 1 << 14;

/// The brick that a point lies in.
std::int64_t brickAt(const Vec3& index, const Bricks& bricks) {
    Index3 place;
    for (int a = 0; a < 3; ++a) {
        const double lattice = index[a] + static_cast<double>(bricks.grid().offset);
        place[a] = static_cast<std::int64_t>(std::floor(lattice / Brick::kSide));
    }
    return bricks.at(place);
}

}  // namespace

WholeBricks::WholeBricks(const SimplifiedSurface& surface, const Bricks& bricks,
                         const MetricFrame& frame) {
    const auto isLeft = [](const BrickPrint& print) { return print.triangles > 0; };
    if (std::none_of(surface.prints.begin(), surface.prints.end(), isLeft)) return;
    // a triangle of the full-resolution surface lies in a cell, its middle not in the cell's walls
    brickOf_.resize(surface.triangles.size());
    using Part = std::pair<std::uint32_t, BrickPrint>;
    std::vector<std::vector<Part>> ofPiece((surface.triangles.size() + kPiece - 1) / kPiece);
    parallelForPieces(
        std::ssize(surface.triangles), kPiece, [&](std::int64_t begin, std::int64_t end) {
            std::vector<Part>& parts = ofPiece[begin / kPiece];
            for (std::int64_t t = begin; t < end; ++t) {
                const auto& [a, b, c] = surface.triangles[t];
                const Corners corners{surface.points[a], surface.points[b], surface.points[c]};
                const Vec3 middle = (1.0 / 3) * (corners[0] + corners[1] + corners[2]);
                const std::int64_t brick = brickAt(frame.toIndex(middle), bricks);
                const bool isOfOne = brick != Bricks::kNone && isLeft(surface.prints[brick]);
                brickOf_[t] = isOfOne ? static_cast<std::uint32_t>(brick) : kNone;
                if (!isOfOne) continue;
                if (parts.empty() || parts.back().first != brickOf_[t]) {
                    parts.push_back({brickOf_[t], {}});
                }
                parts.back().second.add(corners);
            }
        });
    std::vector<BrickPrint> now(surface.prints.size());
    for (const auto& parts : ofPiece) {
        for (const auto& [brick, print] : parts) now[brick] += print;
    }
    isWhole_.resize(now.size());
    std::uint64_t fine = 0;
    for (std::size_t b = 0; b < now.size(); ++b) {
        if (!isLeft(surface.prints[b]) || surface.prints[b] != now[b]) continue;
        isWhole_[b] = 1;
        isAny_ = true;
        fine += now[b].triangles;
    }
    areAll_ = fine == surface.triangles.size() &&
              std::count(isWhole_.begin(), isWhole_.end(), 1) == std::ssize(isWhole_);
}

}  // namespace adaptiso::detail
