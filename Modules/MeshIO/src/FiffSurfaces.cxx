// FIFF's block BEM (310) with the coordinate frame and, for every surface, a block BEM_SURF (311).
#include "adaptiso/MeshIO/FiffSurfaces.h"

#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "ByteSource.h"
#include "Fiff.h"
#include "FileBytes.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso {

using namespace meshio;

namespace {

/// Bytes of a matrix with three columns are counted in 31 bits.
constexpr std::size_t kMostRows = std::numeric_limits<std::int32_t>::max() / 12 - 1;

void requireCountable(std::span<const FiffSurface> surfaces, const std::string& file) {
    if (surfaces.empty()) throw InvalidInput(file + ": there is no surface to write");
    for (const FiffSurface& surface : surfaces) {
        const std::size_t most =
            std::max(surface.mesh.points.size(), surface.mesh.triangles.size());
        if (most > kMostRows) {
            throw InvalidInput(file + ": FIFF files hold at most " + std::to_string(kMostRows) +
                               " points and triangles, a surface has " + std::to_string(most));
        }
    }
}

void encodeSurface(const FiffSurface& surface, fiff::Writer& writer) {
    const TriangleMesh& mesh = surface.mesh;
    writer.begin(fiff::kBemSurface);
    writer.put(fiff::kSigma, static_cast<float>(surface.conductivity));
    writer.put(fiff::kSurfaceId, surface.id);
    writer.put(fiff::kMneCoordFrame, fiff::kFrameMri);
    writer.put(fiff::kNodeCount, static_cast<std::int32_t>(mesh.points.size()));
    writer.put(fiff::kTriangleCount, static_cast<std::int32_t>(mesh.triangles.size()));
    writer.put(fiff::kNodes, mesh.points);
    std::vector<std::array<std::int32_t, 3>> triangles;  // numbered from 1
    triangles.reserve(mesh.triangles.size());
    for (const auto& [a, b, c] : mesh.triangles) {
        triangles.push_back({static_cast<std::int32_t>(a + 1), static_cast<std::int32_t>(b + 1),
                             static_cast<std::int32_t>(c + 1)});
    }
    writer.put(fiff::kTriangles, triangles);
    if (!mesh.normals.empty()) {
        std::vector<Vec3> normals;
        for (const Normal& normal : mesh.normals) normals.push_back(toVec3(normal));
        writer.put(fiff::kNormals, normals);
    }
    writer.end(fiff::kBemSurface);
}

const fiff::Tag& require(const fiff::Content& content, std::size_t block, std::int32_t kind,
                         const char* what) {
    const fiff::Tag* const tag = content.find(block, kind);
    if (tag == nullptr) damaged(std::string("a surface lacks its ") + what);
    return *tag;
}

void requireMriFrame(const fiff::Content& content, std::size_t block) {
    const fiff::Tag* frame = content.find(block, fiff::kMneCoordFrame);
    if (frame == nullptr) frame = content.find(block, fiff::kBemCoordFrame);
    if (frame == nullptr) {
        frame = content.find(content.blocks[block].parent, fiff::kBemCoordFrame);
    }
    if (frame == nullptr || fiff::toInt(*frame) == fiff::kFrameMri) return;
    unsupported("a surface is in FIFF's coordinate frame " + std::to_string(fiff::toInt(*frame)),
                "it must be in MRI coordinates (5)");
}

FiffSurface decodeSurface(const fiff::Content& content, std::size_t block) {
    FiffSurface surface;
    if (const fiff::Tag* id = content.find(block, fiff::kSurfaceId)) surface.id = fiff::toInt(*id);
    if (const fiff::Tag* sigma = content.find(block, fiff::kSigma)) {
        surface.conductivity = fiff::toReal(*sigma);
        if (!std::isfinite(surface.conductivity)) damaged("a conductivity is not finite");
    }
    requireMriFrame(content, block);
    surface.mesh.points = fiff::toVectors(require(content, block, fiff::kNodes, "points"));
    for (const Vec3& point : surface.mesh.points) {
        if (!std::isfinite(squaredNorm(point))) damaged("a point is not finite");
    }
    const auto points = static_cast<VertexId>(surface.mesh.points.size());
    for (const auto& row :
         fiff::toTriples(require(content, block, fiff::kTriangles, "triangles"))) {
        Triangle triangle;
        for (std::size_t corner = 0; corner < 3; ++corner) {
            triangle[corner] = VertexId{row[corner]} - 1;
            if (triangle[corner] < 0 || triangle[corner] >= points) {
                damaged("a triangle names the point " + std::to_string(row[corner]) + " of " +
                        std::to_string(points));
            }
        }
        surface.mesh.triangles.push_back(triangle);
    }
    return surface;
}

}  // namespace

void writeFiffSurfaces(std::span<const FiffSurface> surfaces, const std::filesystem::path& path) {
    requireCountable(surfaces, path.string());
    writeBytes(path, [&](ByteSink& sink) {
        fiff::Writer writer(sink);
        writer.begin(fiff::kBem);
        writer.put(fiff::kBemCoordFrame, fiff::kFrameMri);
        for (const FiffSurface& surface : surfaces) encodeSurface(surface, writer);
        writer.end(fiff::kBem);
        writer.finish();
    });
}

std::vector<FiffSurface> decodeFiffSurfaces(std::string_view bytes, std::string_view name) {
    try {
        const fiff::Content content = fiff::decode(bytes);
        std::vector<FiffSurface> surfaces;
        for (std::size_t block = 1; block < content.blocks.size(); ++block) {
            if (content.blocks[block].kind == fiff::kBemSurface) {
                surfaces.push_back(decodeSurface(content, block));
            }
        }
        if (surfaces.empty()) unsupported("it holds no surface", "give a file of surfaces");
        return surfaces;
    } catch (const FileError& error) {
        throw FileError(std::string(name) + ": " + error.what());
    } catch (const std::bad_alloc&) {
        throw FileError(std::string(name) +
                        ": the surfaces do not fit into memory; use a larger machine");
    }
}

std::vector<FiffSurface> readFiffSurfaces(const std::filesystem::path& path) {
    return decodeFiffSurfaces(readBytes(path), path.string());
}

}  // namespace adaptiso
