// Curry's lists: a line "<NAME> START_LIST", rows, a line "<NAME> END_LIST"; lists of other names
// are passed over.
#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include "ByteSource.h"
#include "FileBytes.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/MeshIO/CurrySurface.h"

namespace adaptiso {

using namespace meshio;

namespace {

constexpr std::string_view kStart = " START_LIST", kEnd = " END_LIST";

void requireOneLine(std::string_view text, const std::filesystem::path& path) {
    const bool isPlain =
        std::all_of(text.begin(), text.end(), [](char c) { return c >= ' ' && c <= '~'; });
    if (!isPlain || text.find("LIST") != std::string_view::npos) {
        throw InvalidInput(path.string() + ": the description " + printable(text) +
                           " must be one line of printable ASCII without 'LIST'");
    }
}

/// Calls row(line) for every line of the list; the line of its name has been read.
void forRows(ByteSource& source, std::string_view name,
             const std::function<void(ByteSource&)>& row) {
    while (!source.atEnd()) {
        const std::string_view line = trimmed(source.line());
        if (line.starts_with(name) && line.substr(name.size()).starts_with(kEnd)) return;
        if (line.empty() || line.starts_with('#')) continue;
        ByteSource words(line);
        row(words);
        if (!words.word().empty()) damaged("a row of " + std::string(name) + " is too long");
    }
    damaged("the list " + std::string(name) + " has no end");
}

void requireSound(const TriangleMesh& mesh) {
    const auto points = std::ssize(mesh.points);
    if (points == 0 || mesh.triangles.empty()) damaged("it holds no points or no triangles");
    for (const Vec3& point : mesh.points) {
        if (!std::isfinite(squaredNorm(point))) damaged("a point is not finite");
    }
    for (const Triangle& triangle : mesh.triangles) {
        for (const VertexId vertex : triangle) {
            if (vertex >= 0 && vertex < points) continue;
            damaged("a triangle names the point " + std::to_string(vertex) + " of " +
                    std::to_string(points));
        }
    }
}

TriangleMesh decoded(std::string_view bytes) {
    ByteSource source(bytes);
    TriangleMesh mesh;
    while (!source.atEnd()) {
        const std::string_view line = source.line();
        const std::size_t start = line.find(kStart);
        if (start == std::string_view::npos) continue;
        const std::string_view name = trimmed(line.substr(0, start));
        if (name == "LOCATION_LIST") {
            forRows(source, name, [&](ByteSource& words) {
                Vec3 point;
                for (int axis = 0; axis < 3; ++axis) point[axis] = words.realWord("a coordinate");
                mesh.points.push_back(point);
            });
        } else if (name == "TRIANGLE_LIST") {
            forRows(source, name, [&](ByteSource& words) {
                Triangle triangle;
                for (VertexId& vertex : triangle) vertex = words.integerWord("a vertex");
                mesh.triangles.push_back(triangle);
            });
        }
    }
    requireSound(mesh);
    return mesh;
}

}  // namespace

void writeCurrySurface(const TriangleMesh& mesh, const std::filesystem::path& path,
                       std::string_view description) {
    requireOneLine(description, path);
    writeBytes(path, [&](ByteSink& sink) {
        sink << "POINT_DESCRIPTION START_LIST\n"
             << description << "\nPOINT_DESCRIPTION END_LIST\n\nLOCATION_LIST START_LIST\n";
        for (const Vec3& p : mesh.points) sink << p.x << " " << p.y << " " << p.z << "\n";
        sink << "LOCATION_LIST END_LIST\n\nTRIANGLE_LIST START_LIST\n";
        for (const auto& [a, b, c] : mesh.triangles) sink << a << " " << b << " " << c << "\n";
        sink << "TRIANGLE_LIST END_LIST\n";
    });
}

TriangleMesh decodeCurrySurface(std::string_view bytes, std::string_view name) {
    try {
        return decoded(bytes);
    } catch (const FileError& error) {
        throw FileError(std::string(name) + ": " + error.what());
    } catch (const std::bad_alloc&) {
        throw FileError(std::string(name) +
                        ": the surface does not fit into memory; use a larger machine");
    }
}

TriangleMesh readCurrySurface(const std::filesystem::path& path) {
    return decodeCurrySurface(readBytes(path), path.string());
}

}  // namespace adaptiso
