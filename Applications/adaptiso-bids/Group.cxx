#include <algorithm>
#include <array>
#include <iostream>
#include <set>
#include <tuple>
#include <utility>

#include "Common/BatchSummary.h"
#include "Common/RunApp.h"
#include "Common/Verdict.h"
#include "Dataset.h"
#include "Jobs.h"
#include "QualityTable.h"
#include "adaptiso/Core/FoundFiles.h"
#include "adaptiso/Core/ParseJson.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso::bids {
namespace {

namespace fs = std::filesystem;

constexpr const char* kProgram = "adaptiso-bids";
constexpr const char* kDescription = "dataset_description.json";

/// Files that BIDS does not define yet, for its validators.
constexpr const char* kIgnored =
    "*_mesh.*\n**/*_mesh.*\n**/*_mesh/\n**/*_figures/\n**/*.adaptiso-*.json\nquality.*\n"
    "summary.html\n";

constexpr const char* kReadme =
    R"(Surfaces made by adaptiso-bids (adaptiso %VERSION%) of the images of another dataset, for which
dataset_description.json has the link. Research software, no medical device.

summary.html       the result of each scan, with pictures; those that need attention come first
quality.tsv        measures of every surface, and why one is missing; quality.json describes the
                   columns
sub-*/             surfaces, each with a sidecar (.json) that names its source, and a record
                   (.adaptiso-*.json) with the checksums of inputs and outputs
)";

// ---- the status of a dataset

std::optional<double> numberAt(const Json& json, const char* key) {
    const auto found = json.find(key);
    if (found == json.end() || !found->is_number()) return std::nullopt;
    return found->get<double>();
}

QualityRow rowOf(const QualityRow& scan, const std::string& part, const Json& surface) {
    QualityRow row = scan;
    row.part = part;
    row[Measure::Vertices] = numberAt(surface, "vertices");
    row[Measure::Triangles] = numberAt(surface, "triangles");
    row[Measure::AreaMm2] = numberAt(surface, "areaMm2");
    row[Measure::VolumeMm3] = numberAt(surface, "volumeMm3");
    row[Measure::Genus] = numberAt(surface, "genus");
    return row;
}

std::vector<QualityRow> headRows(const QualityRow& scan, const Json& report) {
    std::vector<QualityRow> rows;
    const Json& gaps = report.at("gaps");
    for (const Json& surface : report.at("surfaces")) {
        QualityRow row = rowOf(scan, surface.at("name"), surface);
        row[Measure::CrossingPairs] = numberAt(surface, "crossingPairs");
        if (!rows.empty() && rows.size() <= gaps.size()) {
            QualityRow& inner = rows.back();
            row[Measure::GapMm] = numberAt(gaps[rows.size() - 1], "mm");
            const auto volume = row[Measure::VolumeMm3], within = inner[Measure::VolumeMm3];
            const auto area = row[Measure::AreaMm2], areaWithin = inner[Measure::AreaMm2];
            if (volume && within && area && areaWithin) {
                row[Measure::ThicknessMm] = (*volume - *within) / ((*area + *areaWithin) / 2);
            }
        }
        rows.push_back(std::move(row));
    }
    return rows;
}

/// "iso100", "isoauto": which of several isosurfaces a file is.
std::string partOf(const fs::path& surface) {
    return entityOf(surface.filename().string(), "desc");
}

/// The rows of a finished record: isosurfaces, those of a head model, or regions.
std::vector<QualityRow> rowsOfReport(const QualityRow& scan, const Json& report,
                                     const std::vector<fs::path>& surfaces) {
    std::vector<QualityRow> rows;
    if (scan.product == "bem") return headRows(scan, report);
    if (scan.product == "labels") {
        for (const Json& region : report.at("regions")) {
            QualityRow& row = rows.emplace_back(
                rowOf(scan, std::to_string(wholeNumber<std::int64_t>(region.at("label"))), region));
            row.name = region.at("name");
            row[Measure::Components] = numberAt(region, "components");
        }
        return rows;
    }
    for (const Json& surface : report.at("surfaces")) {
        QualityRow& row = rows.emplace_back(rowOf(scan, partOf(surfaces.at(rows.size())), surface));
        row[Measure::Isovalue] = numberAt(surface, "isovalue");
        row[Measure::Components] = numberAt(surface, "componentCount");
        row[Measure::CrossingPairs] = numberAt(surface.at("soundness"), "crossingPairs");
    }
    return rows;
}

/// State of a dataset: lines of the page, each with its rows of the table.
class DatasetStatus {
public:
    struct Entry {
        SummaryRow line;
        std::vector<QualityRow> rows;
    };

    /// \param areFromRecords  the options, which then lead to no file elsewhere
    /// \throws InvalidInput
    DatasetStatus(const BidsOptions& options, const ChosenSubjects& chosen, bool areFromRecords)
        : options_(options), subjects_(chosen.folders) {
        options_.makesPictures = false;  // the page shows those that are there; they are no result
        const std::vector<Job> jobs = findJobs(options_, subjects_);
        if (areFromRecords) requireInputs(jobs);
        if (options_.makes("check")) addChecks(checkJob(options_, jobs.front()));
        for (const auto& [subject, reason] : chosen.faulty) {
            addAbsent({.participant = subject}, QualityState::Failed, reason);
        }
        for (const Job& job : jobs) add(job);
        if (options_.participants.empty() && options_.sessions.empty()) addLeftovers();
        // by participant and scan; results of one scan stay in their order
        std::stable_sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
            const QualityRow &x = a.rows.front(), &y = b.rows.front();
            return std::tie(x.participant, x.session, x.scan) <
                   std::tie(y.participant, y.session, y.scan);
        });
    }

    std::vector<Entry> entries;
    std::size_t records = 0;  ///< that exist

private:
    void requireInputs(const std::vector<Job>& jobs) const {
        for (const Job& job : jobs) {
            for (const PlannedRun& run : job.runs) {
                for (const fs::path& input : run.inputs) {
                    const bool isIn = std::ranges::any_of(
                        std::array{options_.dataset, options_.segmentations, options_.output},
                        [&](const fs::path& root) { return !root.empty() && liesIn(input, root); });
                    if (isIn || std::ranges::count(run.item.inputs, input) > 0) continue;
                    throw InvalidInput("the records name " + input.string() +
                                       ", which is not in BIDS_DIR or OUT_DIR; if they are right, "
                                       "give the participant level's options here too");
                }
            }
        }
    }

    void add(const Job& job) {
        for (const std::string& subject : job.without) {
            addAbsent({.participant = subject, .product = job.product}, QualityState::Missing,
                      "no " + job.needs);
        }
        for (const PlannedRun& run : job.runs) {
            add(job, run, findEarlierRun(job.program, run, options_.output));
        }
    }

    void add(const Job& job, const PlannedRun& run, const EarlierRun& earlier) {
        const std::string session = entityOf(run.item.name, "ses");
        QualityRow row{.participant = "sub-" + entityOf(run.item.name, "sub"),
                       .session = session.empty() ? "" : "ses-" + session,
                       .scan = run.item.name,
                       .product = job.product};
        records += earlier.isThere ? 1 : 0;
        for (const fs::path& file : run.surfaces) surfaces_.insert(file.filename().string());
        if (!run.item.fault.empty()) {
            return addAbsent(std::move(row), QualityState::Failed,
                             baseName(run.item.inputs.front()) + ": " + run.item.fault);
        }
        if (earlier.fault != RecordFault::None) {
            return addMissing(row, run, earlier.isThere ? earlier.why : "not run");
        }
        const RunRecord& record = earlier.record;
        for (const std::string& output : record.outputs) {  // of "iso=auto" the isovalue is known
            if (job.product == "surfaces") surfaces_.insert(fs::path(output).filename().string());
        }
        Entry& entry = entries.emplace_back(Entry{summaryRow(run.record, record), {}});
        const std::string error = record.error.empty() ? record.says : record.error;
        if (record.hasEnded && !record.isFinished()) {
            setState(row, QualityState::Failed, error);
        } else if (!earlier.why.empty()) {
            setState(row, QualityState::Missing, earlier.why);
        } else if (!record.hasPassed()) {
            setState(row, QualityState::Failed, error);
        } else {
            try {
                entry.rows = rowsOfReport(row, record.report, run.surfaces);
            } catch (const std::exception&) {
                setState(row, QualityState::Missing, "its record is damaged");  // edited by hand
            }
        }
        if (entry.rows.empty()) entry.rows = rowsWith(row, run);
        for (std::size_t n = 0; n < entry.rows.size() && n < record.outputs.size(); ++n) {
            const auto check =
                checks_.find((run.item.folder / record.outputs[n]).lexically_normal());
            if (check == checks_.end() || entry.rows[n].state != QualityState::Done) continue;
            const auto& [state, text] = check->second;
            entry.rows[n].state = state;
            if (state != QualityState::Done) entry.rows[n].reason = text;
            if (state != QualityState::Missing) entry.rows[n].check = text;
        }
        entry.line.state = entry.line.warnings.empty() ? RunState::Done : RunState::Warned;
        for (const QualityRow& each : entry.rows) {
            if (each.state == QualityState::Done) continue;
            entry.line.says = each.reason;
            entry.line.reason = reasonOf(each.reason, record.files);
            entry.line.state = !record.hasEnded                      ? RunState::NotFinished
                               : each.state == QualityState::Missing ? RunState::Changed
                               : record.isFinished()                 ? RunState::CheckFailed
                                                                     : RunState::Failed;
        }
    }

    static void setState(QualityRow& row, QualityState state, const std::string& reason) {
        row.state = state;
        row.reason = reason;
    }

    /// `row` for each planned surface; once if they aren't known.
    static std::vector<QualityRow> rowsWith(const QualityRow& row, const PlannedRun& run) {
        std::vector<QualityRow> rows(std::max<std::size_t>(1, run.surfaces.size()), row);
        for (std::size_t n = 0; n < run.surfaces.size(); ++n)
            rows[n].part = partOf(run.surfaces[n]);
        return rows;
    }

    void addMissing(const QualityRow& row, const PlannedRun& run, const std::string& reason) {
        for (QualityRow& each : rowsWith(row, run)) {
            addAbsent(std::move(each), QualityState::Missing, reason);
        }
    }

    void addAbsent(QualityRow row, QualityState state, const std::string& reason) {
        setState(row, state, reason);
        SummaryRow line;
        line.program = row.product;
        line.name = row.scan.empty() ? row.participant : row.scan;
        line.state = state == QualityState::Leftover ? RunState::Changed : RunState::NotRun;
        line.says = reason;
        line.reason = reasonOf(reason);
        entries.push_back({std::move(line), {std::move(row)}});
    }

    void addChecks(const Job& job) {
        for (const PlannedRun& run : job.runs) {
            const EarlierRun earlier = findEarlierRun(job.program, run, options_.output);
            auto& [state, text] = checks_[run.item.inputs.front().lexically_normal()];
            if (!earlier.why.empty()) {
                state = QualityState::Missing;
                text = "its check: " + earlier.why;
            } else {
                const bool hasPassed = earlier.record.hasPassed();
                state = hasPassed ? QualityState::Done : QualityState::Unsound;
                text = hasPassed ? "passed" : earlier.record.says;
            }
        }
    }

    /// Results of scans that are no longer in the dataset, and surfaces of former isovalues.
    void addLeftovers() {
        std::set<std::string> known, reported;
        for (const fs::path& subject : subjects_) {
            fs::path elsewhere = options_.segmentations;
            if (!elsewhere.empty()) elsewhere /= subject.filename();
            for (const auto& [folder, images] :
                 {std::pair{subject, &kBidsScans}, std::pair{subject, &kBidsSegmentations},
                  std::pair{elsewhere, &kBidsSegmentations}}) {
                if (folder.empty()) continue;
                for (const BatchItem& item : bidsImagesOf(folder, {}, subject, *images)) {
                    known.insert(item.name);
                }
            }
        }
        for (const fs::path& file : recordFiles(options_.output, true)) {
            RunRecord record;
            if (readRecord(file, record) != RecordFault::None) continue;
            const bool isMesh = record.program == "adaptiso-mesh";
            const bool isOfScan = isMesh || record.program == "adaptiso-bem" ||
                                  // their images may be in a folder that is not named now
                                  (record.program == "adaptiso-labels" && options_.makes("labels"));
            if (!isOfScan) continue;
            QualityRow row{.participant = "sub-" + entityOf(record.name, "sub"),
                           .scan = record.name};
            if (!known.contains(record.name) && reported.insert(record.name).second) {
                addAbsent(std::move(row), QualityState::Leftover,
                          "is in the output, but its image is not in the dataset; remove " +
                              record.name + "_desc-* and " + record.name + "_mesh* there");
            } else if (known.contains(record.name) && isMesh) {
                addFormer(row, file, record);
            }
        }
    }

    void addFormer(QualityRow row, const fs::path& file, const RunRecord& record) {
        for (const std::string& output : record.outputs) {
            const std::string name = fs::path(output).filename().string();
            const bool isThere = fs::exists(detail::folderOf(file) / output);
            if (surfaces_.empty() || surfaces_.contains(name) || !isThere) continue;
            row.product = "surfaces";
            row.part = partOf(name);
            addAbsent(row, QualityState::Leftover,
                      name +
                          " is of an isovalue or a format that is not asked for now; remove it, "
                          "or ask for it too");
        }
    }

    BidsOptions options_;
    const std::vector<fs::path>& subjects_;
    std::map<fs::path, std::pair<QualityState, std::string>> checks_;  ///< by surface
    std::set<std::string> surfaces_;  ///< names of the files that are asked for
};

// ---- the options of the participant level

void takeRequest(const Json& request, BidsOptions& options) {
    const std::string product = request.value("product", "");
    options.wanted[product] = request.value("options", "");
    const std::string folder = request.value("segmentations", "");
    if (!folder.empty() && options.segmentations.empty()) {
        options.segmentations = (options.output / folder).lexically_normal();
        if (!liesIn(options.segmentations, options.dataset) &&
            !liesIn(options.segmentations, options.output)) {
            throw InvalidInput("the records name label maps in " + options.segmentations.string() +
                               ", outside of BIDS_DIR and OUT_DIR; if they are right, give "
                               "--segmentations " +
                               options.segmentations.string());
        }
    }
    options.makesPictures = options.makesPictures && request.value("pictures", true);
    options.common.isStrict = options.common.isStrict || request.value("strict", false);
    if (options.common.allowed.empty()) {
        options.common.allowed = request.value("allow", std::vector<std::string>());
    }
}

/// Fills in the request of most participants for each program, by the records.
void takeRequest(BidsOptions& options) {
    // of each program and participant the last request, with the record's date
    std::map<std::string, std::map<std::string, std::pair<std::string, Json>>> last;
    for (const fs::path& file : recordFiles(options.output, true)) {
        RunRecord record;
        if (readRecord(file, record) != RecordFault::None || !record.request.is_object()) continue;
        auto& [date, request] = last[record.program][entityOf(record.name, "sub")];
        if (record.date >= date) std::tie(date, request) = std::pair(record.date, record.request);
    }
    for (const auto& [program, participants] : last) {
        std::map<std::string, std::pair<std::size_t, std::string>> votes;  // and the last date
        for (const auto& [participant, one] : participants) {
            auto& [count, date] = votes[one.second.dump()];
            ++count;
            date = std::max(date, one.first);
        }
        const auto most = std::ranges::max_element(
            votes, {}, [](const auto& vote) -> const auto& { return vote.second; });
        takeRequest(parseJson<Json>(most->first), options);
    }
}

/// Of "iso=100,brain-mask=masks/{name}.nii" the names of files alone.
std::string withoutFoldersInList(const std::string& list) {
    std::string text;
    for (std::size_t begin = 0, end = 0; end != std::string::npos; begin = end + 1) {
        end = list.find(',', begin);
        const std::string item = list.substr(begin, end - begin);
        const std::size_t value = item.find('=') + 1;  // 0: a value alone
        const bool isPath = item.find('/', value) != std::string::npos;
        if (begin > 0) text += ",";
        text += isPath ? item.substr(0, value) + withoutFolder(item.substr(value)) : item;
    }
    return text;
}

/// As on the command line, complete: "--surfaces iso=100 --check".
std::string wordsOf(const BidsOptions& options) {
    std::string words;
    for (const std::string product : kProducts) {
        if (!options.makes(product)) continue;
        const std::string& list = options.wanted.at(product);
        words += (words.empty() ? "--" : " --") + product;
        if (!list.empty()) {
            words +=
                (product == "surfaces" ? " " : " --" + product + "-options ") + shellQuoted(list);
        }
        if (product == "labels" && !options.segmentations.empty()) {
            words += " --segmentations " + shellQuoted(options.segmentations.string());
        }
    }
    if (!options.makesPictures) words += " --no-pictures";
    if (options.common.isStrict) words += " --strict";
    for (const std::string& code : options.common.allowed) words += " --allow " + shellQuoted(code);
    return words;
}

/// The group level's command, with FOLDER in the place of folders, which may name a patient.
std::string commandOf(const BidsOptions& options, bool areFromRecords) {
    std::string words = std::string(kProgram) + " BIDS_DIR OUT_DIR group";
    for (const std::string& label : options.participants) words += " --participant-label " + label;
    for (const std::string& label : options.sessions) words += " --session-label " + label;
    if (!areFromRecords) {
        BidsOptions shown = options;
        for (auto& [product, list] : shown.wanted) list = withoutFoldersInList(list);
        if (!shown.segmentations.empty()) shown.segmentations = baseName(shown.segmentations);
        words += " " + wordsOf(shown);
    }
    const OutlierRule &rule = options.outliers, usual;
    if (rule.limit != usual.limit) words += " --outlier " + formatNumber(rule.limit);
    if (rule.leastPercent != usual.leastPercent) {
        words += " --outlier-percent " + formatNumber(rule.leastPercent);
    }
    return words;
}

/// The first entry of GeneratedBy in the output's description; may be null.
Json makerOf(const fs::path& output) {
    const auto json = parseJson<Json>(readFoundFile(output / kDescription, output).value_or(""));
    const Json makers = json.is_object() ? json.value("GeneratedBy", Json()) : Json();
    const bool isMade = makers.is_array() && !makers.empty() && makers[0].is_object();
    return isMade ? makers[0] : Json();
}

/// \throws InvalidInput  another program or a person made the files that the group level writes
void requireOwnDataset(const fs::path& output) {
    const auto refuse = [&](const char* file, const std::string& owner) {
        throw InvalidInput((output / file).string() + ": is " + owner +
                           "; give another OUT_DIR, or remove it");
    };
    std::error_code error;
    if (fs::exists(output / kDescription, error)) {
        const Json maker = makerOf(output);
        const Json name = maker.is_object() ? maker.value("Name", Json()) : Json();
        if (!name.is_string()) refuse(kDescription, "of another dataset");
        const auto text = name.get<std::string>();
        if (!text.starts_with("adaptiso")) refuse(kDescription, "of a dataset of " + oneLine(text));
        return;
    }
    for (const char* const file : {"README", ".bidsignore"}) {
        if (fs::exists(output / file, error)) refuse(file, "not of adaptiso-bids");
    }
}

/// Fills in the participant level's options where none are given. \throws UsageError
void fillInOptions(BidsOptions& options) {
    if (!options.namesProducts()) {
        auto given = std::move(options.wanted);
        options.wanted.clear();
        takeRequest(options);
        for (auto& [product, list] : given) options.wanted[product] = list;
    }
    if (!options.namesProducts()) options.wanted["surfaces"] = "iso=auto";  // an old version's
    if (options.makes("check") && !options.makes("surfaces")) {
        throw UsageError("--check: needs --surfaces");
    }
}

// ---- what is written

std::string dumped(const Json& json) {
    return jsonText(json) + "\n";
}

/// An entry of SourceDatasets, with the dataset's DOI if it states one.
Json sourceOf(const fs::path& root) {
    const auto said = parseJson<Json>(readFoundFile(root / kDescription, root).value_or(""));
    Json source{{"URL", "bids:raw:"}};
    if (!said.is_object() || !said.contains("DatasetDOI")) return source;
    std::string doi = said["DatasetDOI"].is_string() ? said["DatasetDOI"].get<std::string>() : "";
    if (doi.starts_with("doi:")) doi.erase(0, 4);
    if (doi.empty()) return source;
    source["DOI"] = doi;
    source["URL"] = doi.starts_with("http") ? doi : "https://doi.org/" + doi;
    return source;
}

/// dataset_description.json
Json descriptionOf(const BidsOptions& options) {
    std::error_code error;
    const auto linkTo = [&](const fs::path& dataset) {
        return fs::proximate(dataset, options.output, error).generic_string();
    };
    Json maker{{"Name", kProgram}, {"Version", programVersion()}};
    if (constexpr std::string_view home = ADAPTISO_HOMEPAGE; !home.empty()) maker["CodeURL"] = home;
    Json json{{"Name", "adaptiso"},
              {"BIDSVersion", "1.8.0"},
              {"DatasetType", "derivative"},
              {"GeneratedBy", Json::array({maker})},
              {"SourceDatasets", {sourceOf(options.dataset)}},
              {"DatasetLinks", {{"raw", linkTo(options.dataset)}}}};
    if (!options.segmentations.empty()) {
        json["DatasetLinks"]["segmentations"] = linkTo(options.segmentations);
        json["SourceDatasets"].push_back({{"URL", "bids:segmentations:"}});
    }
    return json;
}

bool isGood(const QualityRow& row) {
    return row.state == QualityState::Done;
}

/// The page's lines with their outliers, the worst first.
std::vector<SummaryRow> pageRows(const std::vector<DatasetStatus::Entry>& entries,
                                 const std::vector<QualityRow>& rows) {
    std::vector<SummaryRow> lines;
    auto row = rows.begin();
    for (const DatasetStatus::Entry& entry : entries) {
        SummaryRow& line = lines.emplace_back(entry.line);
        line.volumesMm3.clear();
        for (const auto end = row + std::ssize(entry.rows); row != end; ++row) {
            if (const auto volume = row->measures[static_cast<std::size_t>(Measure::VolumeMm3)]) {
                line.volumesMm3.emplace_back(row->name.empty() ? row->part : row->name, *volume);
            }
            if (row->outliers.empty()) continue;
            line.state = std::min(line.state, RunState::Unusual);
            addPart(line.says,
                    std::string("unlike the others: ") +
                        (row->part.empty() ? "" : row->part + " ") + row->outliers,
                    "; ");
        }
    }
    sortByNeed(lines);
    return lines;
}

Json rowJson(const QualityRow& row) {
    Json json{{"participant", row.participant}, {"state", toString(row.state)}};
    for (const auto& [key, text] :
         {std::pair("session", &row.session), std::pair("scan", &row.scan),
          std::pair("product", &row.product), std::pair("part", &row.part),
          std::pair("reason", &row.reason), std::pair("outliers", &row.outliers)}) {
        json[key] = text->empty() ? Json(nullptr) : Json(*text);
    }
    return json;
}

}  // namespace

int runGroup(BidsOptions options, const ChosenSubjects& chosen) {
    const CommonOptions& common = options.common;
    const bool writesJson = common.wantsJson() && !common.wantsJsonOnStdout();
    checkReportFile(common, options.dataset);
    std::error_code error;
    if (!fs::is_directory(options.output, error)) {
        throw InvalidInput(options.output.string() +
                           ": is not there; run the participant level first");
    }
    requireOwnDataset(options.output);
    const bool areFromRecords = !options.namesProducts();
    fillInOptions(options);
    const DatasetStatus status(options, chosen, areFromRecords);
    if (status.records == 0) {
        throw InvalidInput(options.output.string() +
                           ": nothing of these participants is there, with these options (" +
                           wordsOf(options) + "); run the participant level first");
    }
    std::vector<QualityRow> rows;
    for (const DatasetStatus::Entry& entry : status.entries) {
        rows.insert(rows.end(), entry.rows.begin(), entry.rows.end());
    }
    markOutliers(rows, options.outliers);

    std::set<std::string> participants, faulty;
    Json missing = Json::array(), unusual = Json::array();
    for (const QualityRow& row : rows) {
        if (row.state != QualityState::Leftover) participants.insert(row.participant);
        if (!isGood(row)) faulty.insert(row.participant);
        if (!isGood(row)) missing.push_back(rowJson(row));
        if (!row.outliers.empty()) unusual.push_back(rowJson(row));
    }
    const auto whole = std::ranges::count_if(
        participants, [&](const std::string& each) { return !faulty.contains(each); });
    const std::size_t good = rows.size() - missing.size();

    std::vector<AtomicOutput> outputs;
    const auto write = [&](const char* name, const std::string& text) {
        outputs.emplace_back(options.output / name, options.output).writeText(text);
    };
    std::string readme = kReadme;
    const std::string place = "%VERSION%";
    write(kDescription, dumped(descriptionOf(options)));
    write("README", readme.replace(readme.find(place), place.size(), programVersion()));
    write(".bidsignore", kIgnored);
    write("quality.tsv", qualityTable(rows));
    write("quality.json", dumped(qualityDictionary(options.outliers)));
    Summary summary{pageRows(status.entries, rows)};
    summary.title = "Group of " + counted(std::ssize(participants), "participant");
    summary.program = std::string(kProgram) + " " + programVersion();
    summary.command = commandOf(options, areFromRecords);
    summary.outliers = options.outliers;
    for (const Warning& warning : chosen.warnings) {
        summary.notes.push_back(warning.file + ": " + warning.text);
    }
    write("summary.html", summaryPage(summary, options.output / "summary.html"));
    Verdict verdict{missing.empty() ? kExitOk : kExitCheckFailed};
    if (missing.empty()) verdict.failStrict(common, chosen.warnings, "");
    std::string json;
    if (common.wantsJson()) {
        Json report = reportHead("adaptiso-bids/1", kProgram, verdict, chosen.warnings);
        report.update(Json{{"options", requestOf(options)},
                           {"participants", participants.size()},
                           {"wholeParticipants", whole},
                           {"surfaces", good},
                           {"missing", missing},
                           {"unusual", unusual}});
        json = dumped(report);
    }
    if (writesJson) outputs.emplace_back(common.json).writeText(json);
    printResults(common, json, [&](std::ostream& out) {
        out << participants.size() << " participant" << (participants.size() == 1 ? "" : "s")
            << ", " << whole << " whole; " << good << " surfaces, " << unusual.size()
            << " unusual\noptions: " << wordsOf(options) << '\n'
            << (options.output / "quality.tsv").string() << " and "
            << (options.output / "summary.html").string() << " are written\n";
    });
    AtomicOutput::commit(outputs);
    for (const QualityRow& row : rows) {
        if (isGood(row)) continue;
        std::string subject = row.scan.empty() ? row.participant : row.scan;
        if (!row.product.empty()) subject += ": " + row.product;
        if (!row.part.empty()) subject += " " + row.part;
        printError(kProgram, toString(row.state) + ": " + subject + ": " + row.reason);
    }
    return missing.empty() ? kExitOk : kExitCheckFailed;
}

}  // namespace adaptiso::bids
