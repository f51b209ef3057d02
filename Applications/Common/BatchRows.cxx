#include "Common/BatchRows.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <set>
#include <thread>
#include <tuple>
#include <utility>

#include "Common/AtomicOutput.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

/// Size and time of each record: what the page was built from.
using Snapshot = std::map<fs::path, std::pair<std::int64_t, std::int64_t>>;

void addRecordFiles(const fs::path& folder, bool isDeep, Snapshot& found) {
    std::error_code error, ignored;
    fs::directory_iterator entry(folder, error);
    for (const fs::directory_iterator end; !error && entry != end; entry.increment(error)) {
        const fs::path& path = entry->path();
        if (isDeep && entry->is_directory(ignored) && !path.filename().native().starts_with('.')) {
            addRecordFiles(path, true, found);
        }
        if (!isRecordFile(path) || !entry->is_regular_file(ignored)) continue;
        struct stat status {};
        if (stat(path.c_str(), &status) != 0) continue;
        constexpr std::int64_t kPerSecond = 1'000'000'000;
        found[path.lexically_normal()] = {
            status.st_size, status.st_mtim.tv_sec * kPerSecond + status.st_mtim.tv_nsec};
    }
}

Snapshot recordFiles(const RecordPlace& place) {
    const fs::path folder = place.folder.empty() ? fs::path(".") : place.folder;
    Snapshot found;
    addRecordFiles(folder, false, found);
    if (!place.hasSubjects) return found;
    std::error_code error, ignored;
    fs::directory_iterator entry(folder, error);
    for (const fs::directory_iterator end; !error && entry != end; entry.increment(error)) {
        const bool isSubject = entry->path().filename().native().starts_with("sub-");
        if (isSubject && entry->is_directory(ignored)) addRecordFiles(entry->path(), true, found);
    }
    return found;
}

std::string joined(const std::vector<std::string>& texts, const char* separator) {
    std::string all;
    for (const std::string& text : texts) all += (all.empty() ? "" : separator) + text;
    return all;
}

/// What differs from what was kept, in words; empty: nothing.
std::string changesOf(const KeptRecord& record, const fs::path& folder) {
    std::vector<std::string> changes;
    const auto look = [&](const KeptFile& file, const fs::path& path, const char* since) {
        constexpr bool kTrustsTimes = true;
        const std::string name = path.filename().string();
        switch (changeOf(file, path, kTrustsTimes)) {
            case FileChange::None:
                break;
            case FileChange::Gone:
                changes.push_back(name + " is gone");
                break;
            case FileChange::Changed:
                changes.push_back(name + " has changed since it was " + since);
                break;
        }
    };
    for (const KeptInput& input : record.inputs) {
        if (!input.place.empty()) look(input.file, folder / input.place, "read");
    }
    for (const KeptOutput& output : record.outputs) {
        look(output.file, folder / output.file.file, "written");
    }
    return joined(changes, "; ");
}

void addOutputs(const KeptRecord& record, const fs::path& folder, SummaryRow& row) {
    for (const KeptOutput& output : record.outputs) {
        const fs::path path = folder / output.file.file;
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
}

}  // namespace

SummaryRow summaryRow(const fs::path& file, const KeptRecord& record) {
    const fs::path folder = detail::folderOf(file);
    SummaryRow row;
    row.program = record.program;
    row.name = record.run.name;
    row.file = joined(record.run.files, ", ");
    row.seconds = record.run.seconds;
    row.date = record.date;
    if (!record.hasEnded) {
        row.state = RunState::NotFinished;
        row.says = "not finished: it runs, or was interrupted";
        return row;
    }
    addOutputs(record, folder, row);
    row.says = record.run.error.empty() ? record.says : record.run.error;
    const std::string changes = changesOf(record, folder);
    if (!changes.empty())
        row.says =
            changes + (row.says.empty() ? "" : " (") + row.says + (row.says.empty() ? "" : ")");
    row.state = !record.run.hasPassed() ? RunState::Failed
                : changes.empty()       ? RunState::Done
                                        : RunState::Changed;
    return row;
}

namespace {

/// Of a file that should be a record.
SummaryRow faultyRow(const fs::path& file, RecordFault fault) {
    SummaryRow row;
    row.name = file.filename().string();
    row.state = RunState::NotFinished;
    row.says = fault == RecordFault::OfAnotherVersion
                   ? "a record of another version of adaptiso; run it again"
                   : "a damaged record; run it again";
    return row;
}

SummaryRow rowOfUnknown(const BatchItem& item) {
    SummaryRow row;
    row.name = item.name;
    row.file = baseName(item.inputs.front());
    row.state = RunState::NotRun;
    row.says = "not run";
    return row;
}

/// While one lives, no other process on this machine writes a page for the folder, as far as its
/// file system can say so. Nobody is waited for longer than 10 s.
class FolderLock {
public:
    explicit FolderLock(const fs::path& folder)
        : folder_(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
        constexpr int kTries = 200;
        constexpr std::chrono::milliseconds kPause(50);
        for (int n = 0; folder_ >= 0 && n < kTries; ++n) {
            if (flock(folder_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
            std::this_thread::sleep_for(kPause);
        }
    }
    ~FolderLock() {
        if (folder_ >= 0) close(folder_);
    }
    FolderLock(const FolderLock&) = delete;
    FolderLock& operator=(const FolderLock&) = delete;

private:
    int folder_;
};

std::vector<SummaryRow> rowsOf(const Snapshot& kept, const Records& own,
                               const std::vector<BatchItem>& expected) {
    std::vector<std::pair<fs::path, SummaryRow>> placed;
    std::set<std::pair<fs::path, std::string>> known;  // folders and names of items
    const auto add = [&](const fs::path& file, const KeptRecord& record) {
        known.emplace(detail::folderOf(file).lexically_normal(), record.run.name);
        placed.emplace_back(file, summaryRow(file, record));
    };
    for (const auto& [file, seen] : kept) {
        if (own.contains(file)) continue;
        RecordFault fault = RecordFault::None;
        if (const std::optional<KeptRecord> record = readRecord(file, fault)) {
            add(file, *record);
        } else if (fault != RecordFault::Missing) {
            placed.emplace_back(file, faultyRow(file, fault));
        }
    }
    for (const auto& [file, record] : own) add(file, record);

    std::vector<const BatchItem*> unknown;
    for (const BatchItem& item : expected) {
        if (!known.contains({item.folder.lexically_normal(), item.name})) unknown.push_back(&item);
    }
    // where none of them is known, surfaces are somebody else's
    if (unknown.size() < expected.size()) {
        for (const BatchItem* item : unknown) {
            placed.emplace_back(item->folder / item->name, rowOfUnknown(*item));
        }
    }
    std::stable_sort(placed.begin(), placed.end(), [](const auto& a, const auto& b) {
        return std::tie(a.second.state, a.first) < std::tie(b.second.state, b.first);
    });
    std::vector<SummaryRow> rows;
    for (auto& [file, row] : placed) rows.push_back(std::move(row));
    return rows;
}

}  // namespace

std::vector<SummaryRow> summaryRows(const RecordPlace& place, const Records& own,
                                    const std::vector<BatchItem>& expected) {
    return rowsOf(recordFiles(place), own, expected);
}

void writeSummary(const fs::path& page, const RecordPlace& place, const Records& own,
                  const std::vector<BatchItem>& expected) {
    const FolderLock lock(place.folder.empty() ? fs::path(".") : place.folder);
    // where nothing can be locked another may write its page over this one meanwhile; whoever
    // finds other records after that than before builds it anew
    constexpr int kMostTries = 20;
    Snapshot seen = recordFiles(place);
    for (int n = 0; n < kMostTries; ++n) {
        std::vector<AtomicOutput> outputs;
        outputs.emplace_back(page).writeText(summaryPage(rowsOf(seen, own, expected), page));
        AtomicOutput::commit(outputs);
        Snapshot now = recordFiles(place);
        if (now == seen) return;
        seen = std::move(now);
    }
}

}  // namespace adaptiso
