#include "Common/Log.h"

#include <array>
#include <ctime>
#include <fstream>
#include <iomanip>
#include <string>

#include "Common/RunApp.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Files/AtomicOutput.h"
#include "adaptiso/Files/StageTimer.h"

namespace adaptiso {
namespace {

struct OpenLog {
    std::filesystem::path name;
    std::ofstream file;
    StageTimer sinceOpened;
};

OpenLog& openedLog() {
    static OpenLog log;
    return log;
}

/// Anything but an empty file or a log is someone's data.
bool mayBeLog(const std::filesystem::path& file) {
    std::error_code error;
    if (!std::filesystem::exists(file, error)) return true;
    if (!std::filesystem::is_regular_file(file, error)) return false;
    std::string date;
    std::ifstream stream(file);
    if (!stream) return false;
    constexpr int kLongest = 64;
    stream >> std::setw(kLongest) >> date;
    return date.empty() ||
           (date.size() == utcDate().size() && date[10] == 'T' && date.back() == 'Z');
}

}  // namespace

std::string utcDate() {
    const std::time_t now = std::time(nullptr);
    std::tm utc{};
    gmtime_r(&now, &utc);
    std::array<char, 32> text{};
    const std::size_t length = std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &utc);
    return {text.data(), length};
}

void openLog(const std::filesystem::path& file) {
    if (!mayBeLog(file)) {
        throw FileError("--log " + file.string() + ": exists and is no log; name a new file");
    }
    openedLog().file.open(file, std::ios::app);
    openedLog().name = file;
    if (!openedLog().file) {
        throw FileError("--log " + file.string() + ": can't be written: " + detail::reason());
    }
}

std::filesystem::path logFile() {
    return openedLog().name;
}

bool isLogOpen() {
    return openedLog().file.is_open();
}

void addToLog(std::string_view text) {
    if (!isLogOpen()) return;
    openedLog().file << utcDate() << ' ' << formatFixed(openedLog().sinceOpened.total(), 1)
                     << " s  " << oneLine(text) << std::endl;
}

}  // namespace adaptiso
