#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace adaptiso {

/// Opens the file of --log, a new one or an earlier log. \throws FileError
void openLog(const std::filesystem::path& file);

/// The file of --log; empty: none.
std::filesystem::path logFile();

bool isLogOpen();

/// The present time, "2026-11-28T22:16:01Z".
std::string utcDate();

/// Adds a line with date and seconds since openLog() to the file of --log, if there is one.
void addToLog(std::string_view text);

}  // namespace adaptiso
