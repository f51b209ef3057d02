#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "Common/Json.h"
#include "adaptiso/Core/Outliers.h"

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
void markOutliers(std::vector<QualityRow>& rows, const OutlierRule& rule);

/// quality.tsv, and quality.json, BIDS's description of its columns.
std::string qualityTable(const std::vector<QualityRow>& rows);
Json qualityDictionary(const OutlierRule& rule);

}  // namespace adaptiso::bids
