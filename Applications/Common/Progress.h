#pragma once

#include <string>
#include <string_view>

#include "adaptiso/Core/Progress.h"

namespace adaptiso {

/// One line on a terminal's stderr that says what is going on ("extract  42 %"), and nothing at
/// all when stderr is a file or a pipe, or when told to be quiet. The line is wiped at the end.
class ProgressLine {
public:
    explicit ProgressLine(bool isQuiet);
    ~ProgressLine() { clear(); }
    ProgressLine(const ProgressLine&) = delete;
    ProgressLine& operator=(const ProgressLine&) = delete;

    /// `stage` runs, for an unknown time.
    void show(std::string_view stage);
    /// `stage` has done `fraction` (0 to 1) of its work.
    void show(std::string_view stage, double fraction);
    /// Wipes the line, before other text is written.
    void clear();

    /// To be handed to a library call; this object must outlive it. Empty when nothing is shown.
    ProgressCallback callback();

private:
    void write(const std::string& text);

    bool isShown_;
    std::string written_;
};

}  // namespace adaptiso
