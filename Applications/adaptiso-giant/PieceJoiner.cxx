#include "PieceJoiner.h"

#include <algorithm>
#include <map>
#include <unordered_set>

#include "Steps.h"
#include "adaptiso/Core/DisjointSets.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Numbers.h"

namespace adaptiso {

PieceJoiner::PieceJoiner(const std::filesystem::path& work, const GiantPlan& plan)
    : work_(work), plan_(plan), places_(plan.pieces()) {
    readSummaries();
}

void PieceJoiner::readSummaries() {
    const std::string key = keyOf(plan_), stage = plan_.isAdaptive() ? "seam" : "tile";
    std::vector<PieceSummary> summaries;
    std::int64_t missing = 0;
    std::string first;
    for (const Index3& place : places_) {
        std::optional<PieceSummary> found = findPiece(work_, stage, place, key);
        if (found) {
            summaries.push_back(std::move(*found));
        } else if (missing++ == 0) {
            first = idOf(place);
        }
    }
    if (missing > 0) {
        throw FileError(work_.string() + ": " + formatCount(missing) + " of " +
                        formatCount(std::ssize(places_)) +
                        " pieces are not there, or of another plan, " + first +
                        " the first; run: adaptiso-giant " + stage + " " + work_.string());
    }
    joinComponents(summaries);
}

void PieceJoiner::joinComponents(const std::vector<PieceSummary>& summaries) {
    std::int64_t parts = 0;
    for (const PieceSummary& summary : summaries) parts += std::ssize(summary.components);
    DisjointSets sets(parts);
    std::vector<std::int64_t> partOfBorder;  // the first that has the vertex
    std::unordered_set<std::array<std::uint64_t, 2>, EdgeHash> open;
    std::int64_t firstPart = 0;
    for (const PieceSummary& summary : summaries) {
        std::vector<std::uint64_t> number;
        for (const BorderVertex& v : summary.border) {
            const auto [at, isNew] = borderNumber_.try_emplace(v.index, borderNumber_.size());
            number.push_back(at->second);
            if (isNew) {
                partOfBorder.push_back(firstPart + v.component);
            } else {
                sets.join(partOfBorder[at->second], firstPart + v.component);
            }
        }
        for (const auto& [a, b] : summary.borderEdges) {
            if (open.erase({number[b], number[a]}) == 0) open.insert({number[a], number[b]});
        }
        firstPart += std::ssize(summary.components);
        surface_.triangles += summary.triangles;
        ++surface_.pieces;
        surface_.emptyPieces += static_cast<std::int64_t>(summary.triangles == 0);
        surface_.unchangedPieces += static_cast<std::int64_t>(summary.isUnchanged);
        surface_.errorBoundMm = std::max(surface_.errorBoundMm, summary.errorBoundMm);
    }
    surface_.openEdges = std::ssize(open);
    std::map<std::int64_t, GiantComponent> components;
    firstPart = 0;
    for (const PieceSummary& summary : summaries) {
        for (const PieceComponent& part : summary.components) {
            GiantComponent& whole = components[sets.find(firstPart++)];
            whole.triangles += part.triangles;
            whole.vertices += part.innerVertices;
            whole.areaMm2 += part.areaMm2;
            whole.volumeMm3 += part.volumeMm3;
        }
    }
    for (const std::int64_t part : partOfBorder) ++components[sets.find(part)].vertices;
    for (const auto& [name, component] : components) {
        surface_.vertices += component.vertices;
        surface_.components.push_back(component);
    }
    std::stable_sort(
        surface_.components.begin(), surface_.components.end(),
        [](const GiantComponent& a, const GiantComponent& b) { return a.volumeMm3 > b.volumeMm3; });
}

void PieceJoiner::forEachPiece(
    const std::function<void(const Piece&, const std::vector<VertexId>&,
                             const std::vector<std::uint8_t>&)>& f) const {
    constexpr VertexId kNone = -1;
    std::vector<VertexId> ofBorder(borderNumber_.size(), kNone);
    VertexId next = 0;
    const std::string stage = plan_.isAdaptive() ? "seam" : "tile";
    for (const Index3& place : places_) {
        const Piece piece = readPiece(pieceFile(work_, stage, place));
        if (piece.mesh.triangles.empty()) continue;
        std::vector<VertexId> number(piece.mesh.points.size(), kNone);
        std::vector<std::uint8_t> isNew(piece.mesh.points.size(), 1);
        for (const BorderVertex& v : piece.summary.border) {
            const auto at = borderNumber_.find(v.index);
            if (at == borderNumber_.end()) {
                throw FileError(pieceFile(work_, stage, place).string() +
                                ": changed while it was read; run join again");
            }
            number[v.vertex] = ofBorder[at->second];
            isNew[v.vertex] = static_cast<std::uint8_t>(number[v.vertex] == kNone);
        }
        for (VertexId& n : number) {
            if (n == kNone) n = next++;
        }
        for (const BorderVertex& v : piece.summary.border) {
            ofBorder[borderNumber_.at(v.index)] = number[v.vertex];
        }
        f(piece, number, isNew);
    }
}

}  // namespace adaptiso
