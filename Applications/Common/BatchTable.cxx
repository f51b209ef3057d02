#include <algorithm>
#include <map>

#include "Common/BatchSummary.h"
#include "Common/Naming.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/TextCells.h"

namespace adaptiso {
namespace {

std::string commaCell(const std::string& text) {
    const std::string cell = text.empty() ? "" : writtenCell(text);
    if (cell.find_first_of(",\"") == std::string::npos) return cell;
    return '"' + replaced(cell, "\"", "\"\"") + '"';
}

std::string cellText(const Json& value) {
    return value.is_string() ? value.get<std::string>() : value.is_null() ? "" : value.dump();
}

}  // namespace

Json surfacesOf(const RunRecord& record) {
    for (const char* const key : {"surfaces", "regions", "output"}) {
        if (!record.report.is_object() || !record.report.contains(key)) continue;
        const Json& found = record.report.at(key);
        return found.is_array() ? found : Json::array({found});
    }
    return Json::array();
}

std::string batchTable(const std::vector<RunRecord>& records) {
    std::vector<std::string> columns;
    std::vector<std::map<std::string, std::string>> rows;
    for (const RunRecord& record : records) {
        const Json surfaces = surfacesOf(record);
        for (std::size_t n = 0; n == 0 || n < surfaces.size(); ++n) {
            auto& row = rows.emplace_back();
            const auto add = [&](const std::string& column, const std::string& text) {
                if (std::ranges::find(columns, column) == columns.end()) columns.push_back(column);
                row.emplace(column, text);
            };
            add("run", record.name);  // "name" is a region's
            add("input", joined(record.files));
            add("state", record.hasPassed() ? "done" : "failed");
            add("exitCode", record.signal == 0 ? std::to_string(record.exitCode) : "");
            add("result", record.error.empty() ? record.says : record.error);
            add("warnings",
                joined(
                    record.warnings, [](const Warning& warning) { return warning.code; }, " "));
            add("seconds", Json(record.seconds).dump());
            const std::size_t most = std::max<std::size_t>(surfaces.size(), 1);
            // a region has "file"
            add("output", record.outputs.size() == most ? record.outputs[n] : "");
            if (n >= surfaces.size() || !surfaces[n].is_object()) continue;
            for (const auto& [key, value] : surfaces[n].items()) {
                if (value.is_primitive()) add(key, cellText(value));
                if (!value.is_object()) continue;
                for (const auto& [part, figure] : value.items()) {
                    if (figure.is_primitive()) add(key + "." + part, cellText(figure));
                }
            }
        }
    }
    std::string text = joined(columns, commaCell, ",") + "\n";
    for (const auto& row : rows) {
        const auto cell = [&](const std::string& column) {
            return row.contains(column) ? commaCell(row.at(column)) : "";
        };
        text += joined(columns, cell, ",") + "\n";
    }
    return text;
}

}  // namespace adaptiso
