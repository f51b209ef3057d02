#include "Support/Soundness.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <ostream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace adaptiso::testing {
namespace {

constexpr int kShownOfEachKind = 4;
constexpr double kMinAltitude = 1e-9;      // of the longest edge: rounding alone leaves 1e-12 or so
constexpr double kBorderTolerance = 1e-6;  // of an index
constexpr double kNormalTolerance = 1e-5;  // normals are float

/// Complaints, counted by kind; keeps the first few of each.
class Findings {
public:
    template <class Describe>
    void add(const std::string& kind, const Describe& describe) {
        Kind& entry = kinds_[kind];
        if (entry.count++ >= kShownOfEachKind) return;
        std::ostringstream text;
        text.precision(9);
        describe(text);
        entry.shown.push_back(text.str());
    }

    ::testing::AssertionResult result(const TriangleMesh& mesh) const {
        if (kinds_.empty()) return ::testing::AssertionSuccess();
        auto failure = ::testing::AssertionFailure();
        failure << "mesh of " << mesh.points.size() << " points and " << mesh.triangles.size()
                << " triangles is not sound:";
        for (const auto& [kind, entry] : kinds_) {
            failure << "\n  " << entry.count << " x " << kind;
            for (const std::string& text : entry.shown) failure << "\n      " << text;
        }
        return failure;
    }

private:
    struct Kind {
        std::size_t count = 0;
        std::vector<std::string> shown;
    };
    std::map<std::string, Kind> kinds_;
};

struct Point {
    const TriangleMesh& mesh;
    VertexId id;
};
std::ostream& operator<<(std::ostream& out, const Point& point) {
    const Vec3& p = point.mesh.points[point.id];
    return out << point.id << " (" << p.x << ", " << p.y << ", " << p.z << ")";
}

/// False when indices out of range would make every further look at the mesh unsafe.
bool checkIndices(const TriangleMesh& mesh, Findings& findings) {
    const auto count = static_cast<VertexId>(mesh.points.size());
    bool isSafe = true;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        for (const VertexId v : mesh.triangles[t]) {
            if (v >= 0 && v < count) continue;
            isSafe = false;
            findings.add("index out of range", [&](std::ostream& out) {
                out << "triangle " << t << " names vertex " << v;
            });
        }
    }
    return isSafe;
}

void checkPoints(const TriangleMesh& mesh, Findings& findings) {
    std::vector<bool> isUsed(mesh.points.size());
    for (const Triangle& triangle : mesh.triangles) {
        for (const VertexId v : triangle) isUsed[v] = true;
    }
    for (std::size_t v = 0; v < mesh.points.size(); ++v) {
        const Point point{mesh, static_cast<VertexId>(v)};
        if (!isUsed[v]) {
            findings.add("unused vertex", [&](std::ostream& out) { out << "vertex " << point; });
        }
        if (!isFinite(mesh.points[v])) {
            findings.add("non-finite vertex",
                         [&](std::ostream& out) { out << "vertex " << point; });
        }
    }
    if (!mesh.normals.empty() && mesh.normals.size() != mesh.points.size()) {
        findings.add("wrong number of normals",
                     [&](std::ostream& out) { out << mesh.normals.size(); });
        return;
    }
    for (std::size_t v = 0; v < mesh.normals.size(); ++v) {
        const double length = norm(toVec3(mesh.normals[v]));
        if (std::abs(length - 1) <= kNormalTolerance) continue;
        findings.add("normal not of length 1", [&](std::ostream& out) {
            out << "vertex " << Point{mesh, static_cast<VertexId>(v)} << ": length " << length;
        });
    }
}

bool hasNoArea(const Vec3& a, const Vec3& b, const Vec3& c) {
    const double longest2 = std::max({squaredNorm(b - a), squaredNorm(c - b), squaredNorm(a - c)});
    return norm(areaVector2(a, b, c)) <= kMinAltitude * longest2;
}

void checkTriangles(const TriangleMesh& mesh, Findings& findings) {
    std::vector<std::pair<Triangle, std::size_t>> sorted;
    sorted.reserve(mesh.triangles.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto& corners = mesh.triangles[t];
        const VertexId a = corners[0], b = corners[1], c = corners[2];
        if (hasNoArea(mesh.points[a], mesh.points[b], mesh.points[c])) {
            findings.add("triangle without area", [&](std::ostream& out) {
                out << "triangle " << t << ": " << Point{mesh, a} << ", " << Point{mesh, b} << ", "
                    << Point{mesh, c};
            });
        }
        Triangle key = mesh.triangles[t];
        std::sort(key.begin(), key.end());
        sorted.emplace_back(key, t);
    }
    std::sort(sorted.begin(), sorted.end());
    for (std::size_t n = 1; n < sorted.size(); ++n) {
        if (sorted[n].first != sorted[n - 1].first) continue;
        findings.add("duplicate triangle", [&](std::ostream& out) {
            out << "triangles " << sorted[n - 1].second << " and " << sorted[n].second;
        });
    }
}

/// Both ends on one border face of the volume.
bool isOnBorder(const Vec3& a, const Vec3& b, const ImageGeometry& geometry) {
    const Vec3 indexA = geometry.toIndex(a), indexB = geometry.toIndex(b);
    for (int axis = 0; axis < 3; ++axis) {
        for (const double face : {0.0, static_cast<double>(geometry.size[axis] - 1)}) {
            if (std::abs(indexA[axis] - face) <= kBorderTolerance &&
                std::abs(indexB[axis] - face) <= kBorderTolerance) {
                return true;
            }
        }
    }
    return false;
}

struct HalfEdge {
    VertexId low, high;
    bool isForward;  ///< the triangle runs from low to high
};

void checkEdges(const TriangleMesh& mesh, const SoundnessOptions& options, Findings& findings) {
    std::vector<HalfEdge> halves;
    halves.reserve(3 * mesh.triangles.size());
    for (const Triangle& t : mesh.triangles) {
        for (int side = 0; side < 3; ++side) {
            const VertexId from = t[side], to = t[(side + 1) % 3];
            halves.push_back({std::min(from, to), std::max(from, to), from < to});
        }
    }
    std::sort(halves.begin(), halves.end(), [](const HalfEdge& a, const HalfEdge& b) {
        return std::pair(a.low, a.high) < std::pair(b.low, b.high);
    });
    for (auto first = halves.begin(); first != halves.end();) {
        const auto last = std::find_if(first, halves.end(), [&](const HalfEdge& half) {
            return half.low != first->low || half.high != first->high;
        });
        const auto complain = [&](const std::string& kind) {
            findings.add(kind, [&](std::ostream& out) {
                out << "edge " << Point{mesh, first->low} << " - " << Point{mesh, first->high};
            });
        };
        const auto count = last - first;
        if (count > 2) complain("edge in more than two triangles");
        if (count == 2 && first->isForward == first[1].isForward) {
            complain("edge whose triangles run the same way");
        }
        if (count == 1 && !options.openAtBorderOf) complain("boundary edge");
        if (count == 1 && options.openAtBorderOf &&
            !isOnBorder(mesh.points[first->low], mesh.points[first->high],
                        *options.openAtBorderOf)) {
            complain("boundary edge off the volume's border");
        }
        first = last;
    }
}

/// Opposite sides of the triangles round one vertex, as undirected edges.
using Link = std::vector<std::pair<VertexId, VertexId>>;

/// One path or one cycle: connected, and no corner in more than two edges.
bool isOneFan(const Link& link) {
    std::map<VertexId, std::vector<VertexId>> neighbours;
    for (const auto& [a, b] : link) {
        neighbours[a].push_back(b);
        neighbours[b].push_back(a);
    }
    std::vector<VertexId> stack{link.front().first};
    std::map<VertexId, bool> isSeen{{stack.back(), true}};
    while (!stack.empty()) {
        const VertexId at = stack.back();
        stack.pop_back();
        if (neighbours[at].size() > 2) return false;
        for (const VertexId next : neighbours[at]) {
            if (isSeen.try_emplace(next, true).second) stack.push_back(next);
        }
    }
    return isSeen.size() == neighbours.size();
}

void checkVertices(const TriangleMesh& mesh, Findings& findings) {
    std::vector<Link> links(mesh.points.size());
    for (const Triangle& t : mesh.triangles) {
        for (int corner = 0; corner < 3; ++corner) {
            links[t[corner]].emplace_back(t[(corner + 1) % 3], t[(corner + 2) % 3]);
        }
    }
    for (std::size_t v = 0; v < links.size(); ++v) {
        if (links[v].empty() || isOneFan(links[v])) continue;
        findings.add("vertex whose triangles are not one fan", [&](std::ostream& out) {
            out << "vertex " << Point{mesh, static_cast<VertexId>(v)} << ", " << links[v].size()
                << " triangles";
        });
    }
}

/// A connected piece, and which others lie around it.
struct Piece {
    double volume6 = 0, area2 = 0;
    bool isOpen = false;
    Vec3 start;
    std::vector<std::size_t> around;  ///< ascending
};

class Pieces {
public:
    explicit Pieces(const TriangleMesh& mesh) : mesh_(mesh), pieceOf_(mesh.points.size(), kNone) {
        std::vector<std::vector<std::size_t>> trianglesAt(mesh.points.size());
        std::map<std::pair<VertexId, VertexId>, int> sides;
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
            const Triangle& c = mesh.triangles[t];
            for (int side = 0; side < 3; ++side) {
                const auto [low, high] = std::minmax(c[side], c[(side + 1) % 3]);
                ++sides[{low, high}];
                trianglesAt[c[side]].push_back(t);
            }
        }
        for (const Triangle& t : mesh.triangles) {
            if (pieceOf_[t[0]] == kNone) flood(t, trianglesAt);
        }
        for (const auto& [side, count] : sides) {
            if (count == 1) pieces[pieceOf_[side.first]].isOpen = true;
        }
        for (const Triangle& t : mesh.triangles) addUp(t);
    }

    /// Finds what lies around what.
    void nest(bool opensHold) {
        for (std::size_t n = 0; n < pieces.size(); ++n) {
            std::map<std::size_t, int> passed;
            for (const Triangle& t : mesh_.triangles) {
                const std::size_t piece = pieceOf_[t[0]];
                if (piece == n || (pieces[piece].isOpen && !opensHold)) continue;
                if (isAbove(t, pieces[n].start)) ++passed[piece];
            }
            for (const auto& [piece, times] : passed) {
                if (times % 2 == 1) pieces[n].around.push_back(piece);
            }
        }
    }

    std::vector<Piece> pieces;

private:
    static constexpr std::size_t kNone = ~std::size_t{0};

    void flood(const Triangle& first, const std::vector<std::vector<std::size_t>>& trianglesAt) {
        const std::size_t number = pieces.size();
        Piece& piece = pieces.emplace_back();
        piece.start =
            (1.0 / 3) * (mesh_.points[first[0]] + mesh_.points[first[1]] + mesh_.points[first[2]]);
        std::vector<VertexId> open{first[0]};
        pieceOf_[first[0]] = number;
        while (!open.empty()) {
            const VertexId at = open.back();
            open.pop_back();
            for (const std::size_t t : trianglesAt[at]) {
                for (const VertexId v : mesh_.triangles[t]) {
                    if (pieceOf_[v] != kNone) continue;
                    pieceOf_[v] = number;
                    open.push_back(v);
                }
            }
        }
    }
    void addUp(const Triangle& t) {
        Piece& piece = pieces[pieceOf_[t[0]]];
        const Vec3 a = mesh_.points[t[0]] - piece.start, b = mesh_.points[t[1]] - piece.start,
                   c = mesh_.points[t[2]] - piece.start;
        piece.volume6 += dot(a, cross(b, c));
        piece.area2 += norm(cross(b - a, c - a));
    }
    /// The line upwards from `start` passes the triangle.
    bool isAbove(const Triangle& t, const Vec3& start) const {
        std::array<Vec3, 3> at;  // seen from the start, sheared so that the line is the z axis
        for (int c = 0; c < 3; ++c) {
            const Vec3 p = mesh_.points[t[c]] - start;
            at[c] = {p.x - 0.0012345 * p.z, p.y + 0.0023456 * p.z, p.z};
        }
        const auto side = [&](int c) {
            const Vec3 &a = at[c], &b = at[(c + 1) % 3];
            return a.x * b.y - a.y * b.x;
        };
        const double u = side(1), v = side(2), w = side(0);
        if (!((u > 0) == (v > 0) && (v > 0) == (w > 0))) return false;
        return (u * at[0].z + v * at[1].z + w * at[2].z) / (u + v + w) > 0;
    }

    const TriangleMesh& mesh_;
    std::vector<std::size_t> pieceOf_;
};

std::string bracketsOf(const std::vector<Piece>& pieces, std::size_t n) {
    const Piece& piece = pieces[n];
    if (piece.isOpen) return "|";
    std::vector<std::string> within;
    for (std::size_t m = 0; m < pieces.size(); ++m) {
        const std::vector<std::size_t>& around = pieces[m].around;
        const bool isChild = around.size() == piece.around.size() + 1 &&
                             std::find(around.begin(), around.end(), n) != around.end();
        if (isChild) within.push_back(bracketsOf(pieces, m));
    }
    std::sort(within.begin(), within.end());
    const bool isFlat = std::abs(piece.volume6) < 1e-9 * std::pow(piece.area2, 1.5);
    const char* brackets = isFlat ? "<>" : piece.volume6 > 0 ? "()" : "[]";
    std::string text(1, brackets[0]);
    for (const std::string& one : within) text += one;
    return text + brackets[1];
}

}  // namespace

std::string nestingOf(const TriangleMesh& mesh, bool opensHold) {
    Pieces found(mesh);
    found.nest(opensHold);
    std::vector<std::string> outermost;
    for (std::size_t n = 0; n < found.pieces.size(); ++n) {
        // a sheet holds the piece, and is none of the brackets around it
        const auto& around = found.pieces[n].around;
        const auto opens = std::count_if(around.begin(), around.end(),
                                         [&](std::size_t m) { return found.pieces[m].isOpen; });
        if (std::ssize(around) == opens) {
            outermost.push_back(std::string(static_cast<std::size_t>(opens), '_') +
                                bracketsOf(found.pieces, n));
        }
    }
    std::sort(outermost.begin(), outermost.end());
    std::string text;
    for (const std::string& one : outermost) text += one;
    return text;
}

SoundnessOptions openOnlyAtBorder(const ImageGeometry& geometry) {
    return {.openAtBorderOf = geometry};
}

::testing::AssertionResult isSound(const TriangleMesh& mesh, const SoundnessOptions& options) {
    Findings findings;
    if (checkIndices(mesh, findings)) {
        checkPoints(mesh, findings);
        checkTriangles(mesh, findings);
        checkEdges(mesh, options, findings);
        checkVertices(mesh, findings);
        if (options.nesting && nestingOf(mesh) != *options.nesting) {
            findings.add("pieces nest otherwise", [&](std::ostream& out) {
                out << nestingOf(mesh) << ", not " << *options.nesting;
            });
        }
    }
    return findings.result(mesh);
}

void expectSound(const TriangleMesh& mesh, const SoundnessOptions& options, const char* file,
                 int line) {
    const ::testing::AssertionResult result = isSound(mesh, options);
    if (!result) ADD_FAILURE_AT(file, line) << result.message();
}

}  // namespace adaptiso::testing
