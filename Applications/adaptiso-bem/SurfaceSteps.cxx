#include "SurfaceSteps.h"

#include <utility>

#include "adaptiso/Extraction/Extraction.h"

namespace adaptiso {
namespace {

constexpr std::int64_t kDefaultVertices = 2562;
constexpr double kFitMm = 0.5;
/// Files keep floats: a gap must not fall short by their rounding (3e-5 mm at 500 mm).
constexpr double kRoundingMm = 1e-4;

RemeshOptions remeshOptions(const BemRun& run, const std::vector<TriangleMesh>& dense,
                            std::size_t n) {
    const BemOptions& options = run.options;
    RemeshOptions remesh;
    // what is left of the voxels' stairs after smoothing; ready surfaces are taken at their word
    if (run.source != "surfaces") remesh.fitMm = kFitMm;
    remesh.edgeLengthMm = options.edgeLengthMm;
    const std::int64_t usual = run.surfaces[n].ownVertices.value_or(kDefaultVertices);
    remesh.vertices = options.verticesOf(n).value_or(options.edgeLengthMm ? 0 : usual);
    if (n > 0) remesh.neighbours.push_back(&dense[n - 1]);
    if (n + 1 < dense.size()) remesh.neighbours.push_back(&dense[n + 1]);
    return remesh;
}

/// Ready surfaces keep their triangles unless others are asked for.
bool staysAsItCame(const BemSurface& surface, const BemOptions& options) {
    return surface.denseTriangles == 0 && options.vertices.empty() && !options.edgeLengthMm;
}

std::string nameOf(std::size_t n) {
    return std::string(toString(static_cast<HeadSurface>(n)));
}

}  // namespace

std::vector<TriangleMesh> extractSurfaces(const HeadBoundaries& boundaries, BemRun& run,
                                          ProgressLine& progress) {
    std::vector<TriangleMesh> surfaces;
    for (const FractionField& solid : boundaries.solids) {
        progress.show("extract");
        run.timer.time("extract", [&] {
            const SpanSpaceIndex index = SpanSpaceIndex::build(solid.view(), {});
            ExtractionOptions extract;
            extract.isovalue = kFractionIsovalue;
            extract.method = Method::MarchingCubes;
            extract.computeNormals = false;
            surfaces.push_back(extractSurface(solid.view(), index, extract).mesh);
        });
        BemSurface surface;
        surface.denseTriangles = std::ssize(surfaces.back().triangles);
        run.surfaces.push_back(surface);
    }
    return surfaces;
}

std::vector<TriangleMesh> remeshAndNest(const std::vector<TriangleMesh>& dense, BemRun& run,
                                        ProgressLine& progress) {
    std::vector<TriangleMesh> surfaces;
    for (std::size_t n = 0; n < dense.size(); ++n) {
        if (staysAsItCame(run.surfaces[n], run.options)) {
            surfaces.push_back(dense[n]);
            continue;
        }
        progress.show("remesh", static_cast<double>(n) / static_cast<double>(dense.size()));
        Remeshed result = run.timer.time(
            "remesh", [&] { return remeshForBem(dense[n], remeshOptions(run, dense, n)); });
        run.surfaces[n].remesh = result.statistics;
        for (Finding& finding : result.findings) {
            finding.what = nameOf(n) + ": " + finding.what;
            run.findings.push_back(std::move(finding));
        }
        surfaces.push_back(std::move(result.mesh));
    }
    if (!run.findings.empty() || surfaces.size() == 1) {
        return run.findings.empty() ? surfaces : std::vector<TriangleMesh>{};
    }
    progress.show("nest");
    NestOptions nest;
    nest.minGapsMm.clear();
    for (const double gap : run.options.minGapsMm()) nest.minGapsMm.push_back(gap + kRoundingMm);
    NestResult nested = run.timer.time("nest", [&] { return nestSurfaces(surfaces, nest); });
    for (std::size_t n = 0; n < nested.moves.size(); ++n) run.surfaces[n].move = nested.moves[n];
    run.findings = nested.findings;
    return std::move(nested.surfaces);
}

}  // namespace adaptiso
