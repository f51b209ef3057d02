#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/Extraction/Components.h"
#include "adaptiso/Extraction/Extraction.h"
#include "adaptiso/MeshIO/CoordinateFrame.h"
#include "adaptiso/MeshIO/Formats.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"
#include "adaptiso/MeshQuality/Topology.h"
#include "adaptiso/SurfacePipeline/Verification.h"

namespace adaptiso {

/// Why no surface lies at an isovalue: "no voxel reaches it", or that every voxel does; none when
/// one may. \param range  of the volume's samples
std::optional<std::string> isovalueFault(double isovalue, const ValueRange& range);

/// An isosurface's facts: how it was made, and what is checked of it as its file holds it.
struct SurfaceRecord {
    double isovalue = 0;
    bool isAutomatic = false;         ///< the isovalue was chosen by Otsu's method
    ExtractionStatistics statistics;  ///< of what was simplified: with a count the kept pieces,
                                      ///< else all
    bool choseFirst = false;          ///< pieces, before they were simplified
    bool isPart = false;              ///< pieces were dropped
    std::int64_t madeTriangles = 0;   ///< before the pieces were dropped
    TopologyReport topology;          ///< of the kept pieces
    Vec3 sizeMm;                      ///< along x, y and z of the patient
    double areaMm2 = 0;
    std::optional<double> roundingMm;  ///< largest move of a point by the file's digits;
                                       ///< empty when not measured
    std::optional<double> volumeMm3;   ///< empty with an open border
    std::optional<std::int64_t>
        crossingPairs;  ///< 0 of Method::Adaptive; none when not counted, or too many
    std::optional<std::int64_t> insideOutPieces;  ///< empty with an open border
    std::optional<Verification> verification;     ///< empty when not asked for

    /// The count of maxTriangles or reduction was met; none when none was asked for.
    std::optional<bool> countMet() const {
        if (!statistics.wantedTriangles) return std::nullopt;
        return topology.triangles <= *statistics.wantedTriangles;
    }
    /// Bound on the distance to the surface of marching cubes, both ways, rounding included; none
    /// of methods that prove none.
    std::optional<double> errorBoundMm() const {
        if (!statistics.errorBoundMm) return std::nullopt;
        return *statistics.errorBoundMm + roundingMm.value_or(0);
    }
};

/// Makes a surface: extractSurface() of a volume.
using Extractor = std::function<Extraction(const ExtractionOptions&)>;

/// The surface to be finished. A count asked for (maxTriangles, reduction) is of the pieces that
/// `selection` keeps: these are chosen at full resolution and simplified alone, so that no triangle
/// is spent on what goes, and bound and statistics are theirs. Without a count pieces do not
/// compete: the surface is the extractor's, whole, and finishSurface() drops pieces.
/// \param record  gets statistics, choseFirst, isPart, madeTriangles
/// \throws NothingLeft, InvalidInput  as finishSurface()
/// Cost: where pieces are chosen first, the full-resolution mesh in memory.
TriangleMesh extractPieces(const Extractor& extract, const ExtractionOptions& options,
                           const ComponentSelection& selection, SurfaceRecord& record);

/// The bound that a surface is to keep: the one asked for, or the default; none with a count alone
/// and of other methods.
std::optional<double> requestedBoundMm(const ExtractionOptions& options,
                                       const ImageGeometry& volume);

/// Calls the work that it is given, which is the stage of this name: "pieces", "check",
/// "crossings". For those who show progress or measure time.
using StageRunner = std::function<void(std::string_view stage, const std::function<void()>& work)>;

/// The digits that a surface's file keeps.
struct FileDigits {
    const MeshFormat* format = nullptr;
    AffineTransform toFrame;  ///< LPS mm to the frame of the file
    std::optional<double> requestedBoundMm{};
};

struct FinishOptions {
    ComponentSelection selection;
    Method method = Method::Adaptive;    ///< that made the surface
    Border border = Border::Closed;      ///< of the index that it was made with
    bool countsCrossings = true;         ///< Method::Adaptive has none, whether counted or not
    std::int64_t maxCrossingPairs = 0;   ///< to list
    StageRunner runStage{};              ///< empty: the work is called and nothing else
    std::optional<FileDigits> digits{};  ///< empty before the file is chosen
};

/// Thrown if no piece of a surface is as large as asked for.
class NothingLeft : public InvalidInput {
public:
    using InvalidInput::InvalidInput;
};

/// A format keeps too few digits of a surface's coordinates.
class TooFewDigits : public InvalidInput {
public:
    using InvalidInput::InvalidInput;
};

struct FinishedSurface {
    TriangleMesh mesh;                    ///< LPS mm; to be written in the format of the digits
    std::vector<TrianglePair> crossings;  ///< the first
};

/// Takes an extracted surface to what users get: the pieces that are asked for, settled to the
/// file's digits (settleRounding()), then checked to be sound and measured with these digits.
///
/// \param mesh    extractPieces()'s, not empty; LPS mm
/// \param record  extractPieces()'s; gets isPart, topology, sizeMm, areaMm2, roundingMm, volumeMm3,
///                crossingPairs, insideOutPieces
/// \throws NothingLeft    "no piece of the surface has as much"
/// \throws TooFewDigits   the surface is not sound with the file's digits, or these alone are
/// beyond
///                        the bound asked for
/// \throws InvalidInput   as selectComponents()
/// \throws InternalError  what is left has a defect (but for the open edges of Border::Open), or of
///                        Method::Adaptive a piece that is inside out
FinishedSurface finishSurface(TriangleMesh mesh, const FinishOptions& options,
                              SurfaceRecord& record);

}  // namespace adaptiso
