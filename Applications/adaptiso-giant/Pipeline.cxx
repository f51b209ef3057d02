#include "Pipeline.h"

#include <fstream>
#include <sstream>

#include "Common/RunApp.h"
#include "Common/Sha256.h"
#include "Steps.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso::giant {
namespace fs = std::filesystem;

GiantPlan readPlan(const fs::path& work) {
    const fs::path file = GiantPlan::fileIn(work);
    std::ifstream stream(file, std::ios::binary);
    if (!stream) {
        throw FileError(file.string() + ": there is no plan; make one with: adaptiso-giant plan " +
                        work.string());
    }
    std::ostringstream text;
    text << stream.rdbuf();
    GiantPlan plan = decodePlan(text.str(), file.string());
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

}  // namespace adaptiso::giant
