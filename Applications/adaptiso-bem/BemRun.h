#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "Common/Resources.h"
#include "Common/Warnings.h"
#include "Pipeline.h"
#include "adaptiso-check/HeadNotes.h"
#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/HeadModel/Finding.h"
#include "adaptiso/HeadModel/NestSurfaces.h"
#include "adaptiso/HeadModel/Remesh.h"
#include "adaptiso/MeshQuality/Shape.h"
#include "adaptiso/MeshQuality/Topology.h"

namespace adaptiso {

/// A file that was read.
struct BemInput {
    std::filesystem::path path;
    std::string role;    ///< "t1", "brain mask", "labels", ...
    std::string format;  ///< "NIfTI-1", "STL (binary)", ...
};

/// One surface, from dense to final.
struct BemSurface {
    std::int64_t denseTriangles = 0;  ///< 0: the surface was taken as it came
    /// Of a ready surface that only needs other triangles, and as many.
    std::optional<std::int64_t> ownVertices;
    std::optional<RemeshStatistics> remesh;
    SurfaceMove move;  ///< by nesting
    TopologyReport topology;
    ShapeReport shape;
    std::int64_t crossingPairs = 0;
    double areaMm2 = 0;
    double volumeMm3 = 0;
    double solidAngleShare = 0;
    Vec3 extentMm;
};

/// A promise about the model, kept or not.
struct BemCheck {
    std::string name;  ///< "inner_skull: one closed surface of genus 0"
    bool isPassed = false;
    std::string detail;
    std::optional<Vec3> pointMm;  ///< LPS, where it is not kept
};

/// One run of the program, for the reports.
struct BemRun {
    const BemOptions& options;
    std::vector<BemInput> inputs;
    std::vector<std::string> warnings;   ///< of reading
    std::vector<std::string> notes;      ///< of the image steps
    std::string source;                  ///< "t1", "labels", "probabilities", "ct", "surfaces"
    std::optional<ImageGeometry> image;  ///< the main image's
    std::optional<ImageGeometry> tkRasVolume;  ///< whose tkRAS the FreeSurfer files are in
    std::string tkRasName;                     ///< of that volume, for the footer
    std::vector<BemSurface> surfaces;
    std::vector<NestedGap> gaps;
    std::vector<BemCheck> checks;
    std::vector<ToldNote> plausibility;  ///< what is unusual of adults' heads
    std::vector<Finding> findings;       ///< why there is no model; points in LPS mm
    std::vector<std::pair<std::string, std::uintmax_t>> files;  ///< of the folder
    std::vector<std::filesystem::path> subjectFiles;
    StageTimer timer{};
    std::optional<ReadVolume> shownImage{};  ///< for the report; none unless one is wanted
    std::string reportFailure{};             ///< why there is no page; empty: nothing failed

    bool hasModel() const { return findings.empty(); }
    /// --strict makes the warnings failures: of the model only the report is written.
    bool failsStrict() const { return adaptiso::failsStrict(options.common, warnings); }
};

}  // namespace adaptiso
