#pragma once

#include <filesystem>
#include <string>

#include "GiantPlan.h"
#include "PieceFile.h"
#include "Pipeline.h"

namespace adaptiso {

/// What all steps print on stderr before their messages.
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

/// \throws UsageError, InvalidInput, FileError, InternalError, each
int runPlanStep(const GiantOptions& options);
int runTileStep(const GiantOptions& options);
int runSeamStep(const GiantOptions& options);
int runJoinStep(const GiantOptions& options);
int runAllSteps(const GiantOptions& options);

}  // namespace adaptiso
