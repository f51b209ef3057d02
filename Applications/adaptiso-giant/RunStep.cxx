#include <algorithm>
#include <fstream>

#include "Common/ChildProcess.h"
#include "Common/Progress.h"
#include "Common/RunApp.h"
#include "Steps.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso::giant {
namespace {

/// Pieces of one process: few, so that little is lost with it, and enough that starting it costs
/// nothing beside them.
constexpr std::size_t kGroup = 8;
constexpr int kMostTries = 3;

using Ids = std::vector<std::string>;

std::vector<Ids> grouped(const std::vector<Index3>& places, std::size_t workers) {
    const std::size_t size = std::clamp<std::size_t>(places.size() / (4 * workers), 1, kGroup);
    std::vector<Ids> groups;
    for (const Index3& place : places) {
        if (groups.empty() || groups.back().size() == size) groups.emplace_back();
        groups.back().push_back(idOf(place));
    }
    return groups;
}

/// The first line of a child's errors, without the program's name, which is printed again.
std::string firstLine(const std::string& errors) {
    const std::string name = std::string(kGiantProgram) + ": ";
    const std::size_t begin = errors.starts_with(name) ? name.size() : 0;
    return errors.substr(begin, errors.find('\n') - begin);
}

/// Runs a step's pieces by processes of this program. Those that were killed are tried again.
void runPieces(const GiantOptions& options, const std::string& step,
               const std::vector<Index3>& places, ProgressLine& progress) {
    std::vector<Ids> left = grouped(places, static_cast<std::size_t>(options.workers));
    const int threads =
        std::max(1, options.common.threads.value_or(options.workers) / options.workers);
    for (int attempt = 1; !left.empty(); ++attempt) {
        std::vector<Ids> killed;
        std::string error;
        std::size_t done = 0;
        runChildren(
            left.size(), options.workers,
            [&](std::size_t n) {
                std::vector<std::string> arguments{step, options.work.string()};
                arguments.insert(arguments.end(), left[n].begin(), left[n].end());
                arguments.insert(arguments.end(), {"--threads", std::to_string(threads), "-q"});
                return arguments;
            },
            [&](std::size_t n, ChildResult result) {
                progress.show(step, static_cast<double>(++done) / static_cast<double>(left.size()));
                if (result.signal != 0) {
                    killed.push_back(left[n]);
                    error = step + " " + left[n].front() + ": was killed, " +
                            std::to_string(kMostTries) +
                            " times; it may need more memory: take fewer --workers, or a smaller "
                            "--tile";
                } else if (result.exitCode != kExitOk) {
                    throw FileError(step + ": " + firstLine(result.errors));
                }
            });
        if (!killed.empty() && attempt == kMostTries) throw InvalidInput(error);
        left = std::move(killed);
    }
}

}  // namespace

int runAllSteps(const GiantOptions& options) {
    GiantOptions quiet = options;
    quiet.common.isQuiet = true;
    quiet.common.json.clear();
    const int planned = runPlanStep(quiet);
    if (planned != kExitOk) return planned;
    const GiantPlan plan = readPlan(options.work);
    {
        ProgressLine progress(options.common.isQuiet);
        runPieces(options, "tile", plan.tiles, progress);
        runPieces(options, "seam", plan.seams(), progress);
    }
    return runJoinStep(options, keyOf(plan));
}

}  // namespace adaptiso::giant
