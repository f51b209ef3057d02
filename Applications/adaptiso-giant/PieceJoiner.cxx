#include "PieceJoiner.h"

#include <algorithm>
#include <optional>

#include "BorderFront.h"
#include "Steps.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso::giant {
namespace {

/// Parts of pieces, joined where they have a vertex in common.
class PartJoiner {
public:
    void add(const PieceSummary& piece) {
        std::vector<std::uint32_t> parts;
        for (const PieceComponent& part : piece.components) {
            parts.push_back(components_.add(
                {part.innerVertices, part.triangles, part.areaMm2, part.volumeMm3, partCount_++}));
        }
        const std::vector<BorderFront::Vertex*> border = front_.add(piece);
        for (std::size_t n = 0; n < border.size(); ++n) {
            const std::uint32_t part = parts[piece.border[n].component];
            if (border[n]->isNew) {
                border[n]->part = part;
                components_.hold(part);
                components_.addVertex(part);
            } else {
                components_.join(border[n]->part, part);
            }
        }
        front_.release(piece, [&](const BorderFront::Vertex& v) { components_.drop(v.part); });
        for (const std::uint32_t part : parts) components_.drop(part);
    }

    void finish(GiantSurface& surface) {
        components_.finishAll();
        surface.openEdges = front_.openEdges();
        surface.totals = components_.totals();
        surface.vertices = surface.totals.vertices;
        surface.components = components_.largest();
    }

private:
    BorderFront front_;
    GrowingComponents components_;
    std::int64_t partCount_ = 0;
};

}  // namespace

PieceJoiner::PieceJoiner(const std::filesystem::path& work, const GiantPlan& plan)
    : work_(work),
      plan_(plan),
      key_(keyOf(plan)),
      stage_(plan.isAdaptive() ? "seam" : "tile"),
      places_(plan.pieces()) {
    requirePieces();
    joinPieces();
}

/// Reads all at once, so that one message lists every missing piece. Soundness is checked later.
void PieceJoiner::requirePieces() const {
    std::int64_t missing = 0;
    std::string first;
    for (const Index3& place : places_) {
        std::error_code error;
        if (std::filesystem::exists(pieceFile(work_, stage_, place), error)) continue;
        if (missing++ == 0) first = idOf(place);
    }
    if (missing == 0) return;
    throw FileError(work_.string() + ": " + formatCount(missing) + " of " +
                    formatCount(std::ssize(places_)) + " pieces are not there, " + first +
                    " the first; run: adaptiso-giant " + stage_ + " " + work_.string());
}

void PieceJoiner::joinPieces() {
    SeamInputs inputs(work_, plan_);
    PartJoiner parts;
    for (const Index3& place : places_) {
        const std::optional<PieceSummary> piece = findPiece(work_, stage_, place, key_);
        const bool isOld = piece && plan_.isAdaptive() && inputs.areChanged(place, piece->inputs);
        if (!piece || isOld) {
            throw FileError(
                pieceFile(work_, stage_, place).string() +
                (isOld ? ": its tiles were made again since" : ": is damaged, or of another plan") +
                "; run: adaptiso-giant " + stage_ + " " + work_.string());
        }
        parts.add(*piece);
        surface_.triangles += piece->triangles;
        ++surface_.pieces;
        surface_.emptyPieces += static_cast<std::int64_t>(piece->triangles == 0);
        surface_.unchangedPieces += static_cast<std::int64_t>(piece->isUnchanged);
        surface_.errorBoundMm = std::max(surface_.errorBoundMm, piece->errorBoundMm);
    }
    parts.finish(surface_);
}

void PieceJoiner::forEachPiece(
    const std::function<void(const Piece&, const std::vector<VertexId>&,
                             const std::vector<std::uint8_t>&)>& f) const {
    BorderFront front;
    VertexId next = 0;
    std::int64_t triangles = 0;
    const auto refuseChanged = [&](const std::string& what) {
        throw FileError(what + ": changed while it was read; run join again");
    };
    for (const Index3& place : places_) {
        const std::filesystem::path file = pieceFile(work_, stage_, place);
        const Piece piece = readPiece(file);
        if (piece.summary.plan != key_ || piece.summary.id != idOf(place) ||
            piece.summary.stage != stage_) {
            refuseChanged(file.string());
        }
        if (piece.mesh.triangles.empty()) continue;
        triangles += piece.summary.triangles;
        const std::vector<BorderFront::Vertex*> border = front.add(piece.summary);
        std::vector<VertexId> number(piece.mesh.points.size(), BorderFront::kNoNumber);
        std::vector<std::uint8_t> isNew(piece.mesh.points.size(), 1);
        for (std::size_t n = 0; n < border.size(); ++n) {
            const std::uint32_t v = piece.summary.border[n].vertex;
            number[v] = border[n]->number;
            isNew[v] = static_cast<std::uint8_t>(border[n]->isNew);
        }
        for (VertexId& n : number) {
            if (n == BorderFront::kNoNumber) n = next++;
        }
        for (std::size_t n = 0; n < border.size(); ++n) {
            border[n]->number = number[piece.summary.border[n].vertex];
        }
        front.release(piece.summary, [](const BorderFront::Vertex&) {});
        f(piece, number, isNew);
    }
    if (next != surface_.vertices || triangles != surface_.triangles) refuseChanged(work_.string());
}

}  // namespace adaptiso::giant
