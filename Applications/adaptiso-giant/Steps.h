#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "Common/Json.h"
#include "GiantPlan.h"
#include "PieceFile.h"
#include "Pipeline.h"

namespace adaptiso::giant {

/// The name before all messages on stderr.
inline constexpr const char* kGiantProgram = "adaptiso-giant";

GiantPlan readPlan(const std::filesystem::path& work);
/// SHA-256 of GiantPlan::identity(): pieces of another plan are not taken.
std::string keyOf(const GiantPlan& plan);

/// The file that a step leaves: tiles/3_0_12.tile, seams/3_0_12.tile.
std::filesystem::path pieceFile(const std::filesystem::path& work, const std::string& stage,
                                const Index3& place);

/// The summary of a piece of this plan, or none where there is no such file, or one that is
/// damaged or of another plan.
std::optional<PieceSummary> findPiece(const std::filesystem::path& work, const std::string& stage,
                                      const Index3& place, const std::string& key);

/// The tiles of the plan that a seam box lies in.
std::vector<Index3> tilesAt(const GiantPlan& plan, const Index3& seam);

/// The inputs of seam boxes: those of their tiles. It remembers two layers of tiles, so ask
/// in the plan's order.
class SeamInputs {
public:
    SeamInputs(const std::filesystem::path& work, const GiantPlan& plan);

    /// SHA-256 of the tiles' names and inputs. \throws FileError  one is missing
    std::string of(const Index3& seam);
    /// Whether they differ from `inputs`; false if a tile is gone.
    bool areChanged(const Index3& seam, const std::string& inputs);

private:
    std::optional<std::string> ofTile(const Index3& tile);

    std::filesystem::path work_;
    const GiantPlan& plan_;
    std::string key_;
    std::map<std::array<std::int64_t, 3>, std::string> known_;  ///< by z, y, x
};

/// Refuses files to write that can't be, as before long work. \throws UsageError, FileError
void checkJoinOutputs(const GiantOptions& options, const std::filesystem::path& input);

/// \throws UsageError, InvalidInput, FileError, InternalError, each
int runPlanStep(const GiantOptions& options);
int runTileStep(const GiantOptions& options);
int runSeamStep(const GiantOptions& options);
/// \param key  of the plan that is to be joined; empty: that which is there
int runJoinStep(const GiantOptions& options, const std::string& key = {});
int runAllSteps(const GiantOptions& options);

}  // namespace adaptiso::giant
