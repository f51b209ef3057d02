#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace adaptiso {

/// How a run stands, the worst first.
enum class RunState {
    Failed,       ///< it did, or what it looked at did
    Changed,      ///< it was done, but what it made or looked at is gone or not the same any more
    NotFinished,  ///< it has begun, or its record can't be read
    NotRun,       ///< its input is there, and nothing else
    Unusual,      ///< done, and unlike what the others have come to
    Done,
};

/// One line of the page.
struct SummaryRow {
    std::string program;  ///< empty: none has run
    std::string name;
    std::string file;
    RunState state = RunState::NotRun;
    std::string says;  ///< the result, or the error
    std::string date;  ///< of the run's end; empty: none
    double seconds = 0;
    std::vector<std::filesystem::path> outputs;
    std::filesystem::path report;    ///< a page of --report; empty: none
    std::filesystem::path pictures;  ///< a folder of --pictures; empty: none
};

/// A page of HTML without scripts that lists `rows` in their order, the verdict in words and
/// colour, with links relative to `page`, and a thumbnail where there is a picture: one of the
/// row's pictures, or the first that its report holds.
std::string summaryPage(const std::vector<SummaryRow>& rows, const std::filesystem::path& page);

}  // namespace adaptiso
