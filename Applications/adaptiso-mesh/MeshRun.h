#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "Common/Resources.h"
#include "Common/Verdict.h"
#include "Common/Warnings.h"
#include "Pipeline.h"
#include "adaptiso/Core/TriangleMesh.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/Core/Warning.h"
#include "adaptiso/MeshIO/Formats.h"
#include "adaptiso/MeshQuality/SelfIntersection.h"
#include "adaptiso/SurfacePipeline/FinishSurface.h"

namespace adaptiso {

/// What the surfaces are made from when that is not the volume as read.
struct PreprocessedSummary {
    ImageGeometry geometry;
    PixelType pixelType{};
    ValueRange range{};
};

/// What is known of the volume once it has been read.
struct InputSummary {
    std::string format;
    ImageGeometry geometry;
    PixelType pixelType{};
    ValueRange range{};
    std::vector<Warning> warnings;
};

/// The index over the blocks.
struct IndexSummary {
    BlockSearchKind search{};
    std::size_t memoryBytes = 0;
};

/// What is known of one surface once it has been written.
struct SurfaceSummary : SurfaceRecord {
    std::filesystem::path file;
    const MeshFormat* format = nullptr;
    CoordinateFrame frame{};
    std::uintmax_t bytes = 0;
};

/// A surface to show.
struct ShownSurface {
    TriangleMesh mesh;                    ///< LPS mm, as written
    std::vector<TrianglePair> crossings;  ///< the first
};

/// What --strict means for the surfaces, where there is a warning.
inline constexpr const char* kNotWritten = "so no surface was written";

/// One run of the program, for the reports.
struct MeshRun {
    const MeshOptions& options;
    InputSummary input;
    std::optional<PreprocessedSummary> preprocessed;
    IndexSummary index;
    std::vector<SurfaceSummary> surfaces;
    StageTimer timer;
    std::vector<ShownSurface> shown{};  ///< for the page; empty unless one is wanted
    std::vector<Warning> warnings{};    ///< all; each names its file
    Verdict verdict{};                  ///< how the run ends, known before the reports are made

    /// --strict makes the warnings failures: no surface is written.
    bool failsStrict() const { return adaptiso::failsStrict(options.common, warnings); }
    /// Of the values that the surfaces are made from.
    const ValueRange& range() const { return preprocessed ? preprocessed->range : input.range; }
};

}  // namespace adaptiso
