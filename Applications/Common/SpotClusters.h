#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Report/Report.h"

namespace adaptiso {

/// At most so many places of a kind are told; who has to look at more has to look everywhere.
inline constexpr std::size_t kMostSpotsOfAKind = 12;

/// Defects that lie near each other, told as one place each.
class SpotClusters {
public:
    /// \param mesh  defects nearer than 6 % of the diagonal of its finite points are one place
    explicit SpotClusters(const TriangleMesh& mesh);

    /// A defect at `p`; one that is not finite is left out.
    void add(const Vec3& p);

    /// Adds the places to `spots`, that with the most defects first.
    /// \param what  "crossing triangles in a.stl"
    void tell(const std::string& what, bool isFailure, std::vector<ReportSpot>& spots);

private:
    double nearMm_;
    std::vector<std::pair<Vec3, std::int64_t>> clusters_;
};

/// The mean of the triangle's corners.
Vec3 middleOf(const TriangleMesh& mesh, std::int64_t triangle);

}  // namespace adaptiso
