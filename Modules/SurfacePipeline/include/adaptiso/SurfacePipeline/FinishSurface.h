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
#include "adaptiso/MeshQuality/SelfIntersection.h"
#include "adaptiso/MeshQuality/Topology.h"

namespace adaptiso {

/// Why no surface lies at an isovalue: "no voxel reaches it", or that every voxel does; none when
/// one may. \param range  of the volume's samples
std::optional<std::string> isovalueFault(double isovalue, const ValueRange& range);

/// What measuring a surface against the one at full resolution has found.
struct Verification {
    std::int64_t samples = 0;  ///< points at which distances were measured, both ways
    double maxMm = 0;          ///< the largest of them
};

/// What is known of an isosurface: how it was made, what was kept of it, and that it is sound.
struct SurfaceRecord {
    double isovalue = 0;
    bool isAutomatic = false;             ///< the isovalue was chosen by Otsu's method
    ExtractionStatistics statistics;      ///< of the whole surface, before pieces were dropped
    std::int64_t extractedTriangles = 0;  ///< likewise
    TopologyReport topology;              ///< of what is kept
    double areaMm2 = 0;
    std::optional<double> volumeMm3;            ///< none of an open surface
    std::optional<std::int64_t> crossingPairs;  ///< 0 of Method::Adaptive; none when not counted
    std::optional<Verification> verification;   ///< none when not asked for

    /// The count of maxTriangles or reduction was met; none when none was asked for.
    std::optional<bool> countMet() const {
        if (!statistics.wantedTriangles) return std::nullopt;
        return extractedTriangles <= *statistics.wantedTriangles;
    }
};

/// Calls the work that it is given, which is the stage of this name: "pieces", "check",
/// "crossings". For those who show progress or measure time.
using StageRunner = std::function<void(std::string_view stage, const std::function<void()>& work)>;

struct FinishOptions {
    ComponentSelection selection;
    Method method = Method::Adaptive;   ///< that made the surface
    Border border = Border::Closed;     ///< of the index that it was made with
    bool countsCrossings = true;        ///< Method::Adaptive has none, whether counted or not
    std::int64_t maxCrossingPairs = 0;  ///< to list
    StageRunner runStage{};             ///< empty: the work is called and nothing else
};

/// No piece of a surface is as large as asked for.
class NothingLeft : public InvalidInput {
public:
    using InvalidInput::InvalidInput;
};

struct FinishedSurface {
    TriangleMesh mesh;                    ///< LPS mm
    std::vector<TrianglePair> crossings;  ///< the first
};

/// Takes an extracted surface to what users get: the pieces that are asked for, checked to be
/// sound, measured.
///
/// \param mesh    extractSurface()'s, not empty; LPS mm
/// \param record  gets topology, areaMm2, volumeMm3, crossingPairs
/// \throws NothingLeft    "no piece of the surface has as much"
/// \throws InvalidInput   as selectComponents()
/// \throws InternalError  what is left has a defect (but for the open edges of Border::Open)
FinishedSurface finishSurface(TriangleMesh mesh, const FinishOptions& options,
                              SurfaceRecord& record);

}  // namespace adaptiso
