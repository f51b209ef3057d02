#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "Common/Json.h"

namespace adaptiso::bids {

/// The numbers of a row, in their order.
enum class Measure {
    Isovalue,
    Vertices,
    Triangles,
    AreaMm2,
    VolumeMm3,
    Components,
    Genus,
    CrossingPairs,
    GapMm,
    ThicknessMm
};
inline constexpr std::size_t kMeasures = 10;

/// The state of a result that was asked for.
enum class QualityState { Done, Unsound, Failed, Missing, Leftover };

/// "done"
std::string toString(QualityState state);

/// One surface, or its place in the table if it is missing.
struct QualityRow {
    std::string participant, session{};  ///< "sub-01", "ses-2"; may be empty
    std::string scan{};                  ///< "sub-01_ses-2_acq-hi"; may be empty
    std::string product{};               ///< "surfaces", "bem", "labels"
    std::string part{};                  ///< "iso100", "isoauto", "inner_skull", "5"; may be empty
    std::string name{};                  ///< of a region; may be empty
    QualityState state{};
    std::string reason{};  ///< why it is not done
    std::string check{};   ///< the result of adaptiso-check; may be empty
    std::array<std::optional<double>, kMeasures> measures{};
    std::string outliers{};  ///< "volume_mm3:+4.2(+31%)"; may be empty

    std::optional<double>& operator[](Measure measure) {
        return measures[static_cast<std::size_t>(measure)];
    }
};

/// Fills `outliers` by comparing each row with those of its product and part.
/// \param limit         robust standard deviations from the median
/// \param leastPercent  of the median; nearer values are no outliers
void markOutliers(std::vector<QualityRow>& rows, double limit, double leastPercent = 1);

/// quality.tsv, and quality.json, BIDS's description of its columns.
std::string qualityTable(const std::vector<QualityRow>& rows);
Json qualityDictionary(double limit, double leastPercent = 1);

/// The median of the known values; NaN if there are none.
double medianOf(std::span<const std::optional<double>> values);

/// Returns the distance of each value from the median, in robust standard deviations.
///
/// The modified z-score [IglewiczHoaglin1993]: (x - median) / (1.4826 MAD), MAD being the median
/// distance from the median; where more than half of the values are equal, so that it is 0, the
/// mean distance times 1.2533 replaces it. Up to half of the values may be wrong without moving the
/// scale much.
/// \return  empty for a missing value; all empty if fewer than 5 values are there, or all are equal
std::vector<std::optional<double>> robustScores(std::span<const std::optional<double>> values);

}  // namespace adaptiso::bids
