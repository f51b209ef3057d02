#include "ExactCrossing.h"

#include <algorithm>
#include <utility>

namespace adaptiso::testing {
namespace {

/// On which side of the plane through a, b and c a point lies; 0 in it. Exact.
int side(const IntPoint& a, const IntPoint& b, const IntPoint& c, const IntPoint& p) {
    std::array<IntPoint, 3> d;
    for (int i = 0; i < 3; ++i) {
        d[0][i] = b[i] - a[i];
        d[1][i] = c[i] - a[i];
        d[2][i] = p[i] - a[i];
    }
    const std::int64_t volume = d[2][0] * (d[0][1] * d[1][2] - d[0][2] * d[1][1]) +
                                d[2][1] * (d[0][2] * d[1][0] - d[0][0] * d[1][2]) +
                                d[2][2] * (d[0][0] * d[1][1] - d[0][1] * d[1][0]);
    return volume > 0 ? 1 : volume < 0 ? -1 : 0;
}

bool has(const std::array<int, 3>& triangle, int point) {
    return std::find(triangle.begin(), triangle.end(), point) != triangle.end();
}

}  // namespace

TriangleMesh IntegerSoup::mesh() const {
    TriangleMesh mesh;
    for (const IntPoint& p : points) {
        mesh.points.push_back(
            {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])});
    }
    for (const auto& t : triangles) mesh.triangles.push_back({t[0], t[1], t[2]});
    return mesh;
}

Corners IntegerSoup::corners(int t) const {
    Corners corners;
    for (int c = 0; c < 3; ++c) {
        for (int a = 0; a < 3; ++a) {
            corners[c][a] = static_cast<double>(points[triangles[t][c]][a]);
        }
    }
    return corners;
}

std::optional<bool> IntegerSoup::cross(int s, int t) const {
    bool isCrossed = false;
    for (const auto& [from, to] : {std::pair(s, t), std::pair(t, s)}) {
        const auto& other = triangles[to];
        const std::array<IntPoint, 3> c{points[other[0]], points[other[1]], points[other[2]]};
        for (const int p : triangles[from]) {
            if (!has(other, p) && side(c[0], c[1], c[2], points[p]) == 0) return {};
        }
        for (int i = 0; i < 3; ++i) {
            const int p = triangles[from][i], q = triangles[from][(i + 1) % 3];
            if (has(other, p) || has(other, q)) continue;
            if (side(c[0], c[1], c[2], points[p]) == side(c[0], c[1], c[2], points[q])) continue;
            // the line from p to q passes all three sides on the same hand
            std::array<int, 3> hand;
            for (int e = 0; e < 3; ++e) hand[e] = side(points[p], points[q], c[e], c[(e + 1) % 3]);
            if (std::count(hand.begin(), hand.end(), 0) > 0) return {};
            if (hand[0] == hand[1] && hand[1] == hand[2]) isCrossed = true;
        }
    }
    return isCrossed;
}

IntegerSoup randomSoup(std::mt19937& random, int points, int triangles, std::int64_t halfSide) {
    std::uniform_int_distribution<std::int64_t> at(-halfSide, halfSide);
    IntegerSoup soup;
    for (int p = 0; p < points; ++p) soup.points.push_back({at(random), at(random), at(random)});
    while (static_cast<int>(soup.triangles.size()) < triangles) {
        std::array<int, 3> t{};
        for (int& corner : t) corner = static_cast<int>(random() % points);
        if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) soup.triangles.push_back(t);
    }
    return soup;
}

}  // namespace adaptiso::testing
