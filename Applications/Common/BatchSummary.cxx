#include "Common/BatchSummary.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <set>
#include <string_view>
#include <tuple>
#include <utility>

#include "Common/CommonOptions.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kStyle = R"(
body{font:16px/1.4 sans-serif;margin:2em 0;padding:0 1em;color:#111;background:#fff}
table{border-collapse:collapse;width:100%;min-width:44em}
.scroll{overflow-x:auto}.scroll:focus-visible{outline:3px solid #4c9aff}
th,td{border-bottom:1px solid #bbb;padding:.4em .6em;text-align:left;vertical-align:top}
tbody th,td{overflow-wrap:anywhere}td.ok,td.failed,td.time,td.number{white-space:nowrap;overflow-wrap:normal}
.ok{color:#00532c;font-weight:bold}.failed{color:#a00000;font-weight:bold}
tr.bad{background:#fff0f0}tr.unusual{background:#fff8e0}img{max-width:160px;max-height:120px}td.number{text-align:right}
@media print{@page{size:A4;margin:15mm}body{margin:0;font-size:11px}tr{break-inside:avoid}.scroll{overflow:visible}table{min-width:0}}
)";

/// A link's target, percent-encoded.
std::string linkTo(const fs::path& target, const fs::path& page) {
    constexpr std::string_view kDigits = "0123456789ABCDEF";
    const fs::path folder = fs::absolute(page).parent_path();
    std::string link;
    for (const char c : fs::proximate(fs::absolute(target), folder).generic_string()) {
        const auto byte = static_cast<unsigned char>(c);
        const bool isPlain = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') ||
                             (c >= 'A' && c <= 'Z') ||
                             std::string_view("-._~/").find(c) != std::string_view::npos;
        if (isPlain) {
            link += c;
        } else {
            link += {'%', kDigits[byte >> 4], kDigits[byte & 15]};
        }
    }
    return link;
}

std::string anchor(const fs::path& target, const std::string& text, const fs::path& page) {
    return "<a href=\"" + linkTo(target, page) + "\">" + escapedMarkup(text) + "</a>";
}

std::string pictureSource(const SummaryRow& row, const fs::path& page) {
    for (const std::string_view name : {"contours-axial.png", "surface-1.png"}) {
        if (!row.pictures.empty() && fs::exists(row.pictures / name)) {
            return linkTo(row.pictures / name, page);
        }
    }
    return "";
}

std::string thumbnail(const SummaryRow& row, const fs::path& page) {
    const std::string source = pictureSource(row, page);
    if (source.empty()) return {};
    const std::string image =
        "<img src=\"" + source + "\" alt=\"picture of " + escapedMarkup(row.name) + "\">";
    if (row.report.empty()) return image;
    return "<a href=\"" + linkTo(row.report, page) + "\">" + image + "</a>";
}

/// The mark and the words of a state.
std::string_view stateText(RunState state) {
    constexpr const char* kWords[] = {
        "&#10007;&nbsp;FAILED",  "&#10007;&nbsp;MISSING or CHANGED", "&#10007;&nbsp;not finished",
        "&#10007;&nbsp;not run", "&#9888;&nbsp;done, unusual",       "&#10003;&nbsp;done"};
    return kWords[static_cast<std::size_t>(state)];
}

bool hasRun(const SummaryRow& row) {
    return row.state == RunState::Done || row.state == RunState::Unusual;
}

/// Columns that say more than others.
struct Columns {
    bool hasProgram, hasInput, hasPicture;
};

Columns columnsOf(const std::vector<SummaryRow>& rows, const fs::path& page) {
    const auto any = [&](const auto& isSo) { return std::ranges::any_of(rows, isSo); };
    return {any([&](const SummaryRow& row) { return row.program != rows.front().program; }),
            any([](const SummaryRow& row) { return !row.file.starts_with(row.name); }),
            any([&](const SummaryRow& row) { return !pictureSource(row, page).empty(); })};
}

std::string cell(bool isWanted, const std::string& html) {
    return isWanted ? "<td>" + html + "</td>" : "";
}

std::string rowText(const SummaryRow& row, const fs::path& page, const Columns& columns) {
    std::string files;
    constexpr std::size_t kMostFiles = 12;
    for (std::size_t n = 0; n < std::min(kMostFiles, row.outputs.size()); ++n) {
        const fs::path& output = row.outputs[n];
        addPart(files, anchor(output, output.filename().string(), page), "<br>");
    }
    if (row.outputs.size() > kMostFiles) {
        files += "<br>and " + std::to_string(row.outputs.size() - kMostFiles) + " more";
    }
    const std::string report =
        row.report.empty() ? "" : anchor(row.report, "report of " + row.name, page);
    const bool isDone = hasRun(row);
    const std::string_view mark = !isDone                          ? " class=\"bad\""
                                  : row.state == RunState::Unusual ? " class=\"unusual\""
                                                                   : "";
    return std::string("<tr") + std::string(mark) + "><td class=\"" + (isDone ? "ok" : "failed") +
           "\">" + std::string(stateText(row.state)) + "</td><th scope=\"row\">" +
           escapedMarkup(row.name) + "</th>" +
           cell(columns.hasProgram, escapedMarkup(row.program)) +
           cell(columns.hasInput, escapedMarkup(row.file)) + "<td>" + escapedMarkup(row.says) +
           "</td><td>" + report + (report.empty() || files.empty() ? "" : "<br>") + files +
           "</td>" + cell(columns.hasPicture, thumbnail(row, page)) + "<td class=\"time\">" +
           escapedMarkup(row.date) + "</td><td class=\"number\">" +
           (row.seconds > 0 ? formatFixed(row.seconds, 1) : "") + "</td></tr>\n";
}

/// "2 of 12 failed, 1 missing or changed"; "All 12 done".
std::string verdictOf(const std::vector<SummaryRow>& rows) {
    const auto count = [&rows](RunState state) {
        return std::count_if(rows.begin(), rows.end(),
                             [state](const SummaryRow& row) { return row.state == state; });
    };
    const std::string all = std::to_string(rows.size());
    std::string text;
    for (const auto& [state, words] :
         {std::pair{RunState::Failed, "failed"}, std::pair{RunState::Changed, "missing or changed"},
          std::pair{RunState::NotFinished, "not finished"},
          std::pair{RunState::NotRun, "not run"}}) {
        if (count(state) == 0) continue;
        text += (text.empty() ? std::to_string(count(state)) + " of " + all
                              : ", " + std::to_string(count(state))) +
                " " + words;
    }
    if (text.empty()) text = rows.empty() ? "Nothing was run" : "All " + all + " done";
    const auto unusual = count(RunState::Unusual);
    return text + (unusual == 0 ? "" : ", " + std::to_string(unusual) + " unusual");
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

SummaryRow summaryRow(const fs::path& file, const RunRecord& record) {
    const fs::path folder = detail::folderOf(file);
    SummaryRow row{record.program, record.name};
    row.file = joined(record.files);
    row.seconds = record.seconds;
    row.date = record.date;
    if (!record.hasEnded) {
        row.state = RunState::NotFinished;
        row.says = "not finished: it runs, or was interrupted";
        return row;
    }
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
    row.says = record.error.empty() ? record.says : record.error;
    const std::string changes = changesOf(record, folder);
    if (!changes.empty()) row.says = changes + (row.says.empty() ? "" : " (" + row.says + ")");
    row.state = !record.hasPassed() ? RunState::Failed
                : changes.empty()   ? RunState::Done
                                    : RunState::Changed;
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
        byFile.emplace(file,
                       SummaryRow{"", file.filename().string(), "", RunState::NotFinished,
                                  fault == RecordFault::OfAnotherVersion
                                      ? "a record of another version of adaptiso; run it again"
                                      : "a damaged record; run it again"});
    }
    std::vector<SummaryRow> rows;
    for (auto& [file, row] : byFile) rows.push_back(std::move(row));
    std::ranges::stable_sort(rows, {}, &SummaryRow::state);
    return rows;
}

void writeSummary(const fs::path& page, const fs::path& folder,
                  const std::map<fs::path, RunRecord>& own, const fs::path& ownFolder) {
    const int lock = open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_CLOEXEC);
    if (lock >= 0) flock(lock, LOCK_EX);  // fails where the file system has none
    try {
        writeWhole(page, summaryPage(summaryRows(folder, own), page), ownFolder);
    } catch (...) {
        close(lock);
        throw;
    }
    close(lock);
}

std::string summaryPage(const std::vector<SummaryRow>& rows, const fs::path& page) {
    const bool isDone = !rows.empty() && std::all_of(rows.begin(), rows.end(), hasRun);
    const std::string verdict = verdictOf(rows);
    const Columns columns = columnsOf(rows, page);
    const bool isOfOne = !rows.empty() && !columns.hasProgram && !rows.front().program.empty();
    std::string text =
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
        "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src 'self' "
        "file:; style-src 'unsafe-inline'; form-action 'none'; base-uri 'none'\">"
        "<meta name=\"viewport\" content=\"width=device-width\">"
        "<meta name=\"referrer\" content=\"no-referrer\"><title>adaptiso: " +
        verdict + "</title><style>" + std::string(kStyle) +
        "</style></head><body><main>\n<h1 class=\"" + (isDone ? "ok" : "failed") + "\">" + verdict +
        "</h1>\n<p>adaptiso " + programVersion() +
        (isOfOne ? ", " + escapedMarkup(rows.front().program) : "") +
        "</p>\n<div class=\"scroll\" role=\"region\" tabindex=\"0\" aria-label=\"Runs\">"
        "<table><caption>Every run that has a record in this folder; those that need attention "
        "come "
        "first</caption>\n<thead><tr><th>verdict</th><th>name</th>" +
        std::string(columns.hasProgram ? "<th>program</th>" : "") +
        (columns.hasInput ? "<th>input</th>" : "") + "<th>result</th><th>files</th>" +
        (columns.hasPicture ? "<th>picture</th>" : "") +
        "<th>date</th><th>seconds</th></tr></thead><tbody>\n";
    for (const SummaryRow& row : rows) text += rowText(row, page, columns);
    return text + "</tbody></table></div>\n</main></body></html>\n";
}

}  // namespace adaptiso
