// The three spheres that boundary elements are tried on, from images to surfaces: writes
// FOLDER/bem/{inner_skull,outer_skull,outer_skin}.surf for solveSpheres.py and prints what they
// are like.
//
//   makeSpheres FOLDER [--image partial|binary|icosphere] [--vertices N] [--fit MM]
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "RunBenchmark.h"
#include "Support/Meshes.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/Extraction/Extraction.h"
#include "adaptiso/HeadModel/NestSurfaces.h"
#include "adaptiso/HeadModel/Remesh.h"
#include "adaptiso/MeshIO/MeshFile.h"

namespace {

using namespace adaptiso;

constexpr std::array<double, 3> kRadiiMm{80, 86, 92};
constexpr std::array<const char*, 3> kNames{"inner_skull", "outer_skull", "outer_skin"};

struct Options {
    std::filesystem::path folder;
    std::string image = "partial";
    std::int64_t vertices = 642;
    double fitMm = 0;
};

/// The part of a voxel of 1 mm around p that lies in the ball, by 8^3 points.
float partInside(const Vec3& p, double radiusMm) {
    constexpr int kPoints = 8;
    const double depth = radiusMm - norm(p);
    if (std::abs(depth) > 1) return depth > 0 ? 1 : 0;
    int count = 0;
    for (int n = 0; n < kPoints * kPoints * kPoints; ++n) {
        const auto offset = [](int i) { return (i + 0.5) / kPoints - 0.5; };
        const Vec3 q = p + Vec3{offset(n % kPoints), offset(n / kPoints % kPoints),
                                offset(n / kPoints / kPoints)};
        count += norm(q) <= radiusMm;
    }
    return static_cast<float>(count) / (kPoints * kPoints * kPoints);
}

Volume ballImage(double radiusMm, bool isBinary) {
    ImageGeometry geometry;
    geometry.size = {200, 200, 200};
    geometry.originMm = {-99.27, -99.81, -99.33};  // the centre is no special place of the lattice
    std::vector<float> samples;
    samples.reserve(static_cast<std::size_t>(geometry.voxelCount()));
    for (std::int64_t n = 0; n < geometry.voxelCount(); ++n) {
        const Vec3 p =
            geometry.toPhysical({static_cast<double>(n % 200), static_cast<double>(n / 200 % 200),
                                 static_cast<double>(n / 200 / 200)});
        samples.push_back(isBinary ? static_cast<float>(norm(p) <= radiusMm)
                                   : partInside(p, radiusMm));
    }
    return Volume::fromSamples(std::move(samples), geometry);
}

TriangleMesh denseSphere(double radiusMm, bool isBinary) {
    const Volume volume = ballImage(radiusMm, isBinary);
    ExtractionOptions options;
    options.isovalue = 0.5;
    options.method = Method::MarchingCubes;
    options.computeNormals = false;
    return extractSurface(volume, SpanSpaceIndex::build(volume, {}), options).mesh;
}

TriangleMesh makeSphere(const Options& options, double radiusMm) {
    if (options.image == "icosphere") {
        int subdivisions = 0;
        while (10 * (std::int64_t{1} << 2 * subdivisions) + 2 < options.vertices) ++subdivisions;
        return testing::icosphere(subdivisions, {}, radiusMm);
    }
    const TriangleMesh dense = denseSphere(radiusMm, options.image == "binary");
    RemeshOptions remesh;
    remesh.vertices = options.vertices;
    remesh.fitMm = options.fitMm;
    const auto start = std::chrono::steady_clock::now();
    const Remeshed result = remeshForBem(dense, remesh);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    std::printf(
        "%zu triangles -> %zu vertices in %.2f s; angles: p5 %.1f, least %.1f deg; "
        "edges %.2f, %.2f, %.2f mm; ",
        dense.triangles.size(), result.mesh.points.size(), seconds.count(),
        result.statistics.p5SmallestAngleDeg, result.statistics.minimumAngleDeg,
        result.statistics.minimumEdgeMm, result.statistics.meanEdgeMm,
        result.statistics.maximumEdgeMm);
    return result.mesh;
}

void printRadiusError(const TriangleMesh& mesh, double radiusMm) {
    double sum = 0, largest = 0;
    for (const Vec3& p : mesh.points) {
        const double error = std::abs(norm(p) - radiusMm);
        sum += error;
        largest = std::max(largest, error);
    }
    std::printf("radius %g: error mean %.4f, max %.4f mm\n", radiusMm,
                sum / static_cast<double>(mesh.points.size()), largest);
}

void makeSpheres(const Options& options) {
    std::vector<TriangleMesh> spheres;
    for (const double radiusMm : kRadiiMm) {
        spheres.push_back(makeSphere(options, radiusMm));
        printRadiusError(spheres.back(), radiusMm);
    }
    const NestResult nested = nestSurfaces(spheres);
    for (const Finding& finding : nested.findings) std::printf("%s\n", finding.what.c_str());
    for (const NestedGap& gap : nested.gaps) std::printf("gap %.3f mm\n", gap.mm);
    std::filesystem::create_directories(options.folder / "bem");
    for (std::size_t n = 0; n < nested.surfaces.size(); ++n) {
        writeMesh(nested.surfaces[n], options.folder / "bem" / (std::string(kNames[n]) + ".surf"));
    }
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Three spheres from images of 1 mm, remeshed for boundary elements",
                 "makeSpheres");
    Options options;
    app.add_option("folder", options.folder)->required();
    app.add_option("--image", options.image)
        ->check(CLI::IsMember({"partial", "binary", "icosphere"}));
    app.add_option("--vertices", options.vertices);
    app.add_option("--fit", options.fitMm, "how far vertices may leave the input, mm");
    return adaptiso::benchmarks::runBenchmark(app, argc, argv, [&] { makeSpheres(options); });
}
