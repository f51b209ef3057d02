#include "FileRounding.h"

#include <string>
#include <utility>
#include <vector>

#include "Common/Json.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/MeshIO/FrameTransform.h"
#include "adaptiso/SurfacePipeline/StoredMesh.h"

namespace adaptiso {
namespace {

/// A format of files of the run, and what they are called in messages.
struct FileKind {
    const MeshFormat* format;
    std::string files;
    bool isAskedFor = true;
};

std::vector<FileKind> kindsOf(const LabelsRun& run) {
    std::vector<FileKind> kinds{{run.format, "regions/*" + run.options.format}};
    if (run.options.writesLayers) kinds.push_back({&findMeshFormat("wall.tri"), "layers/*.tri"});
    kinds.push_back({&findMeshFormat("all.surf.gii"), "all.surf.gii", false});
    return kinds;
}

}  // namespace

void fitToFiles(LabelComplex& complex, LabelsRun& run) {
    const AffineTransform toFrame = lpsToFrame(run.frame, frameVolume(run.frame, run.map.geometry));
    TriangleMesh walls{std::move(complex.points), {}, std::move(complex.triangles)};
    const std::string input = baseName(run.options.input);
    constexpr int kMostRounds = 3;  // what fits one file may have to move for another
    for (int round = 0; round < kMostRounds; ++round) {
        std::int64_t moved = 0;
        int precisions = 0;
        CoordinatePrecision last = CoordinatePrecision::Float64;
        for (const FileKind& kind : kindsOf(run)) {
            if (kind.format->precision == last || (!kind.isAskedFor && run.leavesGiftiOut)) {
                continue;
            }
            last = kind.format->precision;
            ++precisions;
            const RoundingHarm harm = settleRounding(walls, last, toFrame);
            moved += harm.movedPoints;
            if (!harm) continue;
            const std::string text = kind.files + ": " + textOf(harm, *kind.format);
            if (kind.isAskedFor) throw InvalidInput(input + ": " + text);
            run.leavesGiftiOut = true;
            run.warnings.push_back({"file-left-out", "all.surf.gii is left out; " + text, input});
        }
        if (moved == 0 || precisions < 2) break;
    }
    complex.points = std::move(walls.points);
    complex.triangles = std::move(walls.triangles);
}

}  // namespace adaptiso
