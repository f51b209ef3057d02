// A program outside adaptiso: the surface of a ball from samples in memory, by both methods, into
// files and back: sphere <folder>. Exits 0 when they are right, 1 when they are not.
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/Extraction/Extraction.h"
#include "adaptiso/MeshIO/MeshFile.h"
#include "adaptiso/SpanSpace/SpanSpaceIndex.h"

namespace {

constexpr double kRadiusMm = 24;
constexpr int kSize = 64;  // voxels of 1 mm along each axis

/// Depth below the surface of a ball at the origin (mm, positive inside).
adaptiso::Volume makeBall() {
    adaptiso::ImageGeometry geometry;
    geometry.size = {kSize, kSize, kSize};
    geometry.originMm = {-31.5, -31.5, -31.5};
    std::vector<float> samples;
    for (int k = 0; k < kSize; ++k) {
        for (int j = 0; j < kSize; ++j) {
            for (int i = 0; i < kSize; ++i) {
                const adaptiso::Vec3 point = geometry.toPhysical({double(i), double(j), double(k)});
                samples.push_back(static_cast<float>(kRadiusMm - adaptiso::norm(point)));
            }
        }
    }
    return adaptiso::Volume::fromSamples(std::move(samples), geometry);
}

/// Whether the surface has triangles and encloses at least `leastPart` of the ball, and not more
/// than the ball. All of its vertices lie on lattice edges at crossings of a concave function taken
/// as linear between samples, so inside the ball (float samples: up to 1e-6 of the radius beyond).
bool surfaceIsRight(const adaptiso::VolumeView& ball, const adaptiso::SpanSpaceIndex& index,
                    adaptiso::Method method, double leastPart, const std::filesystem::path& file) {
    adaptiso::ExtractionOptions options;
    options.isovalue = 0;
    options.method = method;
    const adaptiso::TriangleMesh mesh = adaptiso::extractSurface(ball, index, options).mesh;

    const double ballMm3 = 4.0 / 3.0 * std::numbers::pi * std::pow(kRadiusMm, 3);
    const double part = adaptiso::enclosedVolume(mesh) / ballMm3;
    std::printf("method %d: %zu triangles enclose %.4f of the ball\n", static_cast<int>(method),
                mesh.triangles.size(), part);
    adaptiso::writeMesh(mesh, file);
    const bool isKept = adaptiso::readMesh(file).mesh.triangles == mesh.triangles;
    return isKept && !mesh.triangles.empty() && part >= leastPart && part <= 1 + 1e-5;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        if (argc != 2) throw std::invalid_argument("give a folder");
        const std::filesystem::path folder = argv[1];
        const adaptiso::Volume ball = makeBall();
        const auto index = adaptiso::SpanSpaceIndex::build(ball, {.blockSize = 4});
        // marching cubes: sides of up to sqrt(3) mm cut 3 / (8 * 24) = 0.016 mm off at most
        // (0.2 % of the volume)
        const bool isFineRight =
            surfaceIsRight(ball, index, adaptiso::Method::MarchingCubes, 0.98, folder / "fine.vtp");
        // boxes of 4 mm: both the surface and the facet that stands for it pass through the same
        // boxes, so they are at most 4 mm apart along an axis (3 * 4 / 24 = half the volume)
        const bool isAdaptiveRight =
            surfaceIsRight(ball, index, adaptiso::Method::Boxes, 0.5, folder / "adaptive.vtk");
        return isFineRight && isAdaptiveRight ? 0 : 1;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "sphere: %s\n", error.what());
        return 1;
    }
}
