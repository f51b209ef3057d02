#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "Common/ProgramRun.h"
#include "Pipeline.h"
#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/Core/Warning.h"
#include "adaptiso/LabelNames/LabelTable.h"
#include "adaptiso/Labels/Labels.h"
#include "adaptiso/MeshIO/Formats.h"
#include "adaptiso/Tetrahedra/Tetrahedra.h"

namespace adaptiso::labels {

/// A region and its surface.
struct Region {
    Label label = 0;
    std::string name;          ///< "region 5" where no table names it
    std::string abbreviation;  ///< empty: none
    LabelColor color{};
    bool hasOwnName = false;
    std::int64_t voxels = 0;
    RegionMeasure measure;
    std::string file;  ///< in the output folder: "regions/5.vtp"
};

/// A promise about the walls, kept or not.
struct LabelsCheck {
    std::string name;  ///< "no two triangles cross"
    bool isPassed = true;
    std::string finding{};         ///< empty when passed
    std::vector<Vec3> pointsMm{};  ///< LPS, the first places where it is not kept
};

/// The source of names and colours.
struct NamesSummary {
    std::string format;              ///< empty: no table
    std::vector<std::string> files;  ///< without folders
};

/// The label map as read.
struct MapSummary {
    std::string format;
    ImageGeometry geometry;
    PixelType pixelType{};
    ValueRange range{};
    std::vector<Warning> warnings;
    std::int64_t labels = 0;  ///< other than 0, before any are merged
};

/// The regions in tetrahedra.
struct RegionTetrahedra {
    TetrahedralMesh mesh;                   ///< LPS mm
    std::vector<TetrahedraRegion> regions;  ///< in the order of LabelsRun::regions
    TetrahedraReport report;
};

/// One run of the program, for the reports.
struct LabelsRun : ProgramRun {
    LabelsRun(const LabelsOptions& given, std::filesystem::path output)
        : ProgramRun("adaptiso-labels", given.common, given.report, "so no surface was written"),
          options(given),
          folder(std::move(output)) {}

    const LabelsOptions& options;
    std::filesystem::path folder;  ///< the output
    bool isScene = false;          ///< it is one file of all regions
    const MeshFormat* format = nullptr;
    CoordinateFrame frame{};
    double scale = 1;  ///< of the file's coordinates, and of all lengths, areas and volumes here
    MapSummary map{};
    JoinedMasks joined{};
    LabelIds ids{};
    NamesSummary names{};
    LabelStatistics statistics{};
    std::int64_t points = 0, triangles = 0;     ///< of the walls
    std::vector<Region> regions{};              ///< those that are wanted, by label
    std::map<Label, std::string> otherNames{};  ///< of the map's other labels, where they have one
    std::vector<LabelsCheck> checks{};
    std::optional<RegionTetrahedra> tetrahedra{};                 ///< if wanted
    std::vector<std::pair<std::string, std::uintmax_t>> files{};  ///< files of the folder, by name
    bool leavesGiftiOut = false;                                  ///< its digits do not do
    double roundingMm = 0;       ///< largest move of a point by the digits of regions and layers
    double giftiRoundingMm = 0;  ///< by those of all.surf.gii

    bool holdsPromises() const {
        for (const LabelsCheck& check : checks) {
            if (!check.isPassed) return false;
        }
        return true;
    }
    bool writesFolder() const { return holdsPromises() && !failsStrict(); }

    /// The bound that the walls must keep; empty with a count alone and at full resolution.
    std::optional<double> requestedBoundMm() const {
        if (options.aims.maxErrorMm == 0.0) return std::nullopt;
        if (options.aims.maxErrorMm || options.aims.maxTriangles || options.aims.reduction) {
            return options.aims.maxErrorMm;
        }
        return LabelOptions::kDefaultMaxErrorVoxels * leastPlaneDistanceMm(map.geometry);
    }
    /// Bound on the distance between the walls, as regions and layers hold them, and the full
    /// resolution.
    double errorBoundMm() const { return statistics.errorBoundMm + roundingMm; }

    /// The region of a label; nullptr: it is not among those wanted.
    const Region* find(Label label) const;
    /// "Precentral_L (1)", "1" of one without a name, "outside" of 0
    std::string nameOf(Label label) const;
};

/// The report of --json, as README.md describes it.
std::string jsonReport(const LabelsRun& run);

/// The report for the output folder: the same without what differs from run to run (seconds,
/// memory, threads, the folder's name), so that the same input and options give the same bytes.
std::string folderReport(const LabelsRun& run);

/// Prints the text report.
void printReport(std::ostream& out, const LabelsRun& run);

}  // namespace adaptiso::labels
