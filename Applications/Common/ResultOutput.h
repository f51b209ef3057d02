#pragma once

#include <filesystem>
#include <functional>
#include <ostream>
#include <string>

#include "Common/CommonOptions.h"

namespace adaptiso {

/// For programs whose only output is a report.
/// \throws FileError when the file of --json would overwrite `input` or can't be written
void checkReportFile(const CommonOptions& common, const std::filesystem::path& input);

/// Prints the report on stdout (as text by `printText`, as `json` with --json -, not at all with
/// --quiet), and writes `json` to the file of --json.
/// \throws FileError as checkReportFile(), or stdout is full or closed
void deliverReport(const CommonOptions& common, const std::filesystem::path& input,
                   const std::string& json, const std::function<void(std::ostream&)>& printText);

}  // namespace adaptiso
