#include "Common/Batch.h"
#include "Common/Bids.h"
#include "Run.h"

namespace adaptiso::checker {

int runCheckBatch(const CheckOptions& options) {
    BatchProgram program{"adaptiso-check", {"--volume"}, {"--report", "--pictures"}};
    program.keepsRecords = false;
    const auto nameOf = [](const std::filesystem::path& file) { return file.filename().string(); };
    return runBatch(
        program,
        findBatchItems(options.batch, options.files, nameOf, findBidsSurfaces, options.isNested),
        options.batch, options.common);
}

}  // namespace adaptiso::checker
