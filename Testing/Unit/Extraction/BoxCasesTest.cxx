#include <gtest/gtest.h>

#include <map>
#include <set>
#include <tuple>

#include "adaptiso/Extraction/detail/BoxCases.h"

namespace adaptiso::detail {
namespace {

/// Calls f(corners, joined) for every case: all corners, all decisions of ambiguous faces.
template <class F>
void forEachCase(const F& f) {
    const BoxCases& cases = BoxCases::instance();
    for (unsigned corners = 0; corners < 256; ++corners) {
        const unsigned ambiguous = cases.ambiguousFaces(corners);
        for (unsigned joined = 0; joined < 64; ++joined) {
            if ((joined & ~ambiguous) == 0)
                f(corners, joined, cases[cases.caseIndex(corners, joined)]);
        }
    }
}

/// Iso-lines of a face as (from side, to side), as one of the two boxes at it sees them.
std::set<std::pair<int, int>> linesOnFace(const BoxCase& box, int face, bool reversed) {
    std::set<std::pair<int, int>> lines;
    for (int from = 0; from < 4; ++from) {
        const int h = box.onFace[face][from];
        if (h == 255) continue;
        const int end = box.halfEdge[box.halfEdge[h].next].edge;
        for (int to = 0; to < 4; ++to) {
            if (faceEdge(face, to) == end) {
                lines.insert(reversed ? std::pair{to, from} : std::pair{from, to});
            }
        }
    }
    return lines;
}

}  // namespace

TEST(BoxCases, CoverEveryCornerPatternAndDecision) {
    int count = 0;
    forEachCase([&](unsigned, unsigned, const BoxCase&) { ++count; });
    EXPECT_EQ(count, BoxCases::instance().caseCount());
    EXPECT_EQ(count, 656);
}

TEST(BoxCases, EveryCrossedEdgeLiesOnOneLoop) {
    forEachCase([](unsigned corners, unsigned, const BoxCase& box) {
        std::map<int, int> passages;
        for (const auto& face : box.onFace) {
            for (const int h : face) {
                if (h != 255) ++passages[box.halfEdge[h].edge];
            }
        }
        int crossed = 0;
        for (int edge = 0; edge < kBoxEdges; ++edge) {
            const bool isCrossed =
                (corners >> lowCorner(edge) & 1u) != (corners >> highCorner(edge) & 1u);
            EXPECT_EQ(passages.count(edge) ? passages[edge] : 0, isCrossed ? 1 : 0);
            crossed += isCrossed;
        }
        EXPECT_EQ(box.crossedEdges, crossed);
        EXPECT_EQ(box.triangleCount, crossed - 2 * box.loopCount);
    });
}

TEST(BoxCases, InnerHalfEdgesComeInOppositePairs) {
    forEachCase([](unsigned corners, unsigned joined, const BoxCase& box) {
        std::multiset<std::pair<int, int>> inner;
        for (int h = 0; h < box.halfEdgeCount; ++h) {
            if (box.halfEdge[h].face != kInsideBox) continue;
            inner.insert({box.halfEdge[h].edge, box.halfEdge[box.halfEdge[h].next].edge});
        }
        for (const auto& [from, to] : inner) {
            EXPECT_EQ(inner.count({from, to}), 1u) << corners << " " << joined;
            EXPECT_EQ(inner.count({to, from}), 1u) << corners << " " << joined;
        }
    });
}

TEST(BoxCases, NeighboursSeeTheSameIsoLinesTheOtherWayRound) {
    // all pairs of cases that agree on the face between them
    std::map<std::tuple<int, unsigned, bool>, std::set<std::pair<int, int>>> seen;
    forEachCase([&](unsigned corners, unsigned joined, const BoxCase& box) {
        for (int face = 0; face < kBoxFaces; ++face) {
            unsigned square = 0;
            const auto corner = faceCorners(face);
            for (int i = 0; i < 4; ++i) square |= (corners >> corner[i] & 1u) << i;
            const bool isJoined = isAmbiguous(square) && (joined >> face & 1u) != 0;
            const auto lines = linesOnFace(box, face, (face & 1) != 0);
            const auto [known, isNew] = seen.try_emplace({face / 2, square, isJoined}, lines);
            EXPECT_EQ(known->second, lines) << "corners " << corners << ", face " << face;
        }
    });
}

TEST(BoxCases, FacetsOfAFamilyLieOnItsPlane) {
    forEachCase([](unsigned, unsigned, const BoxCase& box) {
        for (int f = 0; f < box.facetCount; ++f) {
            const CaseFacet& facet = box.facet[f];
            if (facet.incidence == kNoIncidence) continue;
            for (int i = 0; i < facet.size; ++i) {
                const auto& d = box.halfEdge[facet.firstHalfEdge + i].direction;
                EXPECT_EQ(d[0] * facet.normal[0] + d[1] * facet.normal[1] + d[2] * facet.normal[2],
                          0);
            }
        }
    });
}

TEST(BoxCases, ThirteenIncidencesOccur) {
    std::set<int> found;
    forEachCase([&](unsigned, unsigned, const BoxCase& box) {
        for (int f = 0; f < box.facetCount; ++f) found.insert(box.facet[f].incidence);
    });
    found.erase(kNoIncidence);
    EXPECT_EQ(found.size(), 13u);
}

TEST(BoxCases, FacetsFaceTheOutside) {
    // a facet's normal points from the inside end of each edge it crosses to the outside end
    forEachCase([](unsigned corners, unsigned, const BoxCase& box) {
        for (int f = 0; f < box.facetCount; ++f) {
            const CaseFacet& facet = box.facet[f];
            if (facet.incidence == kNoIncidence || box.facetCount > 1) continue;
            for (int i = 0; i < facet.size; ++i) {
                const int edge = box.halfEdge[facet.firstHalfEdge + i].edge;
                const int towards = facet.normal[edgeAxis(edge)];
                const bool lowIsInside = (corners >> lowCorner(edge) & 1u) != 0;
                EXPECT_TRUE(towards == 0 || (towards > 0) == lowIsInside);
            }
        }
    });
}

}  // namespace adaptiso::detail
