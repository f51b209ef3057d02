#include "QualityTable.h"

#include <algorithm>
#include <cmath>
#include <map>
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

Json described(std::string_view text) {
    return {{"Description", text}};
}

}  // namespace

std::string toString(QualityState state) {
    constexpr const char* kNames[] = {"done", "unsound", "failed", "missing", "leftover"};
    return kNames[static_cast<std::size_t>(state)];
}

void markOutliers(std::vector<QualityRow>& rows, const OutlierRule& rule) {
    std::map<std::pair<std::string, std::string>, std::vector<std::size_t>> alike;
    for (std::size_t n = 0; n < rows.size(); ++n) {
        alike[{rows[n].product, rows[n].part}].push_back(n);
    }
    for (const auto& [of, members] : alike) {
        for (std::size_t k = 0; k < kMeasures; ++k) {
            if (!kColumns[k].isCompared) continue;
            std::vector<std::optional<double>> values;
            for (const std::size_t n : members) values.push_back(rows[n].measures[k]);
            for (const Outlier& found : findOutliers(values, rule)) {
                addPart(rows[members[found.index]].outliers,
                        std::string(kColumns[k].name) + (found.score > 0 ? ":+" : ":-") +
                            formatFixed(std::abs(found.score), 1) + "(" + found.percentText() + ")",
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

Json qualityDictionary(const OutlierRule& rule) {
    Json json{{"participant_id", described("Participant")},
              {"session_id", described("Session")},
              {"scan", described("Entities of the image that the surface was made of")},
              {"part", described("Which surface: the isovalue asked for (isoauto: Otsu's), a "
                                 "surface of a head model, or the number of a region")},
              {"name", described("Name of the region")},
              {"reason", described("Why the surface is not there, or what is wrong with it")},
              {"check", described("What adaptiso-check found: passed, or what does not hold")},
              {"outliers", described("Columns in which this surface lies " + rule.text() +
                                     " of all rows of its product and part, each "
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

}  // namespace adaptiso::bids
