#include "QualityTable.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <string_view>
#include <utility>

#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Core/TextCells.h"

namespace adaptiso::bids {
namespace {

struct Column {
    std::string_view name, description, units;
    bool isCompared = false;  ///< with the cohort's median
};

constexpr std::array<Column, kMeasures> kColumns{{
    {"isovalue", "Value of the image at the surface", "arbitrary", true},
    {"vertices", "Number of vertices", "", false},
    {"triangles", "Number of triangles", "", false},
    {"area_mm2", "Area of the surface", "mm^2", true},
    {"volume_mm3", "Volume that the surface encloses", "mm^3", true},
    {"components", "Number of connected pieces, cavities among them", "", false},
    {"genus", "Number of handles", "", false},
    {"crossing_pairs", "Number of pairs of triangles that cross", "", false},
    {"gap_mm", "Least distance from the surface inside this one in a head model", "mm", true},
    {"thickness_mm",
     "Mean thickness of the tissue inside this surface of a head model: the volume between it and "
     "the surface inside it, divided by the mean of the two areas",
     "mm", true},
}};

/// n/a if empty, as BIDS wants.
std::string cell(const std::optional<double>& value) {
    return value && std::isfinite(*value) ? formatNumber(*value) : "n/a";
}

/// Two digits: "31%", "0.52%", "12000%"; of what is infinite "inf%".
std::string percentText(double percent) {
    const double size = std::abs(percent);
    if (!std::isfinite(size)) return "inf%";
    return (size < 10 ? formatShort(std::round(size * 100) / 100) : formatFixed(size, 0)) + "%";
}

/// \pre values is not empty
double medianOf(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const std::size_t half = values.size() / 2;
    return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

std::vector<double> knownOf(std::span<const std::optional<double>> values) {
    std::vector<double> known;
    for (const std::optional<double>& value : values) {
        if (value && std::isfinite(*value)) known.push_back(*value);
    }
    return known;
}

Json described(std::string_view text) {
    return {{"Description", text}};
}

}  // namespace

std::string toString(QualityState state) {
    constexpr const char* kNames[] = {"done", "unsound", "failed", "missing", "leftover"};
    return kNames[static_cast<std::size_t>(state)];
}

void markOutliers(std::vector<QualityRow>& rows, double limit, double leastPercent) {
    std::map<std::pair<std::string, std::string>, std::vector<std::size_t>> alike;
    for (std::size_t n = 0; n < rows.size(); ++n) {
        alike[{rows[n].product, rows[n].part}].push_back(n);
    }
    for (const auto& [of, members] : alike) {
        for (std::size_t k = 0; k < kMeasures; ++k) {
            if (!kColumns[k].isCompared) continue;
            std::vector<std::optional<double>> values;
            for (const std::size_t n : members) values.push_back(rows[n].measures[k]);
            const std::vector<std::optional<double>> scores = robustScores(values);
            const double median = medianOf(values);
            for (std::size_t m = 0; m < members.size(); ++m) {
                if (!scores[m] || !(std::abs(*scores[m]) > limit)) continue;
                const double percent = 100 * (*values[m] - median) / std::abs(median);
                if (std::abs(percent) < leastPercent) continue;
                std::string& marks = rows[members[m]].outliers;
                addPart(marks,
                        std::string(kColumns[k].name) + (*scores[m] > 0 ? ":+" : ":-") +
                            formatFixed(std::abs(*scores[m]), 1) + (percent > 0 ? "(+" : "(-") +
                            percentText(percent) + ")",
                        ",");
            }
        }
    }
}

std::string qualityTable(const std::vector<QualityRow>& rows) {
    std::string text =
        "participant_id\tsession_id\tscan\tproduct\tpart\tname\tstate\treason\tcheck";
    for (const Column& column : kColumns) text += "\t" + std::string(column.name);
    text += "\toutliers\n";
    for (const QualityRow& row : rows) {
        for (const std::string& each : {row.participant, row.session, row.scan, row.product,
                                        row.part, row.name, toString(row.state), row.reason}) {
            text += writtenCell(each) + "\t";
        }
        text += writtenCell(row.check);
        for (const std::optional<double>& value : row.measures) text += "\t" + cell(value);
        text += "\t" + writtenCell(row.outliers) + "\n";
    }
    return text;
}

Json qualityDictionary(double limit, double leastPercent) {
    Json json{{"participant_id", described("Participant")},
              {"session_id", described("Session")},
              {"scan", described("Entities of the image that the surface was made of")},
              {"part", described("Which surface: the isovalue asked for (isoauto: Otsu's), a "
                                 "surface of a head model, or the number of a region")},
              {"name", described("Name of the region")},
              {"reason", described("Why the surface is not there, or what is wrong with it")},
              {"check", described("What adaptiso-check found: passed, or what does not hold")},
              {"outliers",
               described("Columns in which this surface lies more than " + formatNumber(limit) +
                         " robust standard deviations (1.4826 times the median distance from "
                         "the median) and at least " +
                         formatNumber(leastPercent) +
                         " % from the median of all rows of its product and part, each "
                         "with that distance: volume_mm3:+4.2(+31%) is far above it")}};
    json["product"] = described("What was made");
    json["product"]["Levels"] = {{"surfaces", "An isosurface, by adaptiso-mesh"},
                                 {"bem", "A surface of a head model, by adaptiso-bem"},
                                 {"labels", "A region of a label map, by adaptiso-labels"}};
    json["state"] = described("How it stands");
    json["state"]["Levels"] = {
        {"done", "There, of the image, the options and the version of now"},
        {"unsound", "The same, but adaptiso-check found a fault"},
        {"failed", "The run ended with an error, or could not guarantee the result"},
        {"missing", "Not run, not finished, gone, or of another image, options or version"},
        {"leftover", "In the output, but the image that it was made of is not in the dataset"}};
    for (const Column& column : kColumns) {
        Json& one = json[std::string(column.name)] = described(column.description);
        if (!column.units.empty()) one["Units"] = column.units;
    }
    return json;
}

double medianOf(std::span<const std::optional<double>> values) {
    std::vector<double> known = knownOf(values);
    return known.empty() ? std::nan("") : medianOf(std::move(known));
}

std::vector<std::optional<double>> robustScores(std::span<const std::optional<double>> values) {
    constexpr std::size_t kFewest = 5;          // of four, one is no exception
    constexpr double kOfNormal = 1.4826;        // MAD of a normal distribution is 1 / this
    constexpr double kOfNormalMean = 1.253314;  // its mean distance is 1 / this: sqrt(pi / 2)
    std::vector<std::optional<double>> scores(values.size());
    const std::vector<double> known = knownOf(values);
    if (known.size() < kFewest) return scores;
    const double median = medianOf(known);
    std::vector<double> distances;
    for (const double value : known) distances.push_back(std::abs(value - median));
    double scale = kOfNormal * medianOf(distances);
    if (!(scale > 0)) {
        std::sort(distances.begin(), distances.end());  // one sum, whatever the order
        scale = kOfNormalMean * std::accumulate(distances.begin(), distances.end(), 0.0) /
                static_cast<double>(distances.size());
    }
    if (!(scale > 0)) return scores;
    for (std::size_t n = 0; n < values.size(); ++n) {
        if (values[n] && std::isfinite(*values[n])) scores[n] = (*values[n] - median) / scale;
    }
    return scores;
}

}  // namespace adaptiso::bids
