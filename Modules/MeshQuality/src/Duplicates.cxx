#include "adaptiso/MeshQuality/Duplicates.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>
#include <tuple>

#include "RequireIndices.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/ParallelSort.h"

namespace adaptiso {
namespace {

constexpr VertexId kNowhere = -1;

/// The smallest number of a vertex at the same place, for every vertex.
std::vector<VertexId> findPlaces(const std::vector<Vec3>& points) {
    std::vector<VertexId> place(points.size(), kNowhere), order;
    order.reserve(points.size());
    for (std::size_t v = 0; v < points.size(); ++v) {
        if (std::isfinite(squaredNorm(points[v]))) order.push_back(static_cast<VertexId>(v));
    }
    parallelSort(order, [&](VertexId l, VertexId r) {
        const Vec3 &a = points[l], &b = points[r];
        return std::tie(a.x, a.y, a.z, l) < std::tie(b.x, b.y, b.z, r);
    });
    for (std::size_t n = 0; n < order.size(); ++n) {
        const bool isNew = n == 0 || points[order[n]] != points[order[n - 1]];
        place[order[n]] = isNew ? order[n] : place[order[n - 1]];
    }
    return place;
}

/// Three places, ascending, and the triangle's number.
using Seat = std::array<std::int64_t, 4>;

std::vector<Seat> findSeats(const TriangleMesh& mesh, const std::vector<VertexId>& place) {
    std::vector<Seat> seats;
    seats.reserve(mesh.triangles.size());
    for (std::size_t n = 0; n < mesh.triangles.size(); ++n) {
        const Triangle& t = mesh.triangles[n];
        Seat seat{place[t[0]], place[t[1]], place[t[2]], static_cast<std::int64_t>(n)};
        std::sort(seat.begin(), seat.begin() + 3);
        if (seat[0] == kNowhere || seat[0] == seat[1] || seat[1] == seat[2]) continue;
        seats.push_back(seat);
    }
    parallelSort(seats);
    return seats;
}

/// The smallest `count` of `numbers`, ascending.
void keepFirst(std::vector<std::int64_t>& numbers, std::int64_t count) {
    std::sort(numbers.begin(), numbers.end());
    if (std::ssize(numbers) > count) numbers.resize(count);
}

}  // namespace

DuplicateReport findDuplicates(const TriangleMesh& mesh, const DuplicateOptions& options) {
    if (options.maxExamples < 0) {
        throw InvalidInput("findDuplicates: maxExamples is " + std::to_string(options.maxExamples) +
                           ", must be at least 0");
    }
    requireIndices(mesh, "findDuplicates");
    DuplicateReport report;
    const std::vector<VertexId> place = findPlaces(mesh.points);
    for (std::size_t n = 0; n < place.size(); ++n) {
        const auto v = static_cast<VertexId>(n);
        if (place[n] != kNowhere && place[n] != v) report.vertices.push_back(v);
    }
    const std::vector<Seat> seats = findSeats(mesh, place);
    for (std::size_t n = 1; n < seats.size(); ++n) {
        if (std::equal(seats[n].begin(), seats[n].begin() + 3, seats[n - 1].begin())) {
            report.triangles.push_back(seats[n][3]);
        }
    }
    report.vertexCount = std::ssize(report.vertices);
    report.triangleCount = std::ssize(report.triangles);
    keepFirst(report.vertices, options.maxExamples);
    keepFirst(report.triangles, options.maxExamples);
    return report;
}

}  // namespace adaptiso
