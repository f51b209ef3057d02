#include "adaptiso/SurfacePipeline/StoredMesh.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <vector>

#include "adaptiso/Core/Parallel.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"
#include "adaptiso/MeshQuality/Topology.h"

namespace adaptiso {
namespace {

constexpr std::size_t kMostTroubles = 300;  ///< more come of a mesh too fine for its coordinates
constexpr int kMostPasses = 4;

double toNineDigits(double value) {
    std::array<char, 32> text{};
    const auto [end, error] =
        std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, 9);
    double read = value;
    if (error == std::errc{}) std::from_chars(text.data(), end, read);
    return read;
}

double stored(double value, CoordinatePrecision precision) {
    if (precision == CoordinatePrecision::NineDigits) return toNineDigits(value);
    const volatile float rounded = static_cast<float>(value);  // as Stl.cxx has it
    return rounded;
}

/// The coordinate before or after that a file can hold.
double neighbour(double value, int side, CoordinatePrecision precision) {
    if (precision == CoordinatePrecision::NineDigits) {
        const double last = std::pow(10.0, std::floor(std::log10(std::abs(value))) - 8);
        return value == 0 ? value : toNineDigits(value + side * last);
    }
    constexpr float kFar = std::numeric_limits<float>::max();
    return std::nextafter(static_cast<float>(value), static_cast<float>(side) * kFar);
}

bool areSame(const TriangleMesh& mesh, const TriangleMesh& file, VertexId a, VertexId b) {
    return file.points[a] == file.points[b] && mesh.points[a] != mesh.points[b];
}

/// Compares a mesh with the same mesh as a file holds it.
class Settling {
public:
    /// \param exact  in the file's frame
    Settling(TriangleMesh exact, CoordinatePrecision precision)
        : exact_(std::move(exact)), precision_(precision), file_{{}, {}, exact_.triangles} {
        file_.points.resize(exact_.points.size());
        constexpr std::int64_t kPiece = 1 << 12;
        parallelForPieces(std::ssize(file_.points), kPiece,
                          [&](std::int64_t begin, std::int64_t end) {
                              for (std::int64_t v = begin; v < end; ++v) {
                                  for (int a = 0; a < 3; ++a) {
                                      file_.points[v][a] = stored(exact_.points[v][a], precision_);
                                  }
                              }
                          });
    }

    /// Moves vertices. \return what could not be helped
    RoundingHarm run() {
        Troubles troubles = find();
        for (int pass = 0; pass < kMostPasses && isWorthATry(troubles); ++pass) {
            bool isMoved = false;
            for (const std::int64_t t : troubles.flat) isMoved = mendFlat(t) || isMoved;
            for (const auto& points : troubles.merged) isMoved = mendMerged(points) || isMoved;
            for (const TrianglePair& pair : troubles.crossing) isMoved = mendPair(pair) || isMoved;
            if (!isMoved) break;
            troubles = find();
        }
        RoundingHarm harm;
        harm.flatTriangles = std::ssize(troubles.flat);
        harm.mergedPoints = std::ssize(troubles.merged);
        harm.crossingPairs = std::ssize(troubles.crossing);
        return harm;
    }

    const TriangleMesh& file() const { return file_; }

    /// Vertices that lie elsewhere than rounding puts them, with their places in the file.
    const std::vector<VertexId>& moved() const { return moved_; }
    const Vec3& at(VertexId v) const { return file_.points[v]; }

private:
    /// Defects of the file that the mesh has not.
    struct Troubles {
        std::vector<std::int64_t> flat;               ///< triangles
        std::vector<std::array<VertexId, 2>> merged;  ///< points at one place
        std::vector<TrianglePair> crossing;
    };

    /// Where more than a hundredth of the surface lies on itself its details are finer than what
    /// the file can hold: no steps of that size mend it.
    bool isWorthATry(const Troubles& troubles) const {
        const std::size_t lost = troubles.flat.size() + troubles.merged.size(),
                          count = lost + troubles.crossing.size();
        return count > 0 && count <= kMostTroubles && 100 * lost <= file_.triangles.size();
    }

    Troubles find() const {
        Troubles troubles;
        for (std::size_t t = 0; t < exact_.triangles.size(); ++t) {
            const Triangle& corners = exact_.triangles[t];
            if (isDegenerate(file_, corners) && !isDegenerate(exact_, corners)) {
                troubles.flat.push_back(static_cast<std::int64_t>(t));
            }
        }
        troubles.merged = mergedPoints();
        constexpr std::int64_t kMostNamed = 100000;
        troubles.crossing = findSelfIntersections(file_, {.maxPairs = kMostNamed}).pairs;
        std::erase_if(troubles.crossing, [&](const TrianglePair& pair) {
            return trianglesCross(cornersOf(exact_, pair[0]), cornersOf(exact_, pair[1]));
        });
        return troubles;
    }

    std::vector<std::array<VertexId, 2>> mergedPoints() const {
        std::vector<VertexId> order(file_.points.size());
        for (std::size_t v = 0; v < order.size(); ++v) order[v] = static_cast<VertexId>(v);
        const auto key = [&](VertexId v) {
            const Vec3& p = file_.points[v];
            return std::array{p.x, p.y, p.z};
        };
        std::sort(order.begin(), order.end(), [&](VertexId a, VertexId b) {
            return key(a) != key(b) ? key(a) < key(b) : a < b;
        });
        std::vector<std::array<VertexId, 2>> merged;
        for (std::size_t i = 1; i < order.size(); ++i) {
            if (areSame(exact_, file_, order[i - 1], order[i])) {
                merged.push_back({order[i - 1], order[i]});
            }
        }
        return merged;
    }

    bool mendFlat(std::int64_t triangle) {
        const Triangle& corners = file_.triangles[triangle];
        return isDegenerate(file_, corners) && moveOneOf({corners.begin(), corners.end()});
    }

    bool mendMerged(const std::array<VertexId, 2>& points) {
        return areSame(exact_, file_, points[0], points[1]) &&
               moveOneOf({points.begin(), points.end()});
    }

    bool mendPair(const TrianglePair& pair) {
        if (!trianglesCross(cornersOf(file_, pair[0]), cornersOf(file_, pair[1]))) return false;
        std::vector<VertexId> corners;
        for (const std::int64_t t : pair) {
            corners.insert(corners.end(), file_.triangles[t].begin(), file_.triangles[t].end());
        }
        std::sort(corners.begin(), corners.end());
        corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
        return moveOneOf(corners);
    }

    bool moveOneOf(const std::vector<VertexId>& points) {
        return std::any_of(points.begin(), points.end(), [&](VertexId v) { return move(v); });
    }

    /// Moves a vertex, if that leaves less harm.
    bool move(VertexId v) {
        std::vector<std::int64_t> star, near;
        listAround(v, star, near);
        constexpr std::size_t kMostPairs = 1 << 20;  // a vertex of thousands of triangles stays
        if (star.size() * near.size() > kMostPairs) return false;
        std::int64_t least = harmOf(v, star, near);
        const Vec3 before = file_.points[v];
        Vec3 best = before;
        for (int n = 0; n < 27; ++n) {
            const std::array<int, 3> side{n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
            Vec3& place = file_.points[v];
            place = before;
            for (int a = 0; a < 3; ++a) {
                if (side[a] != 0) place[a] = neighbour(before[a], side[a], precision_);
            }
            const Vec3 off = place - exact_.points[v];
            if (!(norm(off) <= kFarthest * ulpAt(v))) continue;
            const std::int64_t harm = harmOf(v, star, near);
            if (harm >= least) continue;
            least = harm;
            best = place;
        }
        file_.points[v] = best;
        if (best == before) return false;
        moved_.push_back(v);
        return true;
    }

    /// Largest distance between neighbouring coordinates there.
    double ulpAt(VertexId v) const {
        double most = 0;
        for (int a = 0; a < 3; ++a) {
            const double value = file_.points[v][a];
            most = std::max(most, std::abs(neighbour(value, 1, precision_) - value));
        }
        return most;
    }

    /// The triangles at a vertex, and those that they may come near.
    void listAround(VertexId v, std::vector<std::int64_t>& star, std::vector<std::int64_t>& near) {
        BoundingBox box{file_.points[v], file_.points[v]};
        const auto isAt = [&](const Triangle& t) { return t[0] == v || t[1] == v || t[2] == v; };
        for (std::size_t t = 0; t < file_.triangles.size(); ++t) {
            if (!isAt(file_.triangles[t])) continue;
            star.push_back(static_cast<std::int64_t>(t));
            for (const Vec3& p : cornersOf(file_, star.back())) box.add(p);
        }
        const double more = (1 + kFarthest) * ulpAt(v);
        for (std::int64_t t = 0; t < std::ssize(file_.triangles); ++t) {
            const Corners c = cornersOf(file_, t);
            bool isNear = true;
            for (int a = 0; a < 3 && isNear; ++a) {
                isNear = std::max({c[0][a], c[1][a], c[2][a]}) >= box.minimum[a] - more &&
                         std::min({c[0][a], c[1][a], c[2][a]}) <= box.maximum[a] + more;
            }
            if (isNear) near.push_back(t);
        }
    }

    /// Crossing pairs among a vertex's triangles, and more than any number of them where the
    /// vertex lies on another, and again where a triangle has no area.
    std::int64_t harmOf(VertexId v, const std::vector<std::int64_t>& star,
                        const std::vector<std::int64_t>& near) const {
        constexpr std::int64_t kFlat = 1 << 20, kMerged = 1 << 10;
        std::int64_t harm = 0;
        for (const std::int64_t s : star) {
            if (isDegenerate(file_, file_.triangles[s])) harm += kFlat;
            for (const std::int64_t t : near) {
                const bool isCounted = std::find(star.begin(), star.end(), t) != star.end();
                if (t == s || (isCounted && t < s)) continue;
                if (trianglesCross(cornersOf(file_, s), cornersOf(file_, t))) ++harm;
            }
        }
        for (const std::int64_t t : near) {
            const Triangle& corners = file_.triangles[t];
            harm += kMerged * std::count_if(corners.begin(), corners.end(), [&](VertexId w) {
                        return w != v && areSame(exact_, file_, v, w);
                    });
        }
        return harm;
    }

    static constexpr double kFarthest = 3;  ///< of a moved vertex, units in the last place

    TriangleMesh exact_;
    CoordinatePrecision precision_;
    TriangleMesh file_;
    std::vector<VertexId> moved_;
};

/// The digits that a format keeps, and the formats that hold more.
std::string digitsOf(const MeshFormat& format) {
    return std::string(format.name) + " keeps " +
           (format.precision == CoordinatePrecision::Float32 ? "24 bits" : "nine digits") +
           " of a coordinate: ";
}

constexpr const char* kInstead = "; write a .vtp or .ply, or move the image nearer to the origin";

/// The longest way from a point of `mesh` to where `file` has it, `back` taking it there.
double longestMove(const TriangleMesh& mesh, const TriangleMesh& file,
                   const AffineTransform& back) {
    double longest = 0;
    for (std::size_t v = 0; v < mesh.points.size(); ++v) {
        longest = std::max(longest, squaredNorm(back(file.points[v]) - mesh.points[v]));
    }
    return std::sqrt(longest);
}

}  // namespace

RoundingHarm settleRounding(TriangleMesh& mesh, CoordinatePrecision precision,
                            const AffineTransform& toFrame) {
    if (precision == CoordinatePrecision::Float64) return {};
    TriangleMesh bare{mesh.points, {}, mesh.triangles};
    Settling settling(transformed(bare, toFrame), precision);
    RoundingHarm harm = settling.run();
    const AffineTransform back = inverse(toFrame);
    harm.roundingMm = longestMove(mesh, settling.file(), back);
    for (const VertexId v : settling.moved()) mesh.points[v] = back(settling.at(v));
    harm.movedPoints = std::ssize(settling.moved());
    return harm;
}

TriangleMesh asStored(const TriangleMesh& mesh, CoordinatePrecision precision,
                      const AffineTransform& toFrame) {
    TriangleMesh file{mesh.points, {}, mesh.triangles};
    if (precision == CoordinatePrecision::Float64) return file;
    const AffineTransform back = inverse(toFrame);
    for (Vec3& p : file.points) {
        Vec3 q = toFrame(p);
        for (int a = 0; a < 3; ++a) q[a] = stored(q[a], precision);
        p = back(q);
    }
    return file;
}

std::optional<std::string> roundingFault(double roundingMm, double boundMm,
                                         const MeshFormat& format) {
    if (roundingMm < boundMm) return std::nullopt;
    return digitsOf(format) + "points would move by up to " + formatShort(roundingMm) +
           " mm, more than the bound of " + formatShort(boundMm) + " mm" + kInstead;
}

std::optional<Warning> roundingWarning(const std::string& file, double boundMm, double requestedMm,
                                       double roundingMm, const MeshFormat& format) {
    constexpr double kNoticed = 0.01;
    if (!(boundMm > requestedMm && roundingMm > kNoticed * requestedMm)) return std::nullopt;
    return Warning{"bound-exceeded",
                   "lies within " + formatBound(boundMm) + " mm, not " + formatShort(requestedMm) +
                       " mm: " + digitsOf(format) + "points move by up to " +
                       formatShort(roundingMm) + " mm" + kInstead,
                   file};
}

std::string textOf(const RoundingHarm& harm, const MeshFormat& format) {
    std::string what;
    const auto add = [&](std::int64_t count, const char* text) {
        if (count == 0) return;
        addPart(what, formatCount(count) + text);
    };
    add(harm.flatTriangles, " triangles would lose their area");
    add(harm.mergedPoints, " vertices would lie on another");
    add(harm.crossingPairs, " pairs of triangles would cross");
    return digitsOf(format) + what + kInstead;
}

}  // namespace adaptiso
