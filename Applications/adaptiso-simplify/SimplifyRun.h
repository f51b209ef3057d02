#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "Common/Resources.h"
#include "Common/Verdict.h"
#include "Common/Warnings.h"
#include "Findings.h"
#include "Pipeline.h"
#include "adaptiso/Core/Warning.h"
#include "adaptiso/MeshIO/Formats.h"
#include "adaptiso/MeshIO/MeshFile.h"
#include "adaptiso/MeshIO/PointData.h"
#include "adaptiso/MeshQuality/Topology.h"
#include "adaptiso/SurfacePipeline/FinishSurface.h"

namespace adaptiso::simplifier {

/// A surface as a file has it.
struct SurfaceSummary {
    std::filesystem::path file;
    const MeshFormat* format = nullptr;
    std::optional<CoordinateFrame> frame;  ///< none: the file does not say
    std::int64_t triangles = 0, vertices = 0;
    TopologyReport topology;
    double areaMm2 = 0;
};

/// Values that were taken along in a file of their own.
struct DataSummary {
    std::filesystem::path file, output;
    PointDataFormat format{};
    std::int64_t arrays = 0;
    bool areLabels = false;  ///< all of them
};

/// What --strict means for the surface, where there is a warning.
inline constexpr const char* kNotWritten = "so no surface was written";

/// One run of the program, for the reports.
struct SimplifyRun {
    const SimplifyCommand& command;
    SurfaceSummary input{};
    std::vector<Finding> findings{};  ///< what is not sound of the input; empty: it is sound
    /// Of the result; all of it none (`output.triangles` 0) of a surface that was refused.
    SurfaceSummary output{};
    SimplifyStatistics statistics{};
    double roundingMm = 0;                       ///< largest move of a point by the output's digits
    std::optional<Verification> verification{};  ///< of the surface as written
    std::uintmax_t bytes = 0;                    ///< of the output
    std::vector<std::string> keptArrays{};       ///< values at points in the surface's own file
    std::vector<DataSummary> data{};
    StageTimer timer{};
    std::vector<Warning> warnings{};  ///< all; each names its file
    Verdict verdict{};                ///< how the run ends, known before the reports are made

    /// --require-sound, and it is not.
    bool failsSoundness() const { return command.requiresSound && !isSound(findings); }
    /// --strict makes the warnings failures.
    bool failsStrict() const { return adaptiso::failsStrict(command.common, warnings); }
    /// Bound on the distance between input and output as written, both ways.
    double errorBoundMm() const { return statistics.errorBoundMm + roundingMm; }
    bool writesSurface() const { return !failsSoundness() && !failsStrict(); }
    /// The count of --triangles or --reduction was met; none when none was asked for.
    std::optional<bool> countMet() const {
        if (!statistics.wantedTriangles) return std::nullopt;
        return output.triangles <= *statistics.wantedTriangles;
    }
};

}  // namespace adaptiso::simplifier
