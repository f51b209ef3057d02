#include <algorithm>
#include <cstring>
#include <optional>
#include <ostream>

#include "BorderFront.h"
#include "Common/Json.h"
#include "Common/Progress.h"
#include "Common/RunApp.h"
#include "Common/Sha256.h"
#include "Common/Verdict.h"
#include "Steps.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Files/AtomicOutput.h"
#include "adaptiso/ImageIO/ImageRegions.h"

namespace adaptiso::giant {
namespace fs = std::filesystem;

namespace {

/// The share of the bound for the first pass; the second gets the rest. It changes little, and that
/// costs more the smaller its share is; a large share costs triangles everywhere.
constexpr double kTileShare = 0.9;

/// Pieces as one mesh.
class PieceUnion {
public:
    void add(const Piece& piece) {
        constexpr VertexId kNew = -1;
        std::vector<VertexId> number(piece.mesh.points.size(), kNew);
        for (const BorderVertex& v : piece.summary.border) {
            const auto [at, isNew] = known_.try_emplace(v.index, std::ssize(mesh_.points));
            if (isNew) append(piece.mesh, v.vertex);
            number[v.vertex] = at->second;
        }
        for (std::size_t v = 0; v < number.size(); ++v) {
            if (number[v] != kNew) continue;
            number[v] = std::ssize(mesh_.points);
            append(piece.mesh, v);
        }
        for (const auto& [a, b, c] : piece.mesh.triangles) {
            mesh_.triangles.push_back({number[a], number[b], number[c]});
        }
    }
    const TriangleMesh& mesh() const { return mesh_; }

private:
    void append(const TriangleMesh& mesh, std::size_t v) {
        mesh_.points.push_back(mesh.points[v]);
        mesh_.normals.push_back(mesh.normals[v]);
    }

    TriangleMesh mesh_;
    AtPlace<VertexId> known_;
};

/// The pieces that a step made and found.
struct StepCounts {
    std::int64_t made = 0, found = 0, triangles = 0;
};

/// The places asked for, or all.
std::vector<Index3> chosen(const GiantOptions& options, const std::vector<Index3>& all,
                           const char* what) {
    if (options.ids.empty()) return all;
    std::vector<Index3> places;
    for (const std::string& id : options.ids) {
        const std::optional<Index3> place = placeOf(id);
        if (!place || !std::ranges::binary_search(all, orderOf(*place), {}, orderOf)) {
            throw UsageError(id + ": the plan has no " + what + " of this name");
        }
        places.push_back(*place);
    }
    return places;
}

void writePiece(const fs::path& file, const Piece& piece) {
    AtomicOutput output(file, file.parent_path());
    output.writeText(encodePiece(piece));
    AtomicOutput::commit({&output, 1});
}

/// Makes the pieces of one stage, those that are not there yet from the same inputs.
/// \param inputsOf  SHA-256 of what a piece is made of
/// \param make      (place, mesh, summary)
template <class InputsOf, class Make>
int runPieces(const GiantOptions& options, const GiantPlan& plan, const std::string& stage,
              const std::vector<Index3>& places, const InputsOf& inputsOf, const Make& make) {
    const std::string key = keyOf(plan);
    StepCounts counts;
    ProgressLine progress(options.common.isQuiet);
    for (std::size_t n = 0; n < places.size(); ++n) {
        progress.show(stage, static_cast<double>(n) / static_cast<double>(places.size()));
        const Index3& place = places[n];
        const std::string inputs = inputsOf(place);
        const std::optional<PieceSummary> found = findPiece(options.work, stage, place, key);
        if (found && found->inputs == inputs) {
            ++counts.found;
            counts.triangles += found->triangles;
            continue;
        }
        Piece piece;
        piece.summary.plan = key;
        piece.summary.stage = stage;
        piece.summary.id = idOf(place);
        piece.summary.inputs = inputs;
        piece.mesh = make(place, piece.summary);
        summarize(piece.mesh, plan.geometry, piece.summary);
        writePiece(pieceFile(options.work, stage, place), piece);
        ++counts.made;
        counts.triangles += piece.summary.triangles;
    }
    progress.clear();
    Json json = reportHead("adaptiso-giant-step/1", kGiantProgram, {}, {});
    json.update(Json{{"step", stage},
                     {"made", counts.made},
                     {"found", counts.found},
                     {"triangles", counts.triangles},
                     {"peakMemoryMb", peakMemoryMb()}});
    deliverReport(options.common, plan.input, jsonText(json) + "\n", [&](std::ostream& out) {
        out << stage << ": " << formatCount(counts.made) << " made, " << formatCount(counts.found)
            << " found, " << formatCount(counts.triangles) << " triangles\n";
    });
    return kExitOk;
}

/// The image is still the one that was planned for.
void requireSame(const GiantPlan& plan, const ImageRegions& image) {
    if (image.geometry() == plan.geometry && image.pixelType() == plan.pixelType) return;
    throw FileError(plan.input.string() + ": is not the image that was planned for; plan again");
}

TriangleMesh meshOfTile(const GiantPlan& plan, const ImageRegions& image, const Index3& tile,
                        PieceSummary& summary) {
    const TileCut cut = plan.cut();
    const IndexBox box = cut.samplesOf(tile);
    const Volume window = image.read(box.first, box.size());
    if (!plan.isAdaptive()) {
        return extractTile(window, box.first, plan.geometry, plan.isovalue, cut, tile);
    }
    SimplifiedPart part =
        extractSimplifiedTile(window, box.first, plan.geometry, plan.isovalue, cut, tile,
                              kTileShare * plan.maxErrorMm, plan.leavesNoise);
    summary.errorBoundMm = part.errorBoundMm;
    summary.isUnchanged = part.isUnchanged;
    return std::move(part.mesh);
}

TriangleMesh meshOfSeam(const GiantOptions& options, const GiantPlan& plan, const Index3& seam,
                        PieceSummary& summary) {
    PieceUnion tiles;
    double tileBoundMm = 0;
    for (const Index3& tile : tilesAt(plan, seam)) {
        const Piece piece = readPiece(pieceFile(options.work, "tile", tile));
        tileBoundMm = std::max(tileBoundMm, piece.summary.errorBoundMm);
        tiles.add(piece);
    }
    const TileCut cut = plan.cut();
    SeamPart part = seamPartOf(tiles.mesh(), cut, seam);
    const bool isFixed =
        std::find(part.isFixed.begin(), part.isFixed.end(), 0) == part.isFixed.end();
    SimplifiedPart made;
    if (isFixed) {
        made.mesh = std::move(part.mesh);
        made.isKept = std::move(part.isFixed);
    } else {
        made = simplifyInBox(part.mesh, std::move(part.isFixed), plan.geometry, cut.seamBox(seam),
                             plan.maxErrorMm - tileBoundMm);
    }
    summary.errorBoundMm = tileBoundMm + made.errorBoundMm;
    summary.isUnchanged = made.isUnchanged;
    return ownTriangles(made, cut, seam);
}

}  // namespace

int runTileStep(const GiantOptions& options) {
    const ThreadLimit threads(options.common);
    const GiantPlan plan = readPlan(options.work);
    const std::vector<Index3> places = chosen(options, plan.tiles, "tile");
    const ImageRegions image = ImageRegions::open(plan.input, plan.read);
    requireSame(plan, image);
    const TileCut cut = plan.cut();
    return runPieces(
        options, plan, "tile", places,
        [&](const Index3& tile) {
            const IndexBox box = cut.samplesOf(tile);
            return sha256Of(image.stampOf(box.first, box.size()));
        },
        [&](const Index3& tile, PieceSummary& summary) {
            return meshOfTile(plan, image, tile, summary);
        });
}

int runSeamStep(const GiantOptions& options) {
    const ThreadLimit threads(options.common);
    const GiantPlan plan = readPlan(options.work);
    if (!plan.isAdaptive()) {
        throw UsageError("seam: the plan is of --method mc, whose tiles need none; join them");
    }
    SeamInputs inputs(options.work, plan);
    return runPieces(
        options, plan, "seam", chosen(options, plan.seams(), "seam box"),
        [&](const Index3& seam) { return inputs.of(seam); },
        [&](const Index3& seam, PieceSummary& summary) {
            return meshOfSeam(options, plan, seam, summary);
        });
}

}  // namespace adaptiso::giant
