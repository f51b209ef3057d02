#include "repair/MeshParts.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <string>
#include <tuple>
#include <unordered_set>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Memory.h"
#include "adaptiso/Core/MortonOrder.h"
#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Core/ParallelSort.h"
#include "adaptiso/Extraction/detail/FlatTriangles.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"
#include "adaptiso/SurfaceProof/HalfEdges.h"
#include "adaptive/mesh/Patch.h"

namespace adaptiso::detail {
namespace {

constexpr std::int64_t kPartPiece = 1 << 12;
/// Below, a mesh fits a processor's cache in any order.
constexpr double kManyTriangles = 1 << 15;
/// As a fraction of the points: mean distance of an edge's ends in the list.
/// Marching cubes' are a hundredth, in any order a third.
constexpr double kScattered = 0.1;

void requireSimplifiable(const TriangleMesh& mesh) {
    const auto refuse = [](const std::string& what) { throw InvalidInput("simplify: " + what); };
    constexpr auto kMost = std::numeric_limits<std::uint32_t>::max() / 3;
    if (mesh.triangles.size() >= kMost || mesh.points.size() >= kMost) {
        refuse("the mesh has more than " + std::to_string(kMost) + " triangles or points");
    }
    for (std::size_t v = 0; v < mesh.points.size(); ++v) {
        const Vec3& p = mesh.points[v];
        if (std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)) continue;
        refuse("vertex " + std::to_string(v) + " has a coordinate that is not finite");
    }
    if (!mesh.points.empty()) {
        const BoundingBox box = boundingBox(mesh);
        if (!std::isfinite(norm(box.size()))) refuse("the mesh is too large");
    }
    const auto points = static_cast<VertexId>(mesh.points.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        for (const VertexId v : mesh.triangles[t]) {
            if (v >= 0 && v < points) continue;
            refuse("triangle " + std::to_string(t) + " names vertex " + std::to_string(v) +
                   ", the mesh has " + std::to_string(points));
        }
    }
    if (!mesh.normals.empty() && mesh.normals.size() != mesh.points.size()) {
        refuse("the mesh has not one normal for each vertex");
    }
}

/// Along an axis where the points are no farther apart than from 0, the middle: both differ by a
/// factor of two at most, and their difference is exact (Sterbenz's lemma).
Vec3 originFor(const TriangleMesh& mesh) {
    const BoundingBox box = boundingBox(mesh);
    Vec3 origin;
    for (int a = 0; a < 3; ++a) {
        const double low = box.minimum[a], high = box.maximum[a], middle = low + 0.5 * (high - low);
        if (std::min(std::abs(low), std::abs(high)) > high - low && low * high > 0) {
            origin[a] = middle;
        }
    }
    return origin;
}

/// Takes a mesh apart, step by step.
class Cutter {
public:
    Cutter(const TriangleMesh& mesh, bool keepsBorders, double mayMoveMm)
        : mesh_(mesh), keepsBorders_(keepsBorders), mayMoveMm_(mayMoveMm) {}

    MeshParts run() {
        parts_.origin = originFor(mesh_);
        takeTriangles();
        halfEdges_.assign(parts_.points.size(), parts_.triangles);
        if (dropDuplicates()) halfEdges_.assign(parts_.points.size(), parts_.triangles);

        halfEdges_.match(twin_);
        parts_.crossing = findCrossingTriangles(parts_.view());
        cutEdges();
        cutPoints();
        keepCrossings();
        if (parts_.crossing.isEmpty()) freeMemory(parts_.inputTriangle);  // none is asked for
        if (keepsBorders_) {
            for (const std::uint64_t h : parts_.borderEdges) {
                keep(from(static_cast<std::uint32_t>(h)));
                keep(to(static_cast<std::uint32_t>(h)));
            }
        }
        return std::move(parts_);
    }

private:
    using Spoke = HalfEdges<std::uint32_t>::Spoke;
    static constexpr std::uint32_t kNone = HalfEdges<std::uint32_t>::kNone;
    static constexpr std::size_t kFewSpokes = 32;  ///< a look at each is faster than sorting

    std::uint32_t from(std::uint32_t h) const { return parts_.triangles[h / 3][h % 3]; }
    static std::uint32_t next(std::uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
    static std::uint32_t previous(std::uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }
    std::uint32_t to(std::uint32_t h) const { return from(next(h)); }

    /// Those with an area, with the points that they use.
    void takeTriangles() {
        AreaTriangles withArea = withoutFlatTriangles(mesh_, mayMoveMm_);
        parts_.degenerate = withArea.flat;
        parts_.movedMm = withArea.movedMm;
        if (withArea.flat == 0) {
            takeAll(mesh_.triangles);
        } else {
            takeSome(withArea);
            freeMemory(withArea.triangles, withArea.isLeftOut);
        }
        if (parts_.triangles.empty()) {
            throw InvalidInput("simplify: the mesh has no triangle with an area");
        }
        const bool isScattered = comeScattered();
        const std::vector<std::uint32_t> number = takePoints(isScattered);
        forEach(parts_.triangles.size(), [&](std::size_t t) {
            for (std::uint32_t& v : parts_.triangles[t]) v = number[v];
        });
        if (isScattered) sortTriangles();
    }

    void takeAll(const std::vector<Triangle>& triangles) {
        assignInHugePages(parts_.triangles, triangles.size());
        forEach(triangles.size(),
                [&](std::size_t t) { parts_.triangles[t] = narrowed(triangles[t]); });
    }

    void takeSome(const AreaTriangles& from) {
        for (std::size_t t = 0; t < from.triangles.size(); ++t) {
            if (from.isLeftOut[t] != 0) continue;
            parts_.triangles.push_back(narrowed(from.triangles[t]));
            parts_.inputTriangle.push_back(static_cast<std::uint32_t>(t));
        }
    }

    static MeshParts::Triangle narrowed(const Triangle& t) {
        return {static_cast<std::uint32_t>(t[0]), static_cast<std::uint32_t>(t[1]),
                static_cast<std::uint32_t>(t[2])};
    }

    /// Many triangles whose corners mostly lie far apart in the list of points: all that is done
    /// with neighbours would wait for memory.
    bool comeScattered() const {
        double apart = 0;
        for (const auto& [a, b, c] : parts_.triangles) apart += a < b ? b - a : a - b;
        const auto triangles = static_cast<double>(parts_.triangles.size());
        return triangles > kManyTriangles &&
               apart > kScattered * triangles * static_cast<double>(mesh_.points.size());
    }

    /// \return the numbers of the points that triangles use; kNone for others
    std::vector<std::uint32_t> takePoints(bool sorts) {
        std::vector<std::uint32_t> number(mesh_.points.size(), kNone);
        forEach(parts_.triangles.size(), [&](std::size_t t) {
            for (const std::uint32_t v : parts_.triangles[t]) {
                std::atomic_ref(number[v]).store(0, std::memory_order_relaxed);
            }
        });
        const std::size_t count = number.size() - std::count(number.begin(), number.end(), kNone);
        inputPoint_.reserve(count);
        for (std::size_t v = 0; v < number.size(); ++v) {
            if (number[v] != kNone) inputPoint_.push_back(static_cast<std::uint32_t>(v));
        }
        if (sorts) sortPoints();
        assignInHugePages(parts_.points, count);
        forEach(count, [&](std::size_t i) {
            number[inputPoint_[i]] = static_cast<std::uint32_t>(i);
            parts_.points[i] = mesh_.points[inputPoint_[i]] - parts_.origin;
        });
        return number;
    }

    void sortPoints() {
        const BoundingBox box = boundingBox(mesh_);
        std::vector<std::uint32_t> order =
            inMortonOrder(inputPoint_.size(), {box.minimum, box.maximum},
                          [&](std::uint32_t i) { return mesh_.points[inputPoint_[i]]; });
        for (std::uint32_t& i : order) i = inputPoint_[i];
        inputPoint_ = std::move(order);
    }

    /// By their first point.
    void sortTriangles() {
        std::vector<std::uint64_t> keys(parts_.triangles.size());
        forEach(keys.size(), [&](std::size_t t) {
            keys[t] = std::uint64_t{std::ranges::min(parts_.triangles[t])} << 32 | t;
        });
        parallelSort(keys);
        std::vector<MeshParts::Triangle> triangles(keys.size());
        std::vector<std::uint32_t> input(keys.size());
        forEach(keys.size(), [&](std::size_t i) {
            const auto t = static_cast<std::uint32_t>(keys[i]);
            triangles[i] = parts_.triangles[t];
            input[i] = parts_.inputTriangle.empty() ? t : parts_.inputTriangle[t];
        });
        parts_.triangles = std::move(triangles);
        parts_.inputTriangle = std::move(input);
    }

    /// The corner with the smallest number.
    std::uint32_t lowestCorner(std::uint32_t triangle) const {
        const auto& t = parts_.triangles[triangle];
        return static_cast<std::uint32_t>(std::min_element(t.begin(), t.end()) - t.begin());
    }

    /// Of triangles with the same corners, the same way round, all but the first. Those of opposite
    /// ways close the surface together: both stay, as crossing triangles.
    /// \return whether there were any
    bool dropDuplicates() {
        std::vector<std::uint8_t> isGone(parts_.triangles.size(), 0);
        const auto areSame = [](const Spoke& a, const Spoke& b) {
            return a.to == b.to && a.from == b.from;
        };
        const auto drop = [&](const Spoke& spoke) {
            const std::uint32_t t = spoke.leaving / 3;
            // seen from all three corners alike: one of them decides
            if (spoke.leaving == 3 * t + lowestCorner(t)) isGone[t] = 1;
        };
        halfEdges_.forEachFan([&](std::span<const Spoke> spokes) {
            if (spokes.size() <= kFewSpokes) {
                for (std::size_t i = 1; i < spokes.size(); ++i) {
                    const auto isBefore = [&](const Spoke& s) { return areSame(s, spokes[i]); };
                    if (std::ranges::any_of(spokes.first(i), isBefore)) drop(spokes[i]);
                }
                return;
            }
            std::vector<Spoke> sorted(spokes.begin(), spokes.end());
            std::sort(sorted.begin(), sorted.end(), [](const Spoke& a, const Spoke& b) {
                return std::tie(a.to, a.from, a.leaving) < std::tie(b.to, b.from, b.leaving);
            });
            for (std::size_t i = 1; i < sorted.size(); ++i) {
                if (areSame(sorted[i - 1], sorted[i])) drop(sorted[i]);
            }
        });
        parts_.duplicate = std::count(isGone.begin(), isGone.end(), 1);
        if (parts_.duplicate == 0) return false;
        std::vector<std::uint32_t>& input = parts_.inputTriangle;
        if (input.empty()) {
            input.resize(isGone.size());
            std::iota(input.begin(), input.end(), std::uint32_t{0});
        }
        const auto erase = [&](auto& members) {
            std::size_t t = 0;
            std::erase_if(members, [&](const auto&) { return isGone[t++] != 0; });
        };
        erase(parts_.triangles);
        erase(input);
        return true;
    }

    /// Calls f(i) for all numbers below a count, side by side.
    template <class F>
    static void forEach(std::size_t count, const F& f) {
        parallelForPieces(static_cast<std::int64_t>(count), kPartPiece,
                          [&](std::int64_t begin, std::int64_t end) {
                              for (std::int64_t i = begin; i < end; ++i) f(i);
                          });
    }

    /// Edges with more than two triangles, or two that face opposite sides, lose their twins.
    void cutEdges() {
        isCut_.assign(twin_.size(), 0);
        halfEdges_.forEachFan([&](std::span<const Spoke> spokes) {
            if (spokes.size() <= kFewSpokes) {
                for (const Spoke& spoke : spokes) {
                    const auto count = [&](std::uint32_t Spoke::*end) {
                        return std::count_if(spokes.begin(), spokes.end(),
                                             [&](const Spoke& s) { return s.*end == spoke.to; });
                    };
                    isCut_[spoke.leaving] =
                        static_cast<std::uint8_t>(count(&Spoke::to) > 1 || count(&Spoke::from) > 1);
                }
                return;
            }
            std::vector<std::uint32_t> to, from;
            for (const Spoke& spoke : spokes) {
                to.push_back(spoke.to);
                from.push_back(spoke.from);
            }
            std::sort(to.begin(), to.end());
            std::sort(from.begin(), from.end());
            const auto isMultiple = [](const std::vector<std::uint32_t>& ends, std::uint32_t v) {
                const auto [first, last] = std::equal_range(ends.begin(), ends.end(), v);
                return last - first > 1;
            };
            for (const Spoke& spoke : spokes) {
                isCut_[spoke.leaving] = static_cast<std::uint8_t>(isMultiple(to, spoke.to) ||
                                                                  isMultiple(from, spoke.to));
            }
        });
        for (std::uint32_t h = 0; h < twin_.size(); ++h) {
            if (isCut_[h] != 0) {
                twin_[h] = kNone;
            } else if (twin_[h] == kNone) {
                parts_.borderEdges.push_back(h);
            }
        }
    }

    /// How many triangles the fan of h has, which starts at the point.
    std::size_t fanSize(std::uint32_t h) const {
        std::size_t count = 0;
        std::uint32_t g = h;
        do {
            ++count;
            g = twin_[previous(g)];
        } while (g != kNone && g != h);
        if (g == h) return count;
        for (g = twin_[h]; g != kNone; g = twin_[g]) {
            ++count;
            g = next(g);
        }
        return count;
    }

    /// Points at cut edges, and those that join several fans, become one point for each fan.
    void cutPoints() {
        const auto count = static_cast<std::int64_t>(parts_.points.size());
        std::vector<std::uint8_t> isSingular(parts_.points.size(), 0);
        parallelForPieces(count, kPartPiece, [&](std::int64_t begin, std::int64_t end) {
            for (auto v = static_cast<std::uint32_t>(begin); v < end; ++v) {
                const auto leaving = halfEdges_.from(v);
                bool isWhole = fanSize(leaving.front()) == leaving.size();
                for (const std::uint32_t h : leaving) {
                    isWhole = isWhole && isCut_[h] == 0 && isCut_[previous(h)] == 0;
                }
                isSingular[v] = static_cast<std::uint8_t>(!isWhole);
            }
        });
        for (std::uint32_t v = 0; v < count; ++v) {
            if (isSingular[v] == 0) continue;
            parts_.nonManifold.push_back(inputPoint_[v]);
            split(v, Patch::kBorder + static_cast<std::uint32_t>(parts_.nonManifold.size()));
        }
    }

    void split(std::uint32_t v, std::uint32_t mark) {
        std::unordered_set<std::uint32_t> isTaken;
        bool isFirst = true;
        for (const std::uint32_t start : halfEdges_.from(v)) {
            if (!isTaken.insert(start).second) continue;
            std::uint32_t number = v;
            if (!isFirst) {
                number = static_cast<std::uint32_t>(parts_.points.size());
                parts_.points.push_back(parts_.points[v]);
            }
            isFirst = false;
            keep(number);
            parts_.marks.resize(parts_.points.size(), Patch::kPlain);
            parts_.marks[number] = mark;
            std::vector<std::uint32_t> fan{start};
            for (std::size_t i = 0; i < fan.size(); ++i) {
                const std::uint32_t after = twin_[previous(fan[i])];
                const std::uint32_t twin = twin_[fan[i]];
                for (const std::uint32_t g : {after, twin == kNone ? kNone : next(twin)}) {
                    if (g != kNone && isTaken.insert(g).second) fan.push_back(g);
                }
            }
            for (const std::uint32_t h : fan) {
                parts_.triangles[h / 3][h % 3] = number;
            }
        }
    }

    void keep(std::uint32_t v) {
        parts_.isKept.resize(parts_.points.size(), 0);
        parts_.isKept[v] = 1;
    }

    void keepCrossings() {
        for (const auto* const triangles : {&parts_.crossing.found, &parts_.crossing.undecided}) {
            for (const std::int64_t t : *triangles) {
                for (const std::uint32_t v : parts_.triangles[t]) keep(v);
            }
        }
        if (!parts_.isKept.empty()) parts_.isKept.resize(parts_.points.size(), 0);
        if (!parts_.marks.empty()) parts_.marks.resize(parts_.points.size(), Patch::kPlain);
    }

    const TriangleMesh& mesh_;
    bool keepsBorders_;
    double mayMoveMm_;
    MeshParts parts_;
    std::vector<std::uint32_t> inputPoint_;  ///< of each point
    HalfEdges<std::uint32_t> halfEdges_;
    std::vector<std::uint32_t> twin_;
    std::vector<std::uint8_t> isCut_;  ///< of each half-edge
};

}  // namespace

MeshParts takeApart(const TriangleMesh& mesh, bool keepsBorders, double mayMoveMm) {
    requireSimplifiable(mesh);
    return Cutter(mesh, keepsBorders, mayMoveMm).run();
}

}  // namespace adaptiso::detail
