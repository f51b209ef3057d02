#include "Common/Progress.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <iostream>

namespace adaptiso {

ProgressLine::ProgressLine(bool isQuiet) : isShown_(!isQuiet && isatty(STDERR_FILENO) == 1) {}

void ProgressLine::show(std::string_view stage) {
    write(std::string(stage) + " ...");
}

void ProgressLine::show(std::string_view stage, double fraction) {
    const double percent = std::floor(100 * std::clamp(fraction, 0.0, 1.0));
    write(std::string(stage) + " " + std::to_string(static_cast<int>(percent)) + " %");
}

void ProgressLine::write(const std::string& text) {
    if (!isShown_ || text == written_) return;
    std::cerr << "\r\033[K" << text << std::flush;
    written_ = text;
}

void ProgressLine::clear() {
    if (written_.empty()) return;
    std::cerr << "\r\033[K" << std::flush;
    written_.clear();
}

ProgressCallback ProgressLine::callback() {
    if (!isShown_) return {};
    return [this](std::string_view stage, double fraction) { show(stage, fraction); };
}

}  // namespace adaptiso
