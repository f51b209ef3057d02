#include <algorithm>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "Common/Json.h"
#include "OutputFiles.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/SurfacePipeline/StoredMesh.h"

namespace adaptiso::labels {
namespace {

constexpr double kNoBound = std::numeric_limits<double>::infinity();

/// A format of files of the run, and what they are called in messages.
struct FileKind {
    const MeshFormat* format;
    std::string files;
    bool isRequested = true;
};

std::string regionFiles(const LabelsRun& run) {
    return run.isScene ? baseName(run.folder) : "regions/*" + run.options.format;
}

std::vector<FileKind> kindsOf(const LabelsRun& run) {
    std::vector<FileKind> kinds{{run.format, regionFiles(run)}};
    if (run.options.writesLayers) kinds.push_back({&findMeshFormat("wall.tri"), "layers/*.tri"});
    kinds.push_back({&findMeshFormat("all.surf.gii"), "all.surf.gii", false});
    return kinds;
}

/// Measures how far the files' digits move the walls.
/// \param walls  settled \param exact  their points before
/// \throws InvalidInput  those of a format that was asked for are beyond the bound
void measureRounding(const TriangleMesh& walls, const std::vector<Vec3>& exact,
                     const AffineTransform& toFrame, LabelsRun& run) {
    const std::string input = baseName(run.options.input);
    for (const FileKind& kind : kindsOf(run)) {
        if (!kind.isRequested && run.leavesGiftiOut) continue;
        const TriangleMesh stored = asStored(walls, kind.format->precision, toFrame);
        double longestMm = 0;
        for (std::size_t v = 0; v < exact.size(); ++v) {
            longestMm = std::max(longestMm, norm(stored.points[v] - exact[v]));
        }
        double& roundingMm = kind.isRequested ? run.roundingMm : run.giftiRoundingMm;
        roundingMm = std::max(roundingMm, longestMm);
        const auto fault =
            roundingFault(longestMm, run.requestedBoundMm().value_or(kNoBound), *kind.format);
        if (!fault) continue;
        const std::string text = kind.files + ": " + *fault;
        if (kind.isRequested) throw InvalidInput(input + ": " + text);
        run.leavesGiftiOut = true;
        run.giftiRoundingMm = 0;
        run.warnings.push_back({"file-left-out", "all.surf.gii is left out; " + text, input});
    }
    if (!run.requestedBoundMm()) return;
    const auto warning = roundingWarning(regionFiles(run), run.errorBoundMm(),
                                         *run.requestedBoundMm(), run.roundingMm, *run.format);
    if (warning) run.warnings.push_back(*warning);
}

}  // namespace

AffineTransform toFile(const LabelsRun& run) {
    return scaled(lpsToFrame(run.frame, frameVolume(run.frame, run.map.geometry)), run.scale);
}

void fitToFiles(LabelComplex& complex, LabelsRun& run) {
    const AffineTransform toFrame = toFile(run);
    TriangleMesh walls{std::move(complex.points), {}, std::move(complex.triangles)};
    const std::vector<Vec3> exact = walls.points;
    const std::string input = baseName(run.options.input);
    constexpr int kMostRounds = 3;  // what fits one file may have to move for another
    for (int round = 0; round < kMostRounds; ++round) {
        std::int64_t moved = 0;
        int precisions = 0;
        CoordinatePrecision last = CoordinatePrecision::Float64;
        for (const FileKind& kind : kindsOf(run)) {
            if (kind.format->precision == last || (!kind.isRequested && run.leavesGiftiOut)) {
                continue;
            }
            last = kind.format->precision;
            ++precisions;
            const RoundingHarm harm = settleRounding(walls, last, toFrame);
            moved += harm.movedPoints;
            if (!harm) continue;
            const std::string text = kind.files + ": " + textOf(harm, *kind.format);
            if (kind.isRequested) throw InvalidInput(input + ": " + text);
            run.leavesGiftiOut = true;
            run.warnings.push_back({"file-left-out", "all.surf.gii is left out; " + text, input});
        }
        if (moved == 0 || precisions < 2) break;
    }
    measureRounding(walls, exact, toFrame, run);
    complex.points = std::move(walls.points);
    complex.triangles = std::move(walls.triangles);
}

LabelComplex asStored(const LabelComplex& complex, const LabelsRun& run) {
    TriangleMesh stored = asStored(TriangleMesh{complex.points, {}, complex.triangles},
                                   run.format->precision, toFile(run));
    return {std::move(stored.points), std::move(stored.triangles), complex.labels};
}

}  // namespace adaptiso::labels
