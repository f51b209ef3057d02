#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "GiantPlan.h"
#include "GrowingComponents.h"
#include "PieceFile.h"

namespace adaptiso::giant {

/// The surface that all pieces form, found from their summaries alone.
struct GiantSurface {
    std::int64_t vertices = 0, triangles = 0, openEdges = 0;
    std::int64_t pieces = 0, emptyPieces = 0, unchangedPieces = 0;
    double errorBoundMm = 0;
    GiantTotals totals;
    std::vector<GiantComponent> components;  ///< the largest 1,000 volumes, cavities last
};

/// Joins pieces: union-find over the components of all of them, through the vertices that they
/// share. Pieces come one by one, in layers of z, and what is finished is forgotten (BorderFront,
/// GrowingComponents): memory grows with a layer, not with the volume.
class PieceJoiner {
public:
    /// \throws FileError  a piece is missing, damaged, or made of tiles that have changed since
    PieceJoiner(const std::filesystem::path& work, const GiantPlan& plan);

    const GiantSurface& surface() const { return surface_; }

    /// Calls f(piece, number of each of its vertices in the whole, which of them are new) for every
    /// piece that is not empty, in order. The same each time.
    /// \throws FileError  a piece is not what it was
    void forEachPiece(const std::function<void(const Piece&, const std::vector<VertexId>&,
                                               const std::vector<std::uint8_t>&)>& f) const;

private:
    void requirePieces() const;
    void joinPieces();

    std::filesystem::path work_;
    const GiantPlan& plan_;
    std::string key_, stage_;
    std::vector<Index3> places_;
    GiantSurface surface_;
};

}  // namespace adaptiso::giant
