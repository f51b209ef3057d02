#include "Common/Progress.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <ostream>
#include <utility>

#include "Common/Log.h"
#include "Common/RunApp.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso {
namespace {

std::function<void(const std::string&)> progressObserver;

const StageTimer kSinceStart;

/// Lines for a file or a pipe, few: a short run has none.
void printLine(const std::string& text) {
    constexpr double kBetweenSeconds = 60;
    static double next = kBetweenSeconds;
    if (kSinceStart.total() < next) return;
    next = kSinceStart.total() + kBetweenSeconds;
    std::cerr << oneLine(text) << std::endl;
}

/// A new stage goes into the file of --log.
void logStage(std::string_view stage) {
    static std::string last;
    if (stage != last) addToLog(last = stage);
}

void show(const std::string& text) {
    if (progressObserver) return progressObserver(text);
    if (isatty(STDERR_FILENO) != 1) return text.empty() ? void() : printLine(text);
    // past std::cerr, which passes no such sequence on
    std::fputs(("\r\033[K" + withoutControls(text)).c_str(), stderr);
    std::fflush(stderr);
}

}  // namespace

void observeProgress(std::function<void(const std::string&)> observer) {
    progressObserver = std::move(observer);
}

ProgressLine::ProgressLine(bool isQuiet) : isShown_(!isQuiet) {}

void ProgressLine::show(std::string_view stage) {
    logStage(stage);
    write(std::string(stage) + " ...");
}

void ProgressLine::show(std::string_view stage, double fraction) {
    logStage(stage);
    const double percent = std::floor(100 * std::clamp(fraction, 0.0, 1.0));
    write(std::string(stage) + " " + std::to_string(static_cast<int>(percent)) + " %");
}

void ProgressLine::write(std::string text) {
    if (!isShown_) return;
    if (!progressObserver)
        text += ", " + std::to_string(static_cast<int>(kSinceStart.total())) + " s";
    if (text == written_) return;
    adaptiso::show(text);
    written_ = std::move(text);
}

void ProgressLine::clear() {
    if (written_.empty()) return;
    adaptiso::show("");
    written_.clear();
}

ProgressCallback ProgressLine::callback() {
    if (!isShown_ && !isLogOpen()) return {};
    return [this](std::string_view stage, double fraction) { show(stage, fraction); };
}

void printTimes(std::ostream& out, const StageTimer& timer, int decimals) {
    out << formatFixed(timer.total(), decimals) << " s (";
    std::string_view separator;
    for (const auto& [stage, seconds] : timer.stages()) {
        out << separator << stage << ' ' << formatFixed(seconds, decimals);
        separator = ", ";
    }
    out << "), peak memory " << formatRounded(peakMemoryMb()) << " MB\n";
}

}  // namespace adaptiso
