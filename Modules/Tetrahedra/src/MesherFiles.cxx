#include "adaptiso/Tetrahedra/MesherFiles.h"

#include <array>
#include <charconv>
#include <cmath>
#include <concepts>
#include <limits>
#include <map>
#include <numbers>
#include <system_error>
#include <utility>

#include "adaptiso/Core/Bytes.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Core/TextLines.h"
#include "adaptiso/Tetrahedra/Tetrahedra.h"

namespace adaptiso {
namespace {

std::string text(std::integral auto value) {
    return std::to_string(value);
}

std::string text(const Vec3& p) {
    return shortestText(p.x) + " " + shortestText(p.y) + " " + shortestText(p.z);
}

/// Numbers between white space; lines that begin with '#' are passed over.
class Words {
public:
    Words(std::string_view bytes, std::string_view name)
        : bytes_(withoutByteOrderMark(bytes)), name_(name) {}

    std::string_view next() {
        for (;;) {
            while (at_ < bytes_.size() && isSpace(bytes_[at_])) ++at_;
            if (at_ >= bytes_.size() || bytes_[at_] != '#') break;
            takeLine(bytes_, at_);
        }
        const std::size_t begin = at_;
        while (at_ < bytes_.size() && !isSpace(bytes_[at_])) ++at_;
        return bytes_.substr(begin, at_ - begin);
    }
    template <class Number>
    Number number() {
        return parsed<Number>(next());
    }
    /// All numbers before a word.
    template <class Number>
    std::vector<Number> numbersUntil(std::string_view word) {
        std::vector<Number> numbers;
        for (std::string_view found = next(); found != word; found = next()) {
            numbers.push_back(parsed<Number>(found));
        }
        return numbers;
    }
    Vec3 point() {
        Vec3 p;
        for (int a = 0; a < 3; ++a) p[a] = number<double>();
        if (!std::isfinite(squaredNorm(p))) fail("a point is not finite");
        return p;
    }
    void require(std::string_view word) {
        if (next() != word) fail("it lacks " + std::string(word));
    }
    /// A number of things of which each takes two bytes or more.
    std::int64_t count() {
        const auto value = number<std::int64_t>();
        if (value < 0 || static_cast<std::uint64_t>(value) > bytes_.size() / 2) {
            fail("it says it holds " + std::to_string(value) + " things");
        }
        return value;
    }
    /// An attribute of tetgen's, which it writes as a real number.
    std::int32_t label() {
        const auto value = number<double>();
        constexpr double kMost = std::numeric_limits<std::int32_t>::max();
        if (!(std::abs(value) <= kMost)) fail("a region's number is none");
        return static_cast<std::int32_t>(value);
    }
    void requireEnd(std::string_view what) {
        if (!next().empty()) fail("it holds more " + std::string(what) + " than it counts");
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
    template <class Number>
    Number parsed(std::string_view word) const {
        Number value{};
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
        if (error != std::errc() || end != word.data() + word.size()) {
            fail("a number is due where there is '" + visibleAscii(word.substr(0, 20)) + "'");
        }
        return value;
    }
    static bool isSpace(char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t'; }

    std::string_view bytes_, name_;
    std::size_t at_ = 0;
};

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

}  // namespace

Vec3 pointBeside(const TriangleMesh& walls, const AabbTree& tree,
                 std::span<const std::int64_t> triangles, bool outward) {
    constexpr int kHalvings = 20;
    for (const std::int64_t t : triangles) {
        const auto& [a, b, c] = walls.triangles[t];
        const Vec3 normal = areaVector2(walls.points[a], walls.points[b], walls.points[c]);
        const double area2 = norm(normal);
        if (!(area2 > 0)) continue;
        const Vec3 middle = 1.0 / 3 * (walls.points[a] + walls.points[b] + walls.points[c]);
        double step = std::sqrt(area2) / 4;
        for (int n = 0; n < kHalvings; ++n, step /= 2) {
            const Vec3 p = middle + (outward ? step : -step) / area2 * normal;
            // where nothing is nearer than the middle, nothing lies on the way from it
            const double nearest = tree.closestPoint(p).squaredDistanceMm2;
            constexpr double kRounding = 1e-6;
            if (nearest > 0 && nearest >= step * step * (1 - kRounding)) return p;
        }
    }
    throw InvalidInput("pointBeside: all triangles are flat, or touched by others");
}

const Options<MesherOptions>& elementOptions() {
    static const Options<MesherOptions> kRows{option<&MesherOptions::elementMm>(
        {.name = "element-size",
         .key = "elementMm",
         .valueName = "MM",
         .help = "Longest edge of an equilateral tetrahedron; at the walls elements are as small "
                 "as their triangles",
         .standard = "5",
         .rule = {.least = 0.5, .most = 50, .unit = "mm"}})};
    return kRows;
}

std::string tetgenInput(const MesherInput& input, double elementMm) {
    std::string poly = text(std::ssize(input.points)) + " 3 0 0\n";
    std::int64_t number = 0;
    for (const Vec3& p : input.points) poly += text(number++) + " " + text(p) + "\n";
    poly += text(std::ssize(input.triangles)) + " 1\n";
    for (std::size_t t = 0; t < input.triangles.size(); ++t) {
        const auto& [a, b, c] = input.triangles[t];
        poly +=
            "1 0 " + text(input.walls[t]) + "\n3 " + text(a) + " " + text(b) + " " + text(c) + "\n";
    }
    const double mm3 = elementMm * elementMm * elementMm / (6 * std::numbers::sqrt2);
    poly += "0\n" + text(std::ssize(input.volumes)) + "\n";
    number = 0;
    for (const MesherVolume& volume : input.volumes) {
        poly += text(++number) + " " + text(volume.insideMm) + " " + text(volume.region) + " " +
                shortestText(mm3) + "\n";
    }
    return poly;
}

std::string gmshWalls(const MesherInput& input) {
    std::string msh =
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n" + text(std::ssize(input.points)) + "\n";
    std::int64_t number = 0;
    for (const Vec3& p : input.points) msh += text(++number) + " " + text(p) + "\n";
    msh += "$EndNodes\n$Elements\n" + text(std::ssize(input.triangles)) + "\n";
    for (std::size_t t = 0; t < input.triangles.size(); ++t) {
        const auto& [a, b, c] = input.triangles[t];
        const std::string wall = text(input.walls[t]);
        msh += text(static_cast<std::int64_t>(t + 1)) + " 2 2 " + wall + " " + wall + " " +
               text(a + 1) + " " + text(b + 1) + " " + text(c + 1) + "\n";
    }
    return msh + "$EndElements\n";
}

std::string gmshScript(const MesherInput& input, std::string_view wallsFile, double elementMm) {
    std::string script =
        "General.Terminal = 1;\nMesh.CharacteristicLengthMax = " + shortestText(elementMm) +
        ";\nMesh.CharacteristicLengthExtendFromBoundary = 1;\n"
        "Mesh.Optimize = 1;\nMesh.OptimizeNetgen = 0;\nMerge \"" +
        std::string(wallsFile) + "\";\n";
    std::map<std::int32_t, std::string> volumesOf;
    std::int64_t number = 0;
    for (const MesherVolume& volume : input.volumes) {
        const std::string name = text(++number);
        script += "Surface Loop(" + name + ") = {" +
                  joined(volume.walls, [](std::int32_t wall) { return text(wall); }) +
                  "};\nVolume(" + name + ") = {" + name + "};\n";
        std::string& list = volumesOf[volume.region];
        addPart(list, name);
    }
    for (const auto& [region, list] : volumesOf) {
        script += "Physical Volume(" + text(region) + ") = {" + list + "};\n";
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
        mesh.points.push_back(words.point());
        for (int k = 0; k < attributes + markers; ++k) words.next();
    }
    words.requireEnd("points");
    Words rows(elements, name);
    const std::int64_t count = rows.count();
    const auto corners = rows.number<int>(), labels = rows.number<int>();
    if (corners != 4 || labels != 1) rows.fail("its elements have no labels, or not four corners");
    for (std::int64_t n = 0; n < count; ++n) {
        rows.next();
        std::array<VertexId, 4> t{};
        for (VertexId& v : t) v = rows.number<std::int64_t>() - first;
        mesh.tetrahedra.push_back(t);
        mesh.labels.push_back(rows.label());
    }
    rows.requireEnd("elements");
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
        mesh.points.push_back(words.point());
    }
    if (words.next() != "$EndNodes") words.fail("it holds more points than it counts");
    words.skipTo("$Elements");
    const std::int64_t count = words.count();
    constexpr std::array<int, 5> kCorners{0, 2, 3, 4,
                                          4};  // of gmsh's line, triangle, quad, tetrahedron
    for (std::int64_t n = 0; n < count; ++n) {
        words.next();
        const auto type = words.number<int>();
        const auto tags = words.number<int>();
        constexpr int kPoint = 15, kMostTags = 100;
        if ((type != kPoint && (type < 1 || type > 4)) || tags < 1 || tags > kMostTags) {
            words.fail("an element is of no known type");
        }
        if (type == kPoint) {
            for (int k = 0; k < tags + 1; ++k) words.next();
            continue;
        }
        const auto label = words.number<std::int32_t>();
        for (int k = 1; k < tags; ++k) words.next();
        std::array<VertexId, 4> t{};
        for (int k = 0; k < kCorners[static_cast<std::size_t>(type)]; ++k) {
            const auto found = number.find(words.number<std::int64_t>());
            t[static_cast<std::size_t>(k)] = found == number.end() ? -1 : found->second;
        }
        if (type != 4) continue;
        mesh.tetrahedra.push_back(t);
        mesh.labels.push_back(label);
    }
    if (words.next() != "$EndElements") words.fail("it holds more elements than it counts");
    requireInRange(mesh, words);
    turnNegative(mesh);
    return mesh;
}

MesherRun mesherRun(const MesherInput& input, const MesherOptions& options) {
    if (options.mesher == "tetgen") {
        // radius by shortest edge 1.4 and dihedral angles of 10 degrees where the walls allow them
        return {"tetgen",
                {"-pq1.4/10aAQ", "head.poly"},
                {{"head.poly", tetgenInput(input, options.elementMm)}},
                {"head.1.node", "head.1.ele"},
                {"head.1.face", "head.1.edge", "head.1.smesh"}};
    }
    return {"gmsh",
            {"-3", "-nt", "1", "-format", "msh22", "-o", "head.msh", "head.geo"},
            {{"walls.msh", gmshWalls(input)},
             {"head.geo", gmshScript(input, "walls.msh", options.elementMm)}},
            {"head.msh"}};
}

TetrahedralMesh mesherResult(const std::string& mesher, std::span<const std::string> results,
                             const std::optional<std::string>& reason) {
    if (reason || results.back().empty()) {
        throw FileError(mesher + ": made no tetrahedra (" + reason.value_or("no file") +
                        "); try another element size, or the other mesher");
    }
    return results.size() == 2 ? decodeTetgen(results[0], results[1], mesher)
                               : decodeGmsh(results[0], mesher);
}

namespace {

/// Of lists of coordinates, corners and labels.
TetrahedralMesh meshOf(const std::vector<double>& coordinates,
                       const std::vector<std::int64_t>& corners, std::vector<std::int32_t> labels,
                       const Words& words) {
    TetrahedralMesh mesh;
    mesh.labels = std::move(labels);
    if (coordinates.size() % 3 != 0 || corners.size() != 4 * mesh.labels.size()) {
        words.fail("a point or an element lacks a number");
    }
    for (std::size_t n = 0; n < coordinates.size(); n += 3) {
        mesh.points.push_back({coordinates[n], coordinates[n + 1], coordinates[n + 2]});
    }
    for (std::size_t n = 0; n < corners.size(); n += 4) {
        mesh.tetrahedra.push_back({corners[n], corners[n + 1], corners[n + 2], corners[n + 3]});
    }
    requireInRange(mesh, words);
    return mesh;
}

TetrahedralMesh decodeMsh41(Words words) {
    TetrahedralMesh mesh;
    words.skipTo("$Nodes");
    if (words.number<int>() != 1) words.fail("it has more than one block of points");
    const std::int64_t points = words.count();
    for (int n = 0; n < 5; ++n) words.number<std::int64_t>();
    if (words.count() != points) words.fail("it counts its points in two ways");
    for (std::int64_t n = 1; n <= points; ++n) {
        if (words.number<std::int64_t>() != n) words.fail("its points are not numbered from 1");
    }
    for (std::int64_t n = 0; n < points; ++n) mesh.points.push_back(words.point());
    words.require("$EndNodes");
    words.require("$Elements");
    const std::int64_t blocks = words.count(), elements = words.count();
    for (int n = 0; n < 2; ++n) words.number<std::int64_t>();
    for (std::int64_t block = 0; block < blocks; ++block) {
        if (words.number<int>() != 3) words.fail("an element has no volume");
        const auto label = words.number<std::int32_t>();
        if (words.number<int>() != 4) words.fail("an element is no tetrahedron");
        const std::int64_t count = words.count();
        for (std::int64_t n = 0; n < count; ++n) {
            words.number<std::int64_t>();
            for (VertexId& v : mesh.tetrahedra.emplace_back()) v = words.number<std::int64_t>() - 1;
            mesh.labels.push_back(label);
        }
    }
    words.require("$EndElements");
    if (elements != std::ssize(mesh.labels)) words.fail("it counts its elements in two ways");
    requireInRange(mesh, words);
    return mesh;
}

TetrahedralMesh decodeVtu(Words words, std::string_view bytes) {
    const auto skipToArray = [&](std::string_view name) {
        words.skipTo(name);
        words.require("format=\"ascii\">");
    };
    skipToArray("Name=\"tissue\"");
    auto labels = words.numbersUntil<std::int32_t>("</DataArray>");
    skipToArray("NumberOfComponents=\"3\"");
    const auto coordinates = words.numbersUntil<double>("</DataArray>");
    skipToArray("Name=\"connectivity\"");
    const auto corners = words.numbersUntil<std::int64_t>("</DataArray>");
    TetrahedralMesh mesh = meshOf(coordinates, corners, std::move(labels), words);
    const std::string counts = "NumberOfPoints=\"" + text(std::ssize(mesh.points)) +
                               "\" NumberOfCells=\"" + text(std::ssize(mesh.labels)) + "\"";
    if (bytes.find(counts) == bytes.npos) words.fail("it counts its points or cells otherwise");
    skipToArray("Name=\"offsets\"");
    const auto offsets = words.numbersUntil<std::int64_t>("</DataArray>");
    skipToArray("Name=\"types\"");
    const auto types = words.numbersUntil<int>("</DataArray>");
    bool areTetrahedra = offsets.size() == mesh.labels.size() && types.size() == offsets.size();
    for (std::size_t n = 0; areTetrahedra && n < types.size(); ++n) {
        areTetrahedra = types[n] == 10 && offsets[n] == static_cast<std::int64_t>(4 * (n + 1));
    }
    if (!areTetrahedra) words.fail("a cell is no tetrahedron");
    return mesh;
}

TetrahedralMesh decodeDgf(Words words) {
    words.require("DGF");
    words.require("Vertex");
    const auto coordinates = words.numbersUntil<double>("Simplex");
    words.require("parameters");
    words.require("1");
    const auto rows = words.numbersUntil<std::int64_t>("BoundaryDomain");
    std::vector<std::int64_t> corners;
    std::vector<std::int32_t> labels;
    for (std::size_t n = 0; n < rows.size(); ++n) {
        if (n % 5 == 4) {
            labels.push_back(static_cast<std::int32_t>(rows[n]));
        } else {
            corners.push_back(rows[n]);
        }
    }
    return meshOf(coordinates, corners, std::move(labels), words);
}

}  // namespace

TetrahedralMesh decodeTetrahedra(std::string_view bytes, std::string_view name) {
    const Words words(bytes, name);
    if (bytes.starts_with("DGF")) return decodeDgf(words);
    if (bytes.starts_with("<?xml")) return decodeVtu(words, bytes);
    if (bytes.starts_with("$MeshFormat\n4.1")) return decodeMsh41(words);
    return decodeGmsh(bytes, name);
}

}  // namespace adaptiso
