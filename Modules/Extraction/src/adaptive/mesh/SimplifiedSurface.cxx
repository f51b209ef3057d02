#include "adaptive/mesh/SimplifiedSurface.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <unordered_map>

#include "adaptiso/Core/Memory.h"
#include "adaptiso/Core/Parallel.h"

namespace adaptiso::detail {
namespace {

using Number = SurfaceState::Number;

/// \param newVertex  of each vertex, kGone for those that are gone
/// \param mergedInto of each vertex, what it was merged into in this round
void passOn(const std::vector<Number>& newVertex, const std::vector<Number>& mergedInto,
            std::vector<Number>& heirs) {
    for (Number& heir : heirs) {
        while (newVertex[heir] == SimplifiedSurface::kGone) heir = mergedInto[heir];
        heir = newVertex[heir];
    }
}

/// A copy of a list takes time, and memory meanwhile: it is worth it where a fifth goes.
template <class T>
void shrink(std::vector<T>& list) {
    if (list.capacity() - list.size() >= list.size() / 4) shrinkInHugePages(list);
}

}  // namespace

std::vector<Vec3> areasAround(const TriangleView& surface) {
    std::vector<Vec3> areas;
    assignInHugePages(areas, surface.points.size());
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        const auto [a, b, c] = surface.cornersOf(t);
        const Vec3 area2 = areaVector2(a, b, c);
        for (const Number v : surface.triangles[t]) areas[v] += area2;
    }
    return areas;
}

std::vector<Quadric> quadricsOf(const TriangleView& surface) {
    std::vector<Quadric> sums;
    assignInHugePages(sums, surface.points.size());
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        const auto [a, b, c] = surface.cornersOf(t);
        const Quadric q = Quadric::ofTriangle(areaVector2(a, b, c), a);
        for (const Number v : surface.triangles[t]) sums[v] += q;
    }
    return sums;
}

void setQuadrics(SimplifiedSurface& surface) {
    const std::vector<Quadric> sums = quadricsOf(surface.view());
    assignInHugePages(surface.quadrics, sums.size());
    for (std::size_t v = 0; v < sums.size(); ++v) {
        surface.quadrics[v] = StoredQuadric::of(sums[v], surface.points[v]);
    }
}

void removeGone(SimplifiedSurface& surface, const std::vector<SurfaceState::Number>& mergedInto) {
    constexpr Number kGone = SimplifiedSurface::kGone;
    std::vector<Number> newTriangle, newVertex;
    assignInHugePages(newTriangle, surface.triangles.size());
    assignInHugePages(newVertex, surface.points.size(), kGone);
    Number triangles = 0, vertices = 0;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        if (surface.triangles[t][0] == kGone) continue;
        for (const Number v : surface.triangles[t]) newVertex[v] = 0;
        newTriangle[t] = triangles;
        surface.triangles[triangles++] = surface.triangles[t];
    }
    for (Number& v : newVertex) {
        if (v != kGone) v = vertices++;
    }
    const auto keep = [&](auto& members) {
        if (members.empty()) return;
        for (std::size_t v = 0; v < newVertex.size(); ++v) {
            if (newVertex[v] != kGone) members[newVertex[v]] = members[v];
        }
        members.resize(vertices);
        shrink(members);
    };
    parallelInvoke(
        [&] {
            surface.triangles.resize(triangles);
            shrink(surface.triangles);
            for (auto& t : surface.triangles) {
                for (Number& v : t) v = newVertex[v];
            }
        },
        [&] { keep(surface.quadrics); }, [&] { keep(surface.points); },
        [&] { keep(surface.states); }, [&] { keep(surface.marks); },
        [&] {
            for (Number& t : surface.sampleTriangle) t = newTriangle[t];
        },
        [&] { passOn(newVertex, mergedInto, surface.heirs); });
}

void removeTriangles(std::vector<SurfaceState::Number> gone, SurfaceState& surface,
                     SurfaceChanges& changes) {
    if (gone.empty()) return;
    std::sort(gone.begin(), gone.end(), std::greater());
    std::unordered_map<SurfaceState::Number, SurfaceState::Number> renumbered;
    for (const SurfaceState::Number t : gone) {
        const auto last = static_cast<SurfaceState::Number>(surface.triangles.size() - 1);
        if (t != last) {
            surface.triangles[t] = surface.triangles[last];
            renumbered[last] = t;
            changes.triangles.push_back(t);
        }
        surface.triangles.pop_back();
    }
    for (SurfaceState::Number& t : surface.sampleTriangle) {
        while (t >= surface.triangles.size()) t = renumbered.at(t);
    }
}

double costLimitFor(const CollapseCosts& costs, std::int64_t collapses) {
    // a patch stops for good at its first collapse above the limit: what counts is the largest so
    // far
    std::vector<double> largestSoFar;
    for (const std::vector<double>& patch : costs) {
        double largest = 0;
        for (const double cost : patch) {
            largest = std::max(largest, cost);
            largestSoFar.push_back(largest);
        }
    }
    if (static_cast<std::int64_t>(largestSoFar.size()) <= collapses) {
        return std::numeric_limits<double>::max();
    }
    const auto first = largestSoFar.begin() + collapses;  // the first one too many
    std::nth_element(largestSoFar.begin(), first, largestSoFar.end());
    return std::nextafter(*first, 0.0);
}

}  // namespace adaptiso::detail
