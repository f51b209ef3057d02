#include "Cohort.h"

#include <algorithm>
#include <deque>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "Common/BatchPlan.h"
#include "Common/BatchRows.h"
#include "Common/Bids.h"
#include "Common/EarlierRuns.h"
#include "Dataset.h"
#include "Products.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

std::optional<double> numberAt(const Json& json, const char* key) {
    const auto found = json.find(key);
    if (found == json.end() || !found->is_number()) return std::nullopt;
    return found->get<double>();
}

void addMeasures(const Json& surface, QualityRow& row) {
    row[Measure::Vertices] = numberAt(surface, "vertices");
    row[Measure::Triangles] = numberAt(surface, "triangles");
    row[Measure::AreaMm2] = numberAt(surface, "areaMm2");
    row[Measure::VolumeMm3] = numberAt(surface, "volumeMm3");
    row[Measure::Genus] = numberAt(surface, "genus");
}

QualityRow isosurfaceRow(const QualityRow& scan, const Json& surface) {
    QualityRow row = scan;
    addMeasures(surface, row);
    row[Measure::Isovalue] = numberAt(surface, "isovalue");
    row[Measure::Components] = numberAt(surface, "componentCount");
    row[Measure::CrossingPairs] = numberAt(surface.at("soundness"), "crossingPairs");
    return row;
}

std::vector<QualityRow> headRows(const QualityRow& scan, const Json& report) {
    std::vector<QualityRow> rows;
    const Json& gaps = report.at("gaps");
    for (const Json& surface : report.at("surfaces")) {
        QualityRow row = scan;
        row.part = surface.at("name");
        addMeasures(surface, row);
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

QualityRow regionRow(const QualityRow& scan, const Json& region) {
    QualityRow row = scan;
    row.part = std::to_string(region.at("label").get<long long>());
    row.name = region.at("name");
    addMeasures(region, row);
    row[Measure::Components] = numberAt(region, "components");
    return row;
}

/// Which of several isosurfaces a planned record is of: "iso100", "isoauto".
std::string partOf(const fs::path& surface) {
    const std::string label = entityOf(surface.filename().string(), "desc");
    return surface.empty() ? std::string() : label;
}

/// What adaptiso-check has found of surfaces, by their files.
using Checks = std::map<fs::path, std::pair<QualityState, std::string>>;

Checks lookAtChecks(const BidsOptions& options, const Product& surfaces) {
    Product product = checkOf(options, surfaces);
    bindItems(product);
    Checks checks;
    if (product.items.empty()) return checks;
    const BatchPlan plan(product.program, product.batch, options.common);
    EarlierRuns earlier(product.program, plan);
    for (std::size_t n = 0; n < plan.items().size(); ++n) {
        constexpr bool kTrustsTimes = true;
        const EarlierRecord found = earlier.look(n, kTrustsTimes).front();
        auto& [state, text] = checks[plan.items()[n].inputs.front().lexically_normal()];
        if (!found.why.empty()) {
            state = QualityState::Missing;
            text = "its check: " + found.why;
        } else {
            const bool hasPassed = found.record->run.hasPassed();
            state = hasPassed ? QualityState::Done : QualityState::Unsound;
            text = hasPassed ? "passed" : found.record->says;
        }
    }
    return checks;
}

class CohortLook {
public:
    CohortLook(const BidsOptions& options, const ChosenSubjects& chosen)
        : options_(options), chosen_(chosen), subjects_(chosen.folders) {}

    Cohort run() {
        std::deque<Product> products = findProducts(options_, subjects_);
        if (options_.makesChecks) checks_ = lookAtChecks(options_, products.front());
        for (const auto& [subject, reason] : chosen_.faulty) {
            QualityRow row;
            row.participant = subject;
            addAbsent(std::move(row), QualityState::Failed, reason);
        }
        for (const Product& product : products) look(product);
        if (options_.participants.empty() && options_.sessions.empty()) addLeftovers();
        sort();
        return std::move(cohort_);
    }

private:
    /// A line of the page, and the rows of the table that it stands for.
    struct Entry {
        SummaryRow line;
        std::vector<QualityRow> rows;
    };

    void look(const Product& product) {
        for (const std::string& subject : product.without) {
            QualityRow row;
            row.participant = subject;
            row.product = product.name;
            addAbsent(std::move(row), QualityState::Missing, "no " + product.needs);
        }
        if (product.items.empty()) return;
        const BatchPlan plan(product.program, product.batch, options_.common);
        EarlierRuns earlier(product.program, plan);
        for (std::size_t n = 0; n < plan.items().size(); ++n) {
            const BatchItem& item = plan.items()[n];
            const std::vector<PlannedRecord> planned = plan.records(item);
            constexpr bool kTrustsTimes = true;
            const std::vector<EarlierRecord> found = earlier.look(n, kTrustsTimes);
            for (std::size_t k = 0; k < found.size(); ++k) {
                add(product, item, planned[k], found[k]);
            }
            earlier.forgetInputs(n);
        }
    }

    void add(const Product& product, const BatchItem& item, const PlannedRecord& planned,
             const EarlierRecord& found) {
        QualityRow row;
        row.participant = "sub-" + entityOf(item.name, "sub");
        const std::string session = entityOf(item.name, "ses");
        if (!session.empty()) row.session = "ses-" + session;
        row.scan = item.name;
        row.product = product.name;
        row.part = partOf(planned.surface);
        if (product.name == "surfaces") surfaces_.insert(planned.surface.filename().string());
        if (!item.fault.empty()) {
            cohort_.records += found.record ? 1 : 0;
            return addAbsent(std::move(row), QualityState::Failed,
                             baseName(item.inputs.front()) + ": " + item.fault);
        }
        if (!found.record) {
            cohort_.records += found.isThere ? 1 : 0;
            return addAbsent(std::move(row), QualityState::Missing,
                             found.isThere ? found.why : "not run");
        }
        ++cohort_.records;
        if (product.name == "surfaces") keepNames(found.record->run.outputs);
        Entry entry{summaryRow(planned.file, *found.record), {}};
        judge(*found.record, found.why, row);
        if (row.state == QualityState::Done || row.state == QualityState::Unsound) {
            addCheck(item, *found.record, row);
            entry.rows = rowsOfReport(row, found.record->run.report);
        }
        if (entry.rows.empty()) entry.rows.push_back(row);
        entry.line.state = row.state == QualityState::Done      ? RunState::Done
                           : row.state == QualityState::Missing ? RunState::Changed
                                                                : RunState::Failed;
        if (!found.record->hasEnded) entry.line.state = RunState::NotFinished;
        if (!row.reason.empty()) entry.line.says = row.reason;
        entries_.push_back(std::move(entry));
    }

    static void judge(const KeptRecord& record, const std::string& why, QualityRow& row) {
        const BatchRecord& run = record.run;
        if (record.hasEnded && !run.isFinished()) {
            row.state = QualityState::Failed;
            row.reason = run.error;
        } else if (!why.empty()) {
            row.state = QualityState::Missing;
            row.reason = why;
        } else if (!run.hasPassed()) {
            row.state = QualityState::Failed;
            row.reason = run.error.empty() ? record.says : run.error;
        }
    }

    void addCheck(const BatchItem& item, const KeptRecord& record, QualityRow& row) const {
        if (!options_.makesChecks || row.product != "surfaces") return;
        for (const std::string& output : record.run.outputs) {
            const auto check = checks_.find((item.folder / output).lexically_normal());
            if (check == checks_.end()) continue;
            const auto& [state, text] = check->second;
            row.state = state;
            if (state != QualityState::Done) row.reason = text;
            if (state != QualityState::Missing) row.check = text;
        }
    }

    void addAbsent(QualityRow row, QualityState state, const std::string& reason) {
        row.state = state;
        row.reason = reason;
        Entry entry;
        entry.line.name = row.scan.empty() ? row.participant : row.scan;
        entry.line.state = state == QualityState::Leftover ? RunState::Changed : RunState::NotRun;
        entry.line.program = row.product;
        entry.line.says = reason;
        entry.rows.push_back(std::move(row));
        entries_.push_back(std::move(entry));
    }

    /// What is of participants, sessions and scans of an earlier state of the dataset.
    void addLeftovers() {
        const std::set<std::string> known = namesOfScans();
        std::set<std::string> told;
        constexpr bool kHasSubjects = true;
        for (const SummaryRow& row : summaryRows({options_.output, kHasSubjects}, {}, {})) {
            const bool isOfScan = row.program == "adaptiso-mesh" || row.program == "adaptiso-bem" ||
                                  // their images may be in a folder that is not named now
                                  (row.program == "adaptiso-labels" && options_.makesLabels);
            if (!isOfScan) continue;
            if (known.contains(row.name)) {
                if (row.program == "adaptiso-mesh") addDropped(row);
                continue;
            }
            if (!told.insert(row.name).second) continue;
            addAbsent(leftRow(row), QualityState::Leftover,
                      "is in the output, but its image is not in the dataset; remove " + row.name +
                          "_desc-* and " + row.name + "_mesh* there");
        }
    }

    /// Of "iso=auto" the run says which isovalue is in the name.
    void keepNames(const std::vector<std::string>& outputs) {
        for (const std::string& output : outputs) {
            surfaces_.insert(fs::path(output).filename().string());
        }
    }

    static QualityRow leftRow(const SummaryRow& row) {
        QualityRow left;
        left.participant = "sub-" + entityOf(row.name, "sub");
        left.scan = row.name;
        return left;
    }

    /// Surfaces of an isovalue, or in a format, that was asked for earlier.
    void addDropped(const SummaryRow& row) {
        if (surfaces_.empty()) return;  // none are asked for
        for (const fs::path& file : row.outputs) {
            const std::string name = file.filename().string();
            if (surfaces_.contains(name) || file.extension() == ".json") continue;
            QualityRow left = leftRow(row);
            left.product = "surfaces";
            left.part = partOf(file);
            addAbsent(std::move(left), QualityState::Leftover,
                      name +
                          " is of an isovalue or a format that is not asked for now; remove it, "
                          "or ask for it too");
        }
    }

    /// Of all images that results can be of, whether asked for now or not.
    std::set<std::string> namesOfScans() const {
        std::set<std::string> names;
        const auto add = [&](const fs::path& subject, const BidsImages& images) {
            for (const BatchItem& item : bidsImagesOf(subject, {}, subject, images)) {
                names.insert(item.name);
            }
        };
        for (const fs::path& subject : subjects_) {
            add(subject, kBidsScans);
            add(subject, kBidsSegmentations);
            if (!options_.segmentations.empty()) {
                add(options_.segmentations / subject.filename(), kBidsSegmentations);
            }
        }
        return names;
    }

    /// By participant and scan; what is of one scan stays as asked for.
    void sort() {
        std::stable_sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) {
            const QualityRow &x = a.rows.front(), &y = b.rows.front();
            return std::tie(x.participant, x.session, x.scan) <
                   std::tie(y.participant, y.session, y.scan);
        });
        for (Entry& entry : entries_) {
            for (QualityRow& row : entry.rows) {
                cohort_.rows.push_back(std::move(row));
                cohort_.shownBy.push_back(cohort_.summary.size());
            }
            cohort_.summary.push_back(std::move(entry.line));
        }
    }

    const BidsOptions& options_;
    const ChosenSubjects& chosen_;
    const std::vector<fs::path>& subjects_;
    Checks checks_;
    std::set<std::string> surfaces_;  ///< names of the files that are asked for
    std::vector<Entry> entries_;
    Cohort cohort_;
};

/// The request for one product, as askedOf() returns it.
void takeAsked(const Json& asked, BidsOptions& options) {
    const std::string product = asked.value("product", ""), list = asked.value("options", "");
    if (product == "surfaces") options.surfaces = list;
    if (product == "bem") {
        options.makesBem = true;
        options.bemOptions = list;
    } else if (product == "labels") {
        options.makesLabels = true;
        options.labelsOptions = list;
        const std::string folder = asked.value("segmentations", "");
        if (!folder.empty() && options.segmentations.empty()) {
            options.segmentations = (options.output / folder).lexically_normal();
        }
    } else if (product == "check") {
        options.makesChecks = true;
        options.checkOptions = list;
    }
    options.makesPictures = options.makesPictures && asked.value("pictures", true);
    options.common.isStrict = options.common.isStrict || asked.value("strict", false);
    if (options.common.allowed.empty()) {
        options.common.allowed = asked.value("allow", std::vector<std::string>());
    }
}

}  // namespace

std::vector<QualityRow> rowsOfReport(const QualityRow& scan, const Json& report) {
    std::vector<QualityRow> rows;
    try {
        if (scan.product == "bem") return headRows(scan, report);
        if (scan.product == "labels") {
            for (const Json& region : report.at("regions")) rows.push_back(regionRow(scan, region));
            return rows;
        }
        for (const Json& surface : report.at("surfaces")) {
            rows.push_back(isosurfaceRow(scan, surface));
        }
    } catch (const Json::exception&) {
        // a record that was edited by hand
        QualityRow row = scan;
        row.state = QualityState::Missing;
        row.reason = "its record is damaged";
        rows = {row};
    }
    return rows;
}

void takeAsked(BidsOptions& options) {
    // of each program: what was asked for of each participant last, with the record's date
    std::map<std::string, std::map<std::string, std::pair<std::string, Json>>> last;
    std::error_code error;
    fs::recursive_directory_iterator entry(options.output, error);
    for (const fs::recursive_directory_iterator end; !error && entry != end;
         entry.increment(error)) {
        RecordFault fault = RecordFault::None;
        if (!isRecordFile(entry->path())) continue;
        const std::optional<KeptRecord> record = readRecord(entry->path(), fault);
        if (!record || !record->asked.is_object()) continue;
        auto& [date, asked] = last[record->program][entityOf(record->run.name, "sub")];
        if (record->date < date) continue;
        date = record->date;
        asked = record->asked;
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
        takeAsked(Json::parse(most->first), options);
    }
}

Json askedOf(const BidsOptions& options) {
    Json asked = Json::array();
    if (!options.surfaces.empty()) asked.push_back(askedOf(options, "surfaces"));
    if (options.makesBem) asked.push_back(askedOf(options, "bem"));
    if (options.makesLabels) asked.push_back(askedOf(options, "labels"));
    if (options.makesChecks) asked.push_back(askedOf(options, "check"));
    return asked;
}

Cohort lookAtCohort(const BidsOptions& options, const ChosenSubjects& chosen) {
    return CohortLook(options, chosen).run();
}

}  // namespace adaptiso
