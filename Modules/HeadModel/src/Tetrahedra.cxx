#include "adaptiso/HeadModel/Tetrahedra.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/MeshIO/PointNormals.h"

namespace adaptiso {
namespace {

std::string text(double value) {
    std::array<char, 40> digits;
    return {digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr};
}

std::string text(std::int64_t value) {
    return std::to_string(value);
}

/// A point just within or outside of a surface, at a vertex.
Vec3 beside(const TriangleMesh& surface, double outwardMm) {
    const std::vector<Normal> normals = areaWeightedNormals(surface);
    return surface.points.front() + outwardMm * toVec3(normals.front());
}

/// Numbers between white space; lines that begin with '#' are passed over.
class Words {
public:
    Words(std::string_view bytes, std::string_view name) : bytes_(bytes), name_(name) {}

    std::string_view next() {
        for (;;) {
            while (at_ < bytes_.size() && isSpace(bytes_[at_])) ++at_;
            if (at_ >= bytes_.size() || bytes_[at_] != '#') break;
            at_ = std::min(bytes_.find('\n', at_), bytes_.size());
        }
        const std::size_t begin = at_;
        while (at_ < bytes_.size() && !isSpace(bytes_[at_])) ++at_;
        return bytes_.substr(begin, at_ - begin);
    }
    template <class Number>
    Number number() {
        const std::string_view word = next();
        Number value{};
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
        if (error != std::errc() || end != word.data() + word.size()) {
            fail("a number is due where there is '" + std::string(word.substr(0, 20)) + "'");
        }
        return value;
    }
    /// A number of things of which each takes two bytes or more.
    std::int64_t count() {
        const auto value = number<std::int64_t>();
        if (value < 0 || static_cast<std::uint64_t>(value) > bytes_.size() / 2) {
            fail("it says it holds " + std::to_string(value) + " things");
        }
        return value;
    }
    void skipTo(std::string_view word) {
        for (std::string_view found = next(); found != word; found = next()) {
            if (found.empty()) fail("it lacks " + std::string(word));
        }
    }
    [[noreturn]] void fail(const std::string& what) const {
        throw FileError(std::string(name_) + ": " + what);
    }

private:
    static bool isSpace(char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t'; }

    std::string_view bytes_, name_;
    std::size_t at_ = 0;
};

double volumeOf(const TetrahedralMesh& mesh, const std::array<VertexId, 4>& t) {
    const Vec3& a = mesh.points[t[0]];
    return dot(cross(mesh.points[t[1]] - a, mesh.points[t[2]] - a), mesh.points[t[3]] - a) / 6;
}

void turnNegative(TetrahedralMesh& mesh) {
    for (auto& t : mesh.tetrahedra) {
        if (volumeOf(mesh, t) < 0) std::swap(t[2], t[3]);
    }
}

void requireInRange(const TetrahedralMesh& mesh, const Words& words) {
    for (const auto& t : mesh.tetrahedra) {
        for (const VertexId v : t) {
            if (v < 0 || v >= std::ssize(mesh.points))
                words.fail("an element names a missing point");
        }
    }
}

/// The least angle between two faces of an element, degrees.
double leastDihedralDeg(const TetrahedralMesh& mesh, const std::array<VertexId, 4>& t) {
    std::array<Vec3, 4> outward;
    for (int n = 0; n < 4; ++n) {
        const Vec3 &a = mesh.points[t[(n + 1) % 4]], &b = mesh.points[t[(n + 2) % 4]],
                   &c = mesh.points[t[(n + 3) % 4]];
        Vec3 normal = cross(b - a, c - a);
        if (dot(normal, mesh.points[t[n]] - a) > 0) normal = -normal;
        outward[n] = normalized(normal);
    }
    double least = 180;
    for (int m = 0; m < 4; ++m) {
        for (int n = m + 1; n < 4; ++n) {
            const double cosine = std::clamp(-dot(outward[m], outward[n]), -1.0, 1.0);
            least = std::min(least, std::acos(cosine) * 180 / std::numbers::pi);
        }
    }
    return least;
}

double radiusEdge(const TetrahedralMesh& mesh, const std::array<VertexId, 4>& t) {
    const Vec3& o = mesh.points[t[0]];
    const Vec3 a = mesh.points[t[1]] - o, b = mesh.points[t[2]] - o, c = mesh.points[t[3]] - o;
    const Vec3 sum =
        squaredNorm(a) * cross(b, c) + squaredNorm(b) * cross(c, a) + squaredNorm(c) * cross(a, b);
    const double radius = norm(sum) / (2 * std::abs(dot(a, cross(b, c))));
    double shortest = std::numeric_limits<double>::infinity();
    for (int m = 0; m < 4; ++m) {
        for (int n = m + 1; n < 4; ++n) {
            shortest = std::min(shortest, norm(mesh.points[t[m]] - mesh.points[t[n]]));
        }
    }
    return radius / shortest;
}

double rankOf(std::vector<double>& values, double share) {
    const auto at = values.begin() +
                    static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

}  // namespace

std::int32_t tissueNumber(HeadSurface surface, std::size_t count) {
    constexpr std::int32_t kBrain = 2, kCsf = 3, kSkull = 4, kScalp = 5;
    switch (surface) {
        case HeadSurface::Brain:
            return kBrain;
        case HeadSurface::InnerSkull:
            return count == kHeadSurfaceCount ? kCsf : kBrain;
        case HeadSurface::OuterSkull:
            return kSkull;
        case HeadSurface::OuterSkin:
            return kScalp;
    }
    throw InternalError("tissueNumber: unknown head surface");
}

std::string_view tissueName(std::int32_t number) {
    constexpr std::array<std::string_view, 4> kNames{"brain", "csf", "skull", "scalp"};
    return number >= 2 && number <= 5 ? kNames[static_cast<std::size_t>(number - 2)] : "unknown";
}

std::string tetgenInput(std::span<const TriangleMesh> surfaces, double elementMm) {
    std::int64_t points = 0, triangles = 0;
    for (const TriangleMesh& surface : surfaces) {
        points += std::ssize(surface.points);
        triangles += std::ssize(surface.triangles);
    }
    std::string poly = text(points) + " 3 0 0\n";
    std::int64_t number = 0;
    for (const TriangleMesh& surface : surfaces) {
        for (const Vec3& p : surface.points) {
            poly += text(number++) + " " + text(p.x) + " " + text(p.y) + " " + text(p.z) + "\n";
        }
    }
    poly += text(triangles) + " 1\n";
    std::int64_t first = 0, marker = 0;
    for (const TriangleMesh& surface : surfaces) {
        ++marker;
        for (const auto& [a, b, c] : surface.triangles) {
            poly += "1 0 " + text(marker) + "\n3 " + text(first + a) + " " + text(first + b) + " " +
                    text(first + c) + "\n";
        }
        first += std::ssize(surface.points);
    }
    poly += "0\n" + text(std::ssize(surfaces)) + "\n";
    constexpr double kBesideMm = 0.1;
    const double mm3 = elementMm * elementMm * elementMm / (6 * std::numbers::sqrt2);
    for (std::size_t n = 0; n < surfaces.size(); ++n) {
        const Vec3 p =
            n == 0 ? beside(surfaces[0], -kBesideMm) : beside(surfaces[n - 1], kBesideMm);
        const std::int64_t tissue = tissueNumber(headSurface(n, surfaces.size()), surfaces.size());
        poly += text(static_cast<std::int64_t>(n + 1)) + " " + text(p.x) + " " + text(p.y) + " " +
                text(p.z) + " " + text(tissue) + " " + text(mm3) + "\n";
    }
    return poly;
}

std::string gmshInput(std::span<const std::string> surfaceFiles, double elementMm) {
    std::string script =
        "General.Terminal = 1;\nMesh.CharacteristicLengthMax = " + text(elementMm) +
        ";\nMesh.CharacteristicLengthExtendFromBoundary = 1;\n"
        "Mesh.Optimize = 1;\nMesh.OptimizeNetgen = 0;\n";
    for (const std::string& file : surfaceFiles) script += "Merge \"" + file + "\";\n";
    for (std::size_t n = 1; n <= surfaceFiles.size(); ++n) {
        const std::string number = std::to_string(n);
        script += "Surface Loop(" + number + ") = {" + number + "};\nVolume(" + number + ") = {" +
                  number + (n > 1 ? ", " + std::to_string(n - 1) : "") + "};\nPhysical Volume(" +
                  std::to_string(
                      tissueNumber(headSurface(n - 1, surfaceFiles.size()), surfaceFiles.size())) +
                  ") = {" + number + "};\n";
    }
    return script;
}

TetrahedralMesh decodeTetgen(std::string_view nodes, std::string_view elements,
                             std::string_view name) {
    TetrahedralMesh mesh;
    Words words(nodes, name);
    const std::int64_t points = words.count();
    const auto dimensions = words.number<int>(), attributes = words.number<int>(),
               markers = words.number<int>();
    if (dimensions != 3 || attributes < 0 || attributes > 100 || markers < 0 || markers > 1) {
        words.fail("its points are of another kind than asked for");
    }
    std::int64_t first = 0;
    for (std::int64_t n = 0; n < points; ++n) {
        const auto number = words.number<std::int64_t>();
        if (n == 0) first = number;
        Vec3 p;
        for (int a = 0; a < 3; ++a) p[a] = words.number<double>();
        if (!std::isfinite(squaredNorm(p))) words.fail("a point is not finite");
        for (int k = 0; k < attributes + markers; ++k) words.next();
        mesh.points.push_back(p);
    }
    Words rows(elements, name);
    const std::int64_t count = rows.count();
    const auto corners = rows.number<int>(), labels = rows.number<int>();
    if (corners != 4 || labels != 1) rows.fail("its elements have no labels, or not four corners");
    for (std::int64_t n = 0; n < count; ++n) {
        rows.next();
        std::array<VertexId, 4> t{};
        for (VertexId& v : t) v = rows.number<std::int64_t>() - first;
        mesh.tetrahedra.push_back(t);
        mesh.tissues.push_back(static_cast<std::int32_t>(rows.number<double>()));
    }
    requireInRange(mesh, rows);
    turnNegative(mesh);
    return mesh;
}

TetrahedralMesh decodeGmsh(std::string_view bytes, std::string_view name) {
    TetrahedralMesh mesh;
    Words words(bytes, name);
    words.skipTo("$Nodes");
    std::map<std::int64_t, VertexId> number;
    const std::int64_t points = words.count();
    for (std::int64_t n = 0; n < points; ++n) {
        number[words.number<std::int64_t>()] = n;
        Vec3 p;
        for (int a = 0; a < 3; ++a) p[a] = words.number<double>();
        if (!std::isfinite(squaredNorm(p))) words.fail("a point is not finite");
        mesh.points.push_back(p);
    }
    words.skipTo("$Elements");
    const std::int64_t count = words.count();
    constexpr std::array<int, 5> kCorners{0, 2, 3, 4,
                                          4};  // of gmsh's line, triangle, quad, tetrahedron
    for (std::int64_t n = 0; n < count; ++n) {
        words.next();
        const auto type = words.number<int>();
        const auto tags = words.number<int>();
        if (type == 15) {
            for (int k = 0; k < tags + 1; ++k) words.next();
            continue;
        }
        if (type < 1 || type > 4 || tags < 1 || tags > 100)
            words.fail("an element is of no known type");
        const auto tissue = words.number<std::int32_t>();
        for (int k = 1; k < tags; ++k) words.next();
        std::array<VertexId, 4> t{};
        for (int k = 0; k < kCorners[static_cast<std::size_t>(type)]; ++k) {
            const auto found = number.find(words.number<std::int64_t>());
            t[static_cast<std::size_t>(k)] = found == number.end() ? -1 : found->second;
        }
        if (type != 4) continue;
        mesh.tetrahedra.push_back(t);
        mesh.tissues.push_back(tissue);
    }
    requireInRange(mesh, words);
    turnNegative(mesh);
    return mesh;
}

TetrahedraReport checkTetrahedra(const TetrahedralMesh& mesh,
                                 std::span<const TriangleMesh> surfaces) {
    TetrahedraReport report;
    const std::size_t layers = surfaces.size();
    report.counts.resize(layers);
    report.volumesMm3.resize(layers);
    std::map<std::int32_t, std::size_t> layerOf;
    double within = 0;
    for (std::size_t n = 0; n < layers; ++n) {
        layerOf[tissueNumber(headSurface(n, layers), layers)] = n;
        const double mm3 = enclosedVolume(surfaces[n]);
        report.expectedMm3.push_back(mm3 - within);
        within = mm3;
    }
    std::vector<double> dihedrals, ratios;
    for (std::size_t n = 0; n < mesh.tetrahedra.size(); ++n) {
        const double mm3 = volumeOf(mesh, mesh.tetrahedra[n]);
        const auto layer = layerOf.find(mesh.tissues[n]);
        if (layer == layerOf.end()) {
            ++report.unlabelled;
        } else {
            ++report.counts[layer->second];
            report.volumesMm3[layer->second] += mm3;
        }
        if (!(mm3 > 0)) {
            ++report.flat;
            continue;
        }
        dihedrals.push_back(leastDihedralDeg(mesh, mesh.tetrahedra[n]));
        ratios.push_back(radiusEdge(mesh, mesh.tetrahedra[n]));
    }
    if (dihedrals.empty()) return report;
    report.leastDihedralDeg = *std::min_element(dihedrals.begin(), dihedrals.end());
    report.p5DihedralDeg = rankOf(dihedrals, 0.05);
    report.mostRadiusEdge = *std::max_element(ratios.begin(), ratios.end());
    report.p95RadiusEdge = rankOf(ratios, 0.95);
    return report;
}

}  // namespace adaptiso
