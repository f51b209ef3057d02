#include "Common/Log.h"

#include <chrono>
#include <ctime>
#include <fstream>
#include <string>

#include "Common/RunApp.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Files/AtomicOutput.h"
#include "adaptiso/Files/StageTimer.h"

namespace adaptiso {
namespace {

struct OpenLog {
    std::ofstream file;
    StageTimer sinceOpened;
};

OpenLog& openedLog() {
    static OpenLog log;
    return log;
}

/// "2026-11-28T22:16:01Z"
std::string logDate() {
    const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
    std::tm parts{};
    gmtime_r(&now, &parts);
    char text[sizeof "0000-00-00T00:00:00Z"];
    std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
    return text;
}

/// Anything but an empty file or a log is someone's data.
bool mayBeLog(const std::filesystem::path& file) {
    std::error_code error;
    if (!std::filesystem::exists(file, error)) return true;
    if (!std::filesystem::is_regular_file(file, error)) return false;
    std::string date;
    std::ifstream(file) >> date;
    return date.empty() ||
           (date.size() == logDate().size() && date[10] == 'T' && date.back() == 'Z');
}

}  // namespace

void openLog(const std::filesystem::path& file) {
    if (!mayBeLog(file)) {
        throw FileError("--log " + file.string() + ": exists and is no log; name a new file");
    }
    openedLog().file.open(file, std::ios::app);
    if (!openedLog().file) {
        throw FileError("--log " + file.string() + ": can't be written: " + detail::reason());
    }
}

bool isLogOpen() {
    return openedLog().file.is_open();
}

void addToLog(std::string_view text) {
    if (!isLogOpen()) return;
    openedLog().file << logDate() << ' ' << formatFixed(openedLog().sinceOpened.total(), 1)
                     << " s  " << oneLine(text) << std::endl;
}

}  // namespace adaptiso
