#pragma once

#include <functional>
#include <iosfwd>
#include <string>
#include <string_view>

#include "adaptiso/Core/Progress.h"
#include "adaptiso/Files/StageTimer.h"

namespace adaptiso {

/// Takes what ProgressLine shows ("extract 42 %"; empty when it is wiped) in the place of a
/// terminal: for a program that runs inside a page.
void observeProgress(std::function<void(const std::string&)> observer);

/// One line on a terminal's stderr that says what is going on ("extract 42 %, 3 s", the time since
/// the program began), wiped at the end; in a file or a pipe a line each minute. Nothing with
/// --quiet.
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
    void write(std::string text);

    bool isShown_;
    std::string written_;
};

/// The last line of a program's report: "1.23 s (read 0.50, extract 0.73), peak memory 100 MB".
void printTimes(std::ostream& out, const StageTimer& timer, int decimals = 2);

}  // namespace adaptiso
