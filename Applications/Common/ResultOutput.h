#pragma once

#include <filesystem>
#include <functional>
#include <ostream>
#include <string>

#include "Common/CommonOptions.h"

namespace adaptiso {

/// Makes sure that what was printed on stdout has arrived, on its disk too if it is a file.
/// \throws FileError  it has not: no room, or closed
void flushResults();

/// Prints a run's results on stdout (as text by `printText`, as `json` with --json -, not at all
/// with --quiet). To be called when all files are whole under their temporary names and before
/// they get their own: when it throws, or a closed pipe ends the program, there are none.
/// \throws FileError  as flushResults()
void printResults(const CommonOptions& common, const std::string& json,
                  const std::function<void(std::ostream&)>& printText);

/// For programs whose only output is a report.
/// \throws FileError when the file of --json would overwrite `input` or can't be written
void checkReportFile(const CommonOptions& common, const std::filesystem::path& input);

/// printResults(), and writes `json` to the file of --json: both or neither.
/// \throws FileError as checkReportFile() and flushResults()
void deliverReport(const CommonOptions& common, const std::filesystem::path& input,
                   const std::string& json, const std::function<void(std::ostream&)>& printText);

}  // namespace adaptiso
