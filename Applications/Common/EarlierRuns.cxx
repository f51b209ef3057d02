#include "Common/EarlierRuns.h"

#include <algorithm>
#include <utility>

#include "adaptiso/Core/Errors.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

/// A name in the words of a reason: of a file, not of the folders that it lies in.
std::string nameOf(const fs::path& path) {
    return path.filename().string();
}

std::vector<std::string> namesOf(const std::vector<KeptOption>& options) {
    std::vector<std::string> names;
    for (const KeptOption& option : options) names.push_back(option.name);
    return names;
}

/// "--method" where only its value differs.
std::string differenceOf(const std::vector<KeptOption>& before,
                         const std::vector<KeptOption>& now) {
    if (namesOf(before) != namesOf(now)) return "other options were given";
    for (std::size_t n = 0; n < now.size(); ++n) {
        if (before[n] != now[n]) return "another " + now[n].name + " was given";
    }
    return {};
}

/// The record tells of what an option asks for: of the file, or of one in the folder.
bool isKept(const BatchItem& item, const KeptRecord& record, const std::string& option,
            const fs::path& path) {
    return std::any_of(record.outputs.begin(), record.outputs.end(), [&](const auto& output) {
        const fs::path file = (item.folder / output.file.file).lexically_normal();
        return output.option == option &&
               (file == path.lexically_normal() ||
                file.parent_path() == (path / "").lexically_normal().parent_path());
    });
}

std::string wordsOf(RecordFault fault) {
    return fault == RecordFault::Damaged ? "its record is damaged"
                                         : "its record is of another version";
}

}  // namespace

EarlierRuns::EarlierRuns(const BatchProgram& program, const BatchPlan& plan)
    : program_(program), plan_(plan), inputs_(plan.items().size()) {}

std::vector<EarlierRecord> EarlierRuns::look(std::size_t item, bool trustsTimes) {
    std::vector<EarlierRecord> found;
    for (const PlannedRecord& planned : plan_.records(plan_.items()[item])) {
        found.push_back(look(item, planned, trustsTimes));
    }
    return found;
}

EarlierRecord EarlierRuns::look(std::size_t item, const PlannedRecord& planned, bool trustsTimes) {
    RecordFault fault = RecordFault::None;
    EarlierRecord found{readRecord(planned.file, fault)};
    if (!found.record) {
        std::error_code error;
        found.isThere = fault != RecordFault::Missing ||
                        (!planned.surface.empty() && fs::exists(planned.surface, error));
        found.why = !found.isThere                  ? "nothing is there"
                    : fault == RecordFault::Missing ? nameOf(planned.surface) + " has no record"
                                                    : wordsOf(fault);
        return found;
    }
    const KeptRecord& record = *found.record;
    if (!record.hasEnded) {
        found.why = "its last run did not end";
    } else if (!record.run.isFinished()) {
        found.why = "its last run failed";
    } else if (record.version != program_.versionText()) {
        found.why = "another version has made it";
    } else {
        found.why = differenceOf(record.options, planned.options);
        if (found.why.empty()) found.why = changeOfInputs(item, record, trustsTimes);
        if (found.why.empty()) {
            found.why = changeOfOutputs(plan_.items()[item], record, planned, trustsTimes);
        }
    }
    return found;
}

bool EarlierRuns::areDone(const std::vector<EarlierRecord>& found) {
    return std::all_of(found.begin(), found.end(),
                       [](const EarlierRecord& one) { return one.why.empty(); });
}

std::string EarlierRuns::reasonOf(const std::vector<EarlierRecord>& found) {
    const auto one = std::find_if(found.begin(), found.end(),
                                  [](const EarlierRecord& each) { return !each.why.empty(); });
    return one == found.end() || !one->isThere ? std::string() : one->why;
}

std::string EarlierRuns::changeOfInputs(std::size_t item, const KeptRecord& record,
                                        bool trustsTimes) {
    if (trustsTimes && haveTimesOf(item, record)) return {};
    const std::vector<KeptInput>& now = inputs(item);
    if (now.size() != record.inputs.size()) return "its input can't be read, or could not";
    for (std::size_t k = 0; k < now.size(); ++k) {
        if (changeOf(record.inputs[k].file, now[k].file) != FileChange::None) {
            return "the input " + now[k].file.file + " has changed";
        }
    }
    return {};
}

/// Compares surfaces and requested extras; other outputs are ignored.
std::string EarlierRuns::changeOfOutputs(const BatchItem& item, const KeptRecord& record,
                                         const PlannedRecord& planned, bool trustsTimes) const {
    const auto extras = plan_.extras(item);
    for (const auto& [option, path] : extras) {
        if (!isKept(item, record, option, path)) return nameOf(path) + " was not made";
    }
    if (!planned.surface.empty() && record.run.outputs.empty()) return "it holds no surface";
    for (const KeptOutput& output : record.outputs) {
        const bool isAsked = output.option == kOutputOption ||
                             std::any_of(extras.begin(), extras.end(), [&](const auto& extra) {
                                 return extra.first == output.option;
                             });
        if (!isAsked) continue;
        const fs::path path = item.folder / output.file.file;
        switch (changeOf(output.file, path, trustsTimes)) {
            case FileChange::None:
                break;
            case FileChange::Gone:
                return nameOf(path) + " is gone";
            case FileChange::Changed:
                return nameOf(path) + " has changed";
        }
    }
    return {};
}

bool EarlierRuns::haveTimesOf(std::size_t item, const KeptRecord& record) const {
    const std::vector<fs::path> paths = plan_.inputs(plan_.items()[item]);
    if (paths.size() != record.inputs.size()) return false;
    for (std::size_t k = 0; k < paths.size(); ++k) {
        const KeptFile& kept = record.inputs[k].file;
        // one without checksum has changed while it was read
        if (kept.sha256.empty() || !hasTimesOf(kept, paths[k], plan_.folder())) return false;
    }
    return true;
}

const std::vector<KeptInput>& EarlierRuns::inputs(std::size_t item) {
    if (inputs_[item]) return *inputs_[item];
    const BatchItem& read = plan_.items()[item];
    std::vector<KeptInput>& inputs = inputs_[item].emplace();
    try {
        for (const fs::path& path : plan_.inputs(read)) {
            inputs.push_back({keptInput(path, plan_.folder()), placeOf(read, path)});
        }
    } catch (const FileError&) {
        inputs.clear();  // the run will say so
    }
    return inputs;
}

std::vector<KeptInput> EarlierRuns::unchangedInputs(std::size_t item) {
    std::vector<KeptInput> kept = inputs(item);
    const std::vector<fs::path> paths = plan_.inputs(plan_.items()[item]);
    for (std::size_t k = 0; k < kept.size(); ++k) {
        if (!hasTimesOf(kept[k].file, paths[k], plan_.folder())) kept[k].file.sha256 = "";
    }
    return kept;
}

/// From the record's folder, of an input in the folder that all is written to.
std::string EarlierRuns::placeOf(const BatchItem& item, const fs::path& input) const {
    if (plan_.folder().empty()) return {};
    const fs::path file = fs::absolute(input).lexically_normal();
    const std::string inBase =
        file.lexically_relative(fs::absolute(plan_.folder()).lexically_normal()).string();
    if (inBase.empty() || inBase.starts_with("..")) return {};
    return file.lexically_relative(fs::absolute(item.folder).lexically_normal()).string();
}

}  // namespace adaptiso
