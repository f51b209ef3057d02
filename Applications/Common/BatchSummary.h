#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace adaptiso {

/// One line of the page.
struct SummaryRow {
    std::string name;
    std::string file;
    bool hasPassed = false;
    bool isOfEarlierRun = false;
    std::string says;  ///< what came of it, or what is wrong
    double seconds = 0;
    std::vector<std::filesystem::path> outputs;
    std::filesystem::path report;    ///< a page of --report; empty: none
    std::filesystem::path pictures;  ///< a folder of --pictures; empty: none
};

/// A page of HTML without scripts that lists `rows` in their order, the verdict in words and
/// colour, with links relative to `page`, and a thumbnail where there is a picture: one of the
/// row's pictures, or the first that its report holds.
std::string summaryPage(const std::string& program, const std::vector<SummaryRow>& rows,
                        const std::filesystem::path& page);

}  // namespace adaptiso
