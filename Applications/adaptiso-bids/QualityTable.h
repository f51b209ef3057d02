#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "Common/Json.h"

namespace adaptiso {

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

/// How what was asked for stands.
enum class QualityState { Done, Unsound, Failed, Missing, Leftover };

/// "done"
std::string toString(QualityState state);

/// One surface, or what should be there in its place.
struct QualityRow {
    std::string participant, session;  ///< "sub-01", "ses-2"; empty: none
    std::string scan;                  ///< "sub-01_ses-2_acq-hi"; empty: there is none
    std::string product;               ///< "surfaces", "bem", "labels"
    std::string part;                  ///< "iso100", "isoauto", "inner_skull", "5"; empty: of all
    std::string name;                  ///< of a region; empty: none
    QualityState state{};
    std::string reason;  ///< why it is not done; empty: it is
    std::string check;   ///< what adaptiso-check said; empty: it was not asked
    std::array<std::optional<double>, kMeasures> measures{};
    std::string outliers;  ///< "volume_mm3:+4.2(+31%)"; empty: none

    std::optional<double>& operator[](Measure measure) {
        return measures[static_cast<std::size_t>(measure)];
    }
};

/// Fills `outliers`: each row is compared with those of its product and part.
/// \param limit         robust standard deviations from the median
/// \param leastPercent  of the median: what lies nearer to it is no outlier
void markOutliers(std::vector<QualityRow>& rows, double limit, double leastPercent = 1);

/// quality.tsv, and quality.json, which says what its columns are, as BIDS has it.
std::string qualityTable(const std::vector<QualityRow>& rows);
Json qualityDictionary(double limit, double leastPercent = 1);

}  // namespace adaptiso
