// Stars at an open border: what PatchTopology makes of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "adaptive/mesh/PatchTopology.h"

namespace adaptiso::testing {
namespace {

using detail::Patch;
using detail::PatchTopology;
using detail::Star;

constexpr std::uint32_t kSquareSide = 5;

std::uint32_t at(std::uint32_t x, std::uint32_t y) {
    return x + kSquareSide * y;
}

/// A square of 4 x 4 squares, each cut along the diagonal, open all around.
Patch square() {
    Patch patch;
    for (std::uint32_t y = 0; y < kSquareSide; ++y) {
        for (std::uint32_t x = 0; x < kSquareSide; ++x) {
            patch.points.push_back({static_cast<double>(x), static_cast<double>(y), 0});
            const bool isBorder = x == 0 || y == 0 || x + 1 == kSquareSide || y + 1 == kSquareSide;
            patch.marks.push_back(isBorder ? Patch::kBorder : Patch::kPlain);
        }
    }
    for (std::uint32_t y = 0; y + 1 < kSquareSide; ++y) {
        for (std::uint32_t x = 0; x + 1 < kSquareSide; ++x) {
            patch.triangles.push_back({at(x, y), at(x + 1, y), at(x + 1, y + 1)});
            patch.triangles.push_back({at(x, y), at(x + 1, y + 1), at(x, y + 1)});
        }
    }
    patch.ownTriangles = static_cast<std::uint32_t>(patch.triangles.size());
    return patch;
}

std::uint32_t halfEdge(const Patch& patch, std::uint32_t from, std::uint32_t to) {
    for (std::uint32_t t = 0; t < patch.triangles.size(); ++t) {
        for (std::uint32_t c = 0; c < 3; ++c) {
            if (patch.triangles[t][c] == from && patch.triangles[t][(c + 1) % 3] == to) {
                return 3 * t + c;
            }
        }
    }
    return PatchTopology::kNone;
}

/// Every edge in one triangle or two that run along it in opposite directions.
void expectManifold(const Patch& patch, std::size_t borderEdges) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> count;
    for (const auto& t : patch.triangles) {
        if (t[0] == Patch::kGone) continue;
        for (int c = 0; c < 3; ++c) ++count[{t[c], t[(c + 1) % 3]}];
    }
    std::size_t open = 0;
    for (const auto& [edge, n] : count) {
        EXPECT_EQ(n, 1);
        if (!count.contains({edge.second, edge.first})) ++open;
    }
    EXPECT_EQ(open, borderEdges);
}

/// The ring as it follows from the triangles: all corners but the apexes, in a chain.
void expectChain(const Patch& patch, const Star& star) {
    for (int i = 0; i < star.count; ++i) {
        const auto& t = patch.triangles[star.triangle[i]];
        const auto apex = std::find(t.begin(), t.end(), star.apex[i]) - t.begin();
        EXPECT_EQ(t[(apex + 1) % 3], star.ring[i]);
        EXPECT_EQ(t[(apex + 2) % 3], star.ring[i + 1]);
    }
}

constexpr std::size_t kBorderEdges = std::size_t{4} * (kSquareSide - 1);

}  // namespace

TEST(OpenStar, OfABorderVertexIsAChain) {
    Patch patch = square();
    const PatchTopology topology(patch);
    ASSERT_TRUE(topology.isMovable(at(2, 0)));
    EXPECT_TRUE(topology.isOnBorder(at(2, 0)));
    EXPECT_FALSE(topology.isOnBorder(at(2, 2)));
    Star star;
    ASSERT_TRUE(topology.starOf(at(2, 0), star));
    EXPECT_TRUE(star.isOpen);
    EXPECT_EQ(star.count, 3);
    EXPECT_EQ(star.ringCount(), 4);
    EXPECT_EQ(star.ring[0], at(3, 0));
    EXPECT_EQ(star.ring[3], at(1, 0));
    expectChain(patch, star);
}

TEST(OpenStar, WithoutMarksBordersStay) {
    Patch patch = square();
    patch.marks.clear();
    const PatchTopology topology(patch);
    EXPECT_FALSE(topology.isMovable(at(2, 0)));
    EXPECT_TRUE(topology.isMovable(at(2, 2)));
}

TEST(OpenStar, AnEdgeOfTheBorderCollapses) {
    Patch patch = square();
    PatchTopology topology(patch);
    Star star;
    ASSERT_TRUE(topology.starOfEdge(halfEdge(patch, at(1, 0), at(2, 0)), star));
    EXPECT_EQ(star.removedCount, 1);
    EXPECT_EQ(star.ring[0], at(3, 0));
    EXPECT_EQ(star.ring[star.count], at(0, 0));
    expectChain(patch, star);
    topology.collapse(halfEdge(patch, at(1, 0), at(2, 0)), star);
    expectManifold(patch, kBorderEdges - 1);
    EXPECT_TRUE(topology.isOnBorder(at(1, 0)));
    EXPECT_FALSE(topology.isMovable(at(2, 0)));
}

TEST(OpenStar, AnEdgeThatEndsAtTheBorderCollapsesIntoIt) {
    for (const bool startsAtBorder : {true, false}) {
        Patch patch = square();
        PatchTopology topology(patch);
        const std::uint32_t from = startsAtBorder ? at(2, 0) : at(2, 1),
                            to = startsAtBorder ? at(2, 1) : at(2, 0);
        Star star;
        ASSERT_TRUE(topology.starOfEdge(halfEdge(patch, from, to), star));
        EXPECT_TRUE(star.isOpen);
        EXPECT_EQ(star.removedCount, 2);
        expectChain(patch, star);
        topology.collapse(halfEdge(patch, from, to), star);
        expectManifold(patch, kBorderEdges);
        EXPECT_TRUE(topology.isOnBorder(from));
    }
}

TEST(OpenStar, AnEdgeAcrossTheCornerStays) {
    Patch patch = square();
    PatchTopology topology(patch);
    Star star;
    // joins two places of the border, the corner's triangle beside it
    EXPECT_FALSE(topology.starOfEdge(halfEdge(patch, at(0, 3), at(1, 4)), star));
}

TEST(OpenStar, ACornerMayGo) {
    Patch patch = square();
    PatchTopology topology(patch);
    Star star;
    const std::uint32_t h = halfEdge(patch, at(1, 4), at(0, 4));
    ASSERT_TRUE(topology.starOfEdge(h, star));
    topology.collapse(h, star);
    expectManifold(patch, kBorderEdges - 1);
}

TEST(OpenStar, ATriangleByItselfStays) {
    Patch patch = square();
    patch.triangles.resize(1);
    patch.ownTriangles = 1;
    for (const std::uint32_t v : patch.triangles[0]) patch.marks[v] = Patch::kBorder;
    PatchTopology topology(patch);
    Star star;
    for (std::uint32_t h = 0; h < 3; ++h) EXPECT_FALSE(topology.starOfEdge(h, star));
}

TEST(OpenStar, AHoleOfThreeEdgesStays) {
    // a triangle is left out inside: its edges are borders, and would become one edge twice
    Patch patch = square();
    const auto hole = std::find(patch.triangles.begin(), patch.triangles.end(),
                                std::array{at(1, 1), at(2, 1), at(2, 2)});
    ASSERT_NE(hole, patch.triangles.end());
    patch.triangles.erase(hole);
    --patch.ownTriangles;
    for (const std::uint32_t v : {at(1, 1), at(2, 1), at(2, 2)}) patch.marks[v] = Patch::kBorder;
    PatchTopology topology(patch);
    Star star;
    EXPECT_FALSE(topology.starOfEdge(halfEdge(patch, at(2, 1), at(1, 1)), star));
}

// Collapses along the border in many orders leave a manifold, whose border goes round once.
TEST(OpenStar, ManyCollapsesLeaveAManifold) {
    for (std::uint32_t step = 1; step < 40; ++step) {
        Patch patch = square();
        PatchTopology topology(patch);
        std::size_t border = kBorderEdges;
        Star star;
        for (std::uint32_t n = 0, h = 0; n < 200; ++n) {
            h = (h + step) % (3 * patch.ownTriangles);
            if (patch.triangles[h / 3][0] == Patch::kGone) continue;
            if (!topology.isMovable(topology.from(h)) || !topology.isMovable(topology.to(h))) {
                continue;
            }
            const bool isBorder = topology.twin(h) == PatchTopology::kNone;
            if (!topology.starOfEdge(h, star)) continue;
            topology.collapse(h, star);
            border -= isBorder ? 1 : 0;
            expectManifold(patch, border);
            for (std::uint32_t v = 0; v < patch.points.size(); ++v) {
                if (!topology.isMovable(v)) continue;
                ASSERT_EQ(topology.from(topology.leaving(v)), v);
                ASSERT_TRUE(topology.starOf(v, star));
                expectChain(patch, star);
            }
        }
    }
}

}  // namespace adaptiso::testing
