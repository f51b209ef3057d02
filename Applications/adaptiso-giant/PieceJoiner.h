#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "GiantPlan.h"
#include "PieceFile.h"
#include "PieceUnion.h"

namespace adaptiso {

/// A component of the whole surface.
struct GiantComponent {
    std::int64_t vertices = 0, triangles = 0;
    double areaMm2 = 0, volumeMm3 = 0;
    /// Of a closed component.
    std::int64_t eulerNumber() const { return vertices - triangles / 2; }
    bool isCavity() const { return volumeMm3 < 0; }
};

/// What pieces make together, found from their summaries alone.
struct GiantSurface {
    std::int64_t vertices = 0, triangles = 0, openEdges = 0;
    std::int64_t pieces = 0, emptyPieces = 0, unchangedPieces = 0;
    double errorBoundMm = 0;
    std::vector<GiantComponent> components;  ///< largest volume first, cavities last
};

/// Joins pieces: union-find over the components of all of them, through the vertices that they
/// share. Memory: 100 bytes for each border vertex, 60 for each component of a piece.
class PieceJoiner {
public:
    /// \throws FileError  a piece is missing, or damaged
    PieceJoiner(const std::filesystem::path& work, const GiantPlan& plan);

    const GiantSurface& surface() const { return surface_; }
    const std::vector<Index3>& places() const { return places_; }

    /// Calls f(piece, number of each of its vertices in the whole, which of them are new) for every
    /// piece that is not empty, in order. The same each time.
    void forEachPiece(const std::function<void(const Piece&, const std::vector<VertexId>&,
                                               const std::vector<std::uint8_t>&)>& f) const;

private:
    struct EdgeHash {
        std::size_t operator()(const std::array<std::uint64_t, 2>& e) const {
            return (e[0] * 0x9E3779B97F4A7C15u ^ e[1]) * 0xD6E8FEB86659FD93u;
        }
    };
    void readSummaries();
    void joinComponents(const std::vector<PieceSummary>& summaries);

    std::filesystem::path work_;
    const GiantPlan& plan_;
    std::vector<Index3> places_;
    AtPlace<std::uint64_t> borderNumber_;
    GiantSurface surface_;
};

}  // namespace adaptiso
