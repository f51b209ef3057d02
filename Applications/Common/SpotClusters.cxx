#include "Common/SpotClusters.h"

#include <algorithm>
#include <cmath>

#include "Common/Numbers.h"

namespace adaptiso {
namespace {

constexpr double kNear = 0.06;

bool isFinite(const Vec3& p) {
    return std::isfinite(squaredNorm(p));
}

double diagonalOf(const TriangleMesh& mesh) {
    TriangleMesh finite;
    std::copy_if(mesh.points.begin(), mesh.points.end(), std::back_inserter(finite.points),
                 isFinite);
    if (finite.points.empty()) return 0;
    const BoundingBox box = boundingBox(finite);
    return norm(box.size());
}

}  // namespace

SpotClusters::SpotClusters(const TriangleMesh& mesh) : nearMm_(kNear * diagonalOf(mesh)) {}

void SpotClusters::add(const Vec3& p) {
    if (!isFinite(p)) return;
    for (auto& [middle, count] : clusters_) {
        if (norm(middle - p) > nearMm_) continue;
        ++count;
        return;
    }
    clusters_.push_back({p, 1});
}

void SpotClusters::tell(const std::string& what, bool isFailure, std::vector<ReportSpot>& spots) {
    std::stable_sort(clusters_.begin(), clusters_.end(),
                     [](const auto& a, const auto& b) { return a.second > b.second; });
    for (std::size_t n = 0; n < std::min(clusters_.size(), kMostSpotsOfAKind); ++n) {
        const auto& [middle, count] = clusters_[n];
        spots.push_back({count > 1 ? what + " (" + formatCount(count) + " here)" : what, middle,
                         isFailure, static_cast<int>(n)});
    }
}

Vec3 middleOf(const TriangleMesh& mesh, std::int64_t triangle) {
    const auto& [a, b, c] = mesh.triangles[static_cast<std::size_t>(triangle)];
    return (1.0 / 3) * (mesh.points[a] + mesh.points[b] + mesh.points[c]);
}

}  // namespace adaptiso
