#pragma once

#include <cstdint>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "Common/Verdict.h"
#include "Pipeline.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/Core/Warning.h"
#include "adaptiso/ImageIO/ListSeries.h"
#include "adaptiso/ImageIO/SampleStatistics.h"

namespace adaptiso::mesher {

/// Holds whole numbers.
bool isInteger(PixelType type);

/// How an image's axes lie in space.
struct AxesSummary {
    std::string orientation;  ///< where i, j and k lead, nearest: "LPS", "RAS", ...
    Vec3 anglesDeg;           ///< between j and k, k and i, i and j
    double tiltDeg = 0;       ///< between k and the normal of i and j

    /// Not at right angles, by more than headers round.
    bool isSheared() const;
};
AxesSummary summarizeAxes(const ImageGeometry& geometry);

/// Statistics of an image's values, for --info.
struct ValueSummary {
    std::int64_t finite = 0;
    std::int64_t notFinite = 0;                ///< NaN or infinite
    std::vector<double> percentiles;           ///< of kPercents; empty when none is finite
    std::optional<SampleHistogram> histogram;  ///< none when all are equal, or none is finite
    std::vector<std::vector<double>> otsu;     ///< one, two and three thresholds, or none
};
inline constexpr double kPercents[] = {0, 0.1, 1, 5, 25, 50, 75, 95, 99, 99.9, 100};
ValueSummary summarizeValues(const VolumeView& volume);

/// Content of the --info report.
struct ImageInfo {
    std::string fault;  ///< why the image is refused, its path left out; the rest is empty then
    std::string format;
    std::vector<Warning> warnings;
    Index3 sizeAsRead{};
    ImageGeometry geometry;  ///< as preprocessed, like all that follows
    PixelType pixelType{};
    ValueSummary values;
    std::vector<std::string> refusals;  ///< what making a surface would be refused for
    std::optional<DicomSeries> series;  ///< with --show-phi, of DICOM
};

/// The warnings, each with the image's name.
std::vector<Warning> namedWarnings(const MeshOptions& options, const ImageInfo& info);

/// Tells what adaptiso-mesh would read: geometry, values, thresholds.
/// \return kExitOk; kExitCheckFailed with --strict and warnings
/// \throws Error  as reading and preprocessing do, once the report has been delivered that says so
int runInfo(const MeshOptions& options);

/// --info for people.
void printInfo(std::ostream& out, const MeshOptions& options, const ImageInfo& info);

/// --info for machines, as README.md documents it.
std::string infoJson(const MeshOptions& options, const ImageInfo& info, const Verdict& verdict);

}  // namespace adaptiso::mesher
