#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Options.h"
#include "adaptiso/Core/Progress.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Extraction/Components.h"

namespace adaptiso {

/// Aims of mend(). Lengths are in the mesh's own unit, which need not be the millimetre.
struct MendOptions {
    /// Bound of the distance between input and result, both ways, but for what MendStatistics
    /// lists. Empty: kPartOfDiagonal of the diagonal of the mesh's box. \pre at least
    /// kLeastOfDiagonal of it
    std::optional<double> maxErrorMm;
    /// Widest hole to close, as MendedPlace::spanMm. Empty: kHoleOfDiagonal of the mesh's diagonal.
    /// \pre >= 0
    std::optional<double> maxHoleMm;
    bool leavesHolesOpen = false;  ///< wider holes stay open; otherwise they are refused
    /// Handles are cut or filled, until every piece is of genus 0. \pre not leavesHolesOpen
    bool removesHandles = false;
    /// Pieces of the result that stay. \pre not leavesHolesOpen, unless all do
    ComponentSelection pieces{};
    ProgressCallback progress;  ///< called as the work goes on; may be empty

    static constexpr double kPartOfDiagonal = 0.002, kHoleOfDiagonal = 0.05,
                            kLeastOfDiagonal = 1e-5;
};

/// A row for each; those of `pieces` are pieceOptions().
const Options<MendOptions>& mendOptions();

/// A stretch of surface that the bound does not hold for.
struct MendedPlace {
    Vec3 middleMm;      ///< of its box
    double spanMm = 0;  ///< largest extent along the edges and diagonals of a cube
    double areaMm2 = 0;
    std::int64_t triangles = 0;  ///< pieces of triangles that make it up
};

/// What mend() found, what it changed, and the distances proved for the result.
struct MendStatistics {
    bool wasSound = false;  ///< the result is the input

    // found in the input
    std::int64_t brokenTriangles = 0;  ///< name a point that is not there or not finite: dropped
    std::int64_t degenerateTriangles = 0;  ///< without area: dropped
    std::int64_t duplicateTriangles = 0;   ///< on the corners of another: dropped
    std::int64_t mergedPoints = 0;         ///< of borders, at or near the place of another: merged
    std::int64_t flippedTriangles = 0;     ///< faced the other way than their surface
    std::int64_t borderEdges = 0;          ///< in one triangle
    std::int64_t badEdges = 0;     ///< in three triangles or more, or between two of a Moebius band
    std::int64_t badVertices = 0;  ///< that join triangles by themselves alone
    std::int64_t crossingTriangles = 0;  ///< that cross others, or lie near too many to be tested
    std::int64_t handles = 0;            ///< of the mended surface; 0 unless they are to be removed

    // done
    double latticeMm = 0;               ///< spacing of the lattice of new surface; 0: none was made
    std::int64_t cells = 0;             ///< of the lattice where surface is new
    std::int64_t keptTriangles = 0;     ///< of the input, corners and all
    std::int64_t cutTriangles = 0;      ///< of the input, cut: as they cross, or new surface begins
    std::vector<MendedPlace> filled;    ///< new surface that closes holes, the widest first
    std::vector<MendedPlace> leftOpen;  ///< holes wider than maxHoleMm
    std::vector<MendedPlace> inner;     ///< of the input, within the solid: dropped, widest first
    std::vector<MendedPlace> thin;      ///< of the input, too thin to be kept: dropped
    std::vector<MendedPlace> droppedPieces;  ///< that MendOptions::pieces leaves out, widest first
    /// Handles that were cut or filled, by the flat disc that does, the widest first.
    std::vector<MendedPlace> cutHandles, filledHandles;

    double movedMm = 0;  ///< no point was farther from the one it became

    // proved, movedMm included
    double maxErrorMm = 0;  ///< that was asked for
    /// No point of the result, `filled` and the discs at handles aside, is farther from the input.
    double resultToInputMm = 0;
    /// No point of the input, `inner`, `thin` and `droppedPieces` aside, is farther from the
    /// result. Triangles without area are not asked.
    double inputToResultMm = 0;
};

struct Mended {
    TriangleMesh mesh;  ///< without normals, unless it is the input
    MendStatistics statistics;
};

/// A mesh that can't be mended as asked.
class MendRefusal : public InvalidInput {
public:
    MendRefusal(const std::string& what, MendStatistics found)
        : InvalidInput(what), statistics(std::move(found)) {}

    MendStatistics statistics;  ///< what was found
};

/// A closed, oriented 2-manifold that does not cross itself, made of any triangles: with holes,
/// crossings, doubled or flipped parts, triangles that share no vertices.
///
/// The solid is where the winding number [Jacobson2013], summed by a tree of dipoles [Barill2018],
/// is at least a half. Where the input is its border, and sound, it is kept to the bit. Triangles
/// of a closed surface that cross are cut where they meet [Zhou2016]. Around other faults it is cut
/// along the cells of a lattice, and the cells are filled by marching cubes of the winding number,
/// whose vertices lie where lattice edges cross the input; on the cells' outer faces new surface
/// ends in the very line along which the input was cut [Bischoff2005]. Cells are added where that
/// line is not a single one, or does not part the winding numbers.
///
/// Every vertex of a sound input comes back; the mesh itself where nothing is to be mended.
/// \pre  the mesh has a triangle with an area \throws InvalidInput otherwise
/// \throws MendRefusal  it encloses no volume; a hole is wider than maxHoleMm; the bound can't be
///                      held; no flat disc cuts or fills a handle
/// Cost: O(T log T), some 100 us for each triangle that crosses, and 20 us for each cell; cells go
/// with the area of what is mended over maxErrorMm squared. The same input gives the same bytes,
/// whatever the number of threads.
Mended mend(const TriangleMesh& mesh, const MendOptions& options = {});

/// A point of `mesh` is not finite, or a triangle names one that is not there.
bool isBroken(const TriangleMesh& mesh);

/// Drops triangles that name such points, as mend() does, and moves points that are not finite to
/// where others are. Points keep their numbers. \return how many triangles went
std::int64_t dropBrokenTriangles(TriangleMesh& mesh);

}  // namespace adaptiso
