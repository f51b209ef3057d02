#include "Common/BatchSummary.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/Warning.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

/// The volumes of the record's surfaces or regions, by their names, labels or places in the run.
void addVolumes(const RunRecord& record, SummaryRow& row) {
    const Json surfaces = surfacesOf(record);
    for (std::size_t n = 0; n < surfaces.size(); ++n) {
        const Json& surface = surfaces[n];
        const auto volume = surface.is_object() ? surface.find("volumeMm3") : surface.end();
        if (volume == surface.end() || !volume->is_number()) continue;
        std::string name;
        if (surface.value("name", Json()).is_string()) {
            name = surface["name"];
        } else if (surface.contains("label")) {
            name = surface["label"].dump();
        } else if (surfaces.size() > 1) {
            name = "surface " + std::to_string(n + 1);
        }
        row.volumesMm3.emplace_back(name, volume->get<double>());
    }
}

/// Differences from the record, in words; may be empty.
std::string changesOf(const RunRecord& record, const fs::path& folder) {
    std::string changes;
    const auto add = [&](const RecordedFile& file, const fs::path& path, const char* since) {
        const FileChange change = changeOf(file, path);
        if (change == FileChange::None) return;
        addPart(changes, path.filename().string() + " " + changeText(change), "; ");
        if (change == FileChange::Changed) changes += std::string(" since it was ") + since;
    };
    for (const RecordedFile& input : record.inputs) {
        if (!input.place.empty()) add(input, folder / input.place, "read");
    }
    for (const RecordedFile& output : record.recordedOutputs) {
        add(output, folder / output.file, "written");
    }
    return changes;
}

}  // namespace

std::string reasonOf(std::string error, const std::vector<std::string>& files) {
    for (const std::string& file : files) {
        if (error.starts_with(file + ": ")) error.erase(0, file.size() + 2);
    }
    error.resize(std::min(error.find("; "), error.size()));
    std::string kind;
    for (std::size_t n = 0; n < error.size(); ++n) {
        const bool begins = n == 0 || error[n - 1] == ' ' || error[n - 1] == '(';
        std::size_t end = std::min(error.find_first_not_of("0123456789.,-+", n), error.size());
        const bool isNumber =
            begins && error.find_first_of("0123456789", n) < end && (error[end - 1] != '.');
        while (isNumber && error.find_last_of("0123456789", end - 1) != end - 1) --end;
        kind += isNumber ? 'N' : error[n];
        if (isNumber) n = end - 1;
    }
    return kind;
}

SummaryRow recordRow(const RunRecord& record) {
    SummaryRow row{record.program, record.name};
    row.file = joined(record.files);
    row.seconds = record.seconds;
    if (!record.hasEnded) {
        row.state = RunState::NotFinished;
        row.says = "not finished: it runs, or was interrupted";
        row.reason = "it runs, or was interrupted";
        return row;
    }
    row.date = record.date;
    row.says = record.error.empty() ? record.says : record.error;
    for (const Warning& warning : record.warnings) {
        if (!isNote(warning)) row.warnings.push_back(warning);
    }
    row.state = !record.isFinished()   ? RunState::Failed
                : !record.hasPassed()  ? RunState::CheckFailed
                : row.warnings.empty() ? RunState::Done
                                       : RunState::Warned;
    if (!record.hasPassed()) row.reason = reasonOf(row.says, record.files);
    addVolumes(record, row);
    return row;
}

SummaryRow summaryRow(const fs::path& file, const RunRecord& record) {
    const fs::path folder = detail::folderOf(file);
    SummaryRow row = recordRow(record);
    if (!record.hasEnded) return row;
    for (const RecordedFile& output : record.recordedOutputs) {
        const fs::path path = folder / output.file;
        std::error_code error;
        if (!fs::exists(path, error)) continue;
        if (output.option == "--report") {
            row.report = path;
        } else if (output.option == "--pictures") {
            row.pictures = path.parent_path();
        } else {
            row.outputs.push_back(path);
        }
    }
    const std::string changes = changesOf(record, folder);
    if (changes.empty()) return row;
    row.says = changes + (row.says.empty() ? "" : " (" + row.says + ")");
    if (!record.hasPassed()) return row;
    row.state = RunState::Changed;
    row.reason = "a file is gone or has changed";
    return row;
}

std::vector<SummaryRow> summaryRows(const fs::path& folder,
                                    const std::map<fs::path, RunRecord>& own) {
    std::map<fs::path, SummaryRow> byFile;
    for (const auto& [file, record] : own) byFile.emplace(file, summaryRow(file, record));
    for (const fs::path& file : recordFiles(folder, false)) {
        RunRecord record;
        const RecordFault fault =
            own.contains(file) ? RecordFault::Missing : readRecord(file, record);
        if (fault == RecordFault::None) byFile.emplace(file, summaryRow(file, record));
        if (fault == RecordFault::None || fault == RecordFault::Missing) continue;
        SummaryRow row{"", file.filename().string(), "", RunState::NotFinished};
        row.says = fault == RecordFault::OfAnotherVersion
                       ? "a record of another version of adaptiso; run it again"
                       : "a damaged record; run it again";
        row.reason = reasonOf(row.says);
        byFile.emplace(file, std::move(row));
    }
    std::vector<SummaryRow> rows;
    for (auto& [file, row] : byFile) rows.push_back(std::move(row));
    sortByNeed(rows);
    return rows;
}

void writeSummary(const fs::path& page, const fs::path& folder,
                  const std::map<fs::path, RunRecord>& own, const fs::path& ownFolder,
                  Summary summary) {
    const int lock = open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_CLOEXEC);
    if (lock >= 0) flock(lock, LOCK_EX);  // fails where the file system has none
    try {
        summary.rows = summaryRows(folder, own);
        writeWhole(page, summaryPage(summary, page), ownFolder);
    } catch (...) {
        close(lock);
        throw;
    }
    close(lock);
}

}  // namespace adaptiso
