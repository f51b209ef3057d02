#include "Pipeline.h"

#include <algorithm>
#include <optional>

#include "Common/ChildProcess.h"
#include "Common/Progress.h"
#include "Common/RunApp.h"
#include "Common/Sha256.h"
#include "Steps.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/FoundFiles.h"

namespace adaptiso::giant {
namespace fs = std::filesystem;
namespace {

/// Pieces of one process: few, so that little is lost with it, and enough that starting it costs
/// nothing beside them.
constexpr std::size_t kGroup = 8;

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

/// Runs a step's pieces by processes of this program. \throws InvalidInput  one was killed
void runPieces(const GiantOptions& options, const std::string& step,
               const std::vector<Index3>& places, ProgressLine& progress) {
    const std::vector<Ids> groups = grouped(places, static_cast<std::size_t>(options.workers));
    const int threads =
        std::max(1, options.common.threads.value_or(options.workers) / options.workers);
    std::string killed;
    std::size_t done = 0;
    runChildren(
        groups.size(), options.workers,
        [&](std::size_t n) {
            std::vector<std::string> arguments{step, options.work.string()};
            arguments.insert(arguments.end(), groups[n].begin(), groups[n].end());
            arguments.insert(arguments.end(), {"--threads", std::to_string(threads), "-q"});
            return arguments;
        },
        [&](std::size_t n, ChildResult result) {
            progress.show(step, static_cast<double>(++done) / static_cast<double>(groups.size()));
            if (result.signal != 0) {
                if (killed.empty()) killed = groups[n].front();
            } else if (result.exitCode != kExitOk) {
                throw FileError(step + ": " + firstLine(result.errors));
            }
        });
    if (killed.empty()) return;
    throw InvalidInput(step + " " + killed + ": was killed; run it again, which goes on where it " +
                       "was, with fewer --workers or a smaller --tile if memory is short");
}

}  // namespace

std::vector<Index3> tilesAt(const GiantPlan& plan, const Index3& seam) {
    const IndexBox at = plan.cut().tilesOfSeam(seam);
    std::vector<Index3> tiles;
    for (std::int64_t z = at.first[2]; z < at.end[2]; ++z) {
        for (std::int64_t y = at.first[1]; y < at.end[1]; ++y) {
            const Index3 first{at.first[0], y, z}, end{at.end[0], y, z};
            auto tile = std::ranges::lower_bound(plan.tiles, orderOf(first), {}, orderOf);
            for (; tile != plan.tiles.end() && orderOf(*tile) < orderOf(end); ++tile) {
                tiles.push_back(*tile);
            }
        }
    }
    return tiles;
}

SeamInputs::SeamInputs(const std::filesystem::path& work, const GiantPlan& plan)
    : work_(work), plan_(plan), key_(keyOf(plan)) {}

std::optional<std::string> SeamInputs::ofTile(const Index3& tile) {
    const auto known = known_.find(orderOf(tile));
    if (known != known_.end()) return known->second;
    std::optional<PieceSummary> found = findPiece(work_, "tile", tile, key_);
    if (!found) return std::nullopt;
    known_.erase(known_.begin(), known_.lower_bound({tile[2] - 1, 0, 0}));  // layers gone by
    return known_[orderOf(tile)] = std::move(found->inputs);
}

std::string SeamInputs::of(const Index3& seam) {
    std::string text;
    for (const Index3& tile : tilesAt(plan_, seam)) {
        const std::optional<std::string> inputs = ofTile(tile);
        if (!inputs) {
            throw FileError(pieceFile(work_, "tile", tile).string() +
                            ": is not there, or of another plan; run: adaptiso-giant tile " +
                            work_.string() + " " + idOf(tile));
        }
        text += idOf(tile) + " " + *inputs + "\n";
    }
    return sha256Of(text);
}

bool SeamInputs::areChanged(const Index3& seam, const std::string& inputs) {
    const std::vector<Index3> tiles = tilesAt(plan_, seam);
    const bool areThere =
        std::ranges::all_of(tiles, [&](const Index3& tile) { return ofTile(tile).has_value(); });
    return areThere && of(seam) != inputs;
}

GiantPlan readPlan(const fs::path& work) {
    const fs::path file = GiantPlan::fileIn(work);
    for (const char* folder : {"tiles", "seams"}) requireNoLink(work / folder, work);
    const std::optional<std::string> text = readFoundFile(file, work);
    if (!text) {
        throw FileError(file.string() + ": there is no plan; make one with: adaptiso-giant plan " +
                        work.string());
    }
    GiantPlan plan = decodePlan(*text, file.string());
    if (plan.version != programVersion()) {
        throw FileError(file.string() + ": was made by adaptiso-giant " + plan.version +
                        ", this is " + programVersion() + "; make it again (plan)");
    }
    return plan;
}

std::string keyOf(const GiantPlan& plan) {
    return sha256Of(plan.identity());
}

fs::path pieceFile(const fs::path& work, const std::string& stage, const Index3& place) {
    return work / (stage + "s") / (idOf(place) + ".tile");
}

std::optional<PieceSummary> findPiece(const fs::path& work, const std::string& stage,
                                      const Index3& place, const std::string& key) {
    const fs::path file = pieceFile(work, stage, place);
    std::error_code error;
    if (!fs::exists(file, error)) return std::nullopt;
    try {
        PieceSummary summary = readPieceSummary(file);
        const bool isIt =
            summary.plan == key && summary.stage == stage && summary.id == idOf(place);
        if (isIt) return summary;
    } catch (const FileError&) {  // it is made again
    }
    return std::nullopt;
}

int runGiant(const GiantOptions& options) {
    switch (options.step) {
        case GiantStep::Plan:
            return runPlanStep(options);
        case GiantStep::Tile:
            return runTileStep(options);
        case GiantStep::Seam:
            return runSeamStep(options);
        case GiantStep::Join:
            return runJoinStep(options);
        case GiantStep::Run:
            return runAllSteps(options);
    }
    throw InternalError("runGiant: unknown step");
}

int runAllSteps(const GiantOptions& options) {
    const bool isNew = !std::filesystem::exists(options.work);
    makeFolders(options.work);  // outputs may lie there
    try {
        checkJoinOutputs(options, options.input);
    } catch (...) {
        std::error_code error;
        if (isNew) std::filesystem::remove(options.work, error);
        throw;
    }
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
