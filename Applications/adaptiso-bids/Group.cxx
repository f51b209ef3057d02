#include <algorithm>
#include <fstream>
#include <iostream>
#include <set>
#include <string>
#include <utility>

#include "Cohort.h"
#include "Common/AtomicOutput.h"
#include "Common/Bids.h"
#include "Common/RunApp.h"
#include "Common/Sha256.h"
#include "Common/Verdict.h"
#include "Levels.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

constexpr const char* kProgram = "adaptiso-bids";

/// What is no part of BIDS in its present version, for its validators.
constexpr const char* kIgnored =
    "*_mesh.*\n**/*_mesh.*\n**/*_mesh/\n**/*_figures/\n**/*.adaptiso-*.json\nquality.*\n"
    "summary.html\n";

constexpr const char* kReadme =
    R"(Surfaces made by adaptiso-bids (adaptiso %VERSION%) of the images of another dataset, for which
dataset_description.json has the link. Research software, no medical device.

summary.html       what was made of each scan, with pictures; what needs a look comes first
quality.tsv        measures of every surface, and why one is not there; quality.json says what
                   the columns mean
sub-*/             surfaces, each with a sidecar (.json) that says what it was made of, and a
                   record (.adaptiso-*.json) with the checksums of what went in and came out
)";

std::string dumped(const Json& json) {
    return jsonText(json) + "\n";
}

/// By which a table made with other options is known: of what may hold paths a checksum alone.
std::string sumOf(const Json& asked) {
    return sha256Of(asked.dump());
}

constexpr const char* kOptionsSum = "OptionsSha256";

Json descriptionOf(const BidsOptions& options) {
    Json json = bidsDescription(options.dataset, options.output, kProgram);
    json["GeneratedBy"][0][kOptionsSum] = sumOf(askedOf(options));
    if (!options.segmentations.empty()) {
        std::error_code error;
        json["DatasetLinks"]["segmentations"] =
            fs::proximate(options.segmentations, options.output, error).generic_string();
        json["SourceDatasets"].push_back({{"URL", "bids:segmentations:"}});
    }
    return json;
}

std::string readme() {
    std::string text = kReadme;
    const std::string place = "%VERSION%";
    return text.replace(text.find(place), place.size(), programVersion());
}

bool isGood(const QualityRow& row) {
    return row.state == QualityState::Done;
}

/// "sub-01_ses-2: surfaces iso100"
std::string subjectOf(const QualityRow& row) {
    std::string text = row.scan.empty() ? row.participant : row.scan;
    if (!row.product.empty()) text += ": " + row.product;
    return text + (row.part.empty() ? "" : " " + row.part);
}

/// Marks and reasons of the table, on the page; what needs a look first.
std::vector<SummaryRow> pageRows(Cohort& cohort) {
    for (std::size_t n = 0; n < cohort.rows.size(); ++n) {
        const QualityRow& row = cohort.rows[n];
        if (row.outliers.empty()) continue;
        SummaryRow& line = cohort.summary[cohort.shownBy[n]];
        if (line.state == RunState::Done) line.state = RunState::Unusual;
        line.says += (line.says.empty() ? "" : "; ") + std::string("unlike the others: ") +
                     (row.part.empty() ? "" : row.part + " ") + row.outliers;
    }
    std::vector<SummaryRow> rows = std::move(cohort.summary);
    std::stable_sort(rows.begin(), rows.end(),
                     [](const auto& a, const auto& b) { return a.state < b.state; });
    return rows;
}

Json rowJson(const QualityRow& row) {
    const auto orNone = [](const std::string& text) {
        return text.empty() ? Json(nullptr) : Json(text);
    };
    return {{"participant", row.participant}, {"session", orNone(row.session)},
            {"scan", orNone(row.scan)},       {"product", orNone(row.product)},
            {"part", orNone(row.part)},       {"state", toString(row.state)},
            {"reason", orNone(row.reason)},   {"outliers", orNone(row.outliers)}};
}

struct Counts {
    std::size_t participants = 0, whole = 0, bad = 0, unusual = 0;
};

Counts countsOf(const std::vector<QualityRow>& rows) {
    std::set<std::string> all, faulty;
    Counts counts;
    for (const QualityRow& row : rows) {
        if (row.state != QualityState::Leftover) all.insert(row.participant);
        if (!isGood(row)) faulty.insert(row.participant);
        counts.bad += isGood(row) ? 0 : 1;
        counts.unusual += row.outliers.empty() ? 0 : 1;
    }
    counts.participants = all.size();
    for (const std::string& participant : all) counts.whole += faulty.contains(participant) ? 0 : 1;
    return counts;
}

std::string jsonReport(const std::vector<QualityRow>& rows, const Counts& counts,
                       const BidsOptions& options, const Verdict& verdict,
                       const std::vector<Warning>& warnings) {
    Json faulty = Json::array(), unusual = Json::array();
    for (const QualityRow& row : rows) {
        if (!isGood(row)) faulty.push_back(rowJson(row));
        if (!row.outliers.empty()) unusual.push_back(rowJson(row));
    }
    Json report = reportHead("adaptiso-bids/1", kProgram, verdict, warnings);
    report.update(Json{{"options", askedOf(options)},
                       {"participants", counts.participants},
                       {"wholeParticipants", counts.whole},
                       {"surfaces", rows.size() - counts.bad},
                       {"missing", faulty},
                       {"unusual", unusual}});
    return dumped(report);
}

/// As the command line has them: "--surfaces iso=100 --check".
std::string wordsOf(const BidsOptions& options) {
    std::string words;
    const auto add = [&](const std::string& name, const std::string& list) {
        words += (words.empty() ? "" : " ") + name + (list.empty() ? "" : " " + list);
    };
    if (!options.surfaces.empty()) add("--surfaces", options.surfaces);
    if (options.makesBem) add("--bem", "");
    if (!options.bemOptions.empty()) add("--bem-options", options.bemOptions);
    if (options.makesLabels) add("--labels", "");
    if (!options.labelsOptions.empty()) add("--labels-options", options.labelsOptions);
    if (!options.segmentations.empty()) add("--segmentations", options.segmentations.string());
    if (options.makesChecks) add("--check", "");
    if (!options.checkOptions.empty()) add("--check-options", options.checkOptions);
    return words;
}

void printTotals(std::ostream& out, const Counts& counts, std::size_t rows,
                 const BidsOptions& options) {
    out << counts.participants << " participant" << (counts.participants == 1 ? "" : "s") << ", "
        << counts.whole << " whole; " << rows - counts.bad << " surfaces, " << counts.unusual
        << " unusual\n"
        << "options: " << wordsOf(options) << '\n'
        << (options.output / "quality.tsv").string() << " and "
        << (options.output / "summary.html").string() << " are written\n";
}

/// What the group level writes in the output's folder must not be another program's or a person's.
/// \throws InvalidInput  it is
void requireOwnDataset(const fs::path& output) {
    const auto refuse = [&](const char* file, const std::string& of) {
        throw InvalidInput((output / file).string() + ": is " + of +
                           "; give another OUT_DIR, or take it away");
    };
    std::error_code error;
    const auto isThere = [&](const char* file) { return fs::exists(output / file, error); };
    constexpr const char* kDescription = "dataset_description.json";
    if (isThere(kDescription)) {
        std::ifstream file(output / kDescription);
        const Json said = Json::parse(file, nullptr, false);
        const Json none,
            &by = said.is_object() && said.contains("GeneratedBy") ? said["GeneratedBy"] : none;
        const Json& name =
            by.is_array() && !by.empty() && by[0].is_object() && by[0].contains("Name")
                ? by[0]["Name"]
                : none;
        const bool isOwn = name.is_string() && name.get<std::string>().starts_with("adaptiso");
        if (!isOwn) {
            refuse(kDescription, name.is_string()
                                     ? "of a dataset of " + oneLine(name.get<std::string>())
                                     : std::string("of another dataset"));
        }
        return;
    }
    for (const char* const file : {"README", ".bidsignore"}) {
        if (isThere(file)) refuse(file, "not of adaptiso-bids");
    }
}

/// Fills in the participant level's options where none are given, and keeps a table that was made
/// with others. \throws InvalidInput  there is one, and --force is not given
void requireOwnOptions(BidsOptions& options) {
    BidsOptions ofParticipants = options;
    ofParticipants.surfaces.clear();
    ofParticipants.makesBem = ofParticipants.makesLabels = ofParticipants.makesChecks = false;
    ofParticipants.checkOptions.clear();
    takeAsked(ofParticipants);
    if (!options.namesProducts()) {
        const BidsOptions given = options;
        options = ofParticipants;
        if (given.makesChecks) {
            options.makesChecks = true;
            options.checkOptions = given.checkOptions;
        }
    }
    if (!options.namesProducts()) options.surfaces = "iso=auto";  // of a version that kept none
    if (options.makesChecks && options.surfaces.empty()) {
        throw UsageError("--check: needs --surfaces");
    }
    const Json asked = askedOf(options), known = askedOf(ofParticipants);
    const auto isKnown = [&](const Json& one) {
        return std::find(known.begin(), known.end(), one) != known.end();
    };
    if (options.force || std::all_of(asked.begin(), asked.end(), isKnown)) return;
    std::error_code error;
    std::ifstream file(options.output / "dataset_description.json");
    const Json said = Json::parse(file, nullptr, false);
    if (!said.is_object() || !fs::exists(options.output / "quality.tsv", error)) return;
    const std::string sum = said["GeneratedBy"][0].value(kOptionsSum, "");
    if (sum.empty() || sum == sumOf(asked)) return;
    throw InvalidInput((options.output / "quality.tsv").string() +
                       ": was made with other options than " + wordsOf(options) +
                       "; leave them out to take the participant level's, or give --force to "
                       "replace it");
}

}  // namespace

int runGroup(BidsOptions options, const ChosenSubjects& chosen) {
    const bool writesJson = options.common.wantsJson() && !options.common.wantsJsonOnStdout();
    if (writesJson) checkOutput(options.common.json);
    std::error_code error;
    if (!fs::is_directory(options.output, error)) {
        throw InvalidInput(options.output.string() +
                           ": is not there; run the participant level first");
    }
    requireOwnDataset(options.output);
    requireOwnOptions(options);
    Cohort cohort = lookAtCohort(options, chosen);
    if (cohort.records == 0) {
        throw InvalidInput(options.output.string() +
                           ": nothing of these participants is there, with these options (" +
                           wordsOf(options) + "); run the participant level first");
    }
    markOutliers(cohort.rows, options.outlierLimit, options.outlierPercent);
    const std::vector<SummaryRow> lines = pageRows(cohort);
    const std::vector<QualityRow>& rows = cohort.rows;
    const fs::path page = options.output / "summary.html";
    std::vector<AtomicOutput> outputs;
    const auto write = [&](const char* name, const std::string& text) {
        outputs.emplace_back(options.output / name).writeText(text);
    };
    write("dataset_description.json", dumped(descriptionOf(options)));
    write("README", readme());
    write(".bidsignore", kIgnored);
    write("quality.tsv", qualityTable(rows));
    write("quality.json", dumped(qualityDictionary(options.outlierLimit, options.outlierPercent)));
    write("summary.html", summaryPage(lines, page));
    const Counts counts = countsOf(rows);
    Verdict verdict{counts.bad == 0 ? kExitOk : kExitCheckFailed};
    if (counts.bad == 0) verdict.failStrict(options.common, chosen.warnings, "");
    const std::string json = options.common.wantsJson()
                                 ? jsonReport(rows, counts, options, verdict, chosen.warnings)
                                 : "";
    if (writesJson) outputs.emplace_back(options.common.json).writeText(json);
    printResults(options.common, json,
                 [&](std::ostream& out) { printTotals(out, counts, rows.size(), options); });
    AtomicOutput::commit(outputs);
    for (const QualityRow& row : rows) {
        if (isGood(row)) continue;
        printError(kProgram, toString(row.state) + ": " + subjectOf(row) + ": " + row.reason);
    }
    return counts.bad == 0 ? kExitOk : kExitCheckFailed;
}

}  // namespace adaptiso
