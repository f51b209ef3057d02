#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "Common/Resources.h"
#include "Common/Verdict.h"
#include "Common/Warnings.h"
#include "Pipeline.h"
#include "adaptiso/HeadPipeline/BemModel.h"

namespace adaptiso {

/// One run of the program, for the reports.
struct BemRun {
    const BemOptions& options;
    BemModel model;
    std::vector<std::pair<std::string, std::uintmax_t>> files{};  ///< of the folder
    std::vector<std::filesystem::path> subjectFiles{};
    StageTimer timer{};
    std::optional<ReadVolume> shownImage{};  ///< for the report; none unless one is wanted
    Verdict verdict{};  ///< how the run ends, known before the reports are made

    /// --strict makes the warnings failures: of the model only the report is written.
    bool failsStrict() const { return adaptiso::failsStrict(options.common, model.warnings); }
};

}  // namespace adaptiso
