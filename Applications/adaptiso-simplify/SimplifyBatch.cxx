#include "Common/Batch.h"
#include "Common/Bids.h"
#include "Run.h"

namespace adaptiso::simplifier {

namespace {

/// Surfaces of derivatives, without those that this program has made.
std::vector<BatchItem> findSurfaces(const std::filesystem::path& root,
                                    const std::vector<std::string>& participants,
                                    const std::filesystem::path& derivatives) {
    std::vector<BatchItem> items = findBidsSurfaces(root, participants, derivatives);
    std::erase_if(items, [](const BatchItem& item) {
        return item.inputs.front().filename().string().find("desc-simplified") != std::string::npos;
    });
    if (items.empty()) {
        throw InvalidInput(derivatives.string() + ": holds no surface that is to be simplified");
    }
    return items;
}

}  // namespace

int runSimplifyBatch(const SimplifyCommand& command) {
    const BatchProgram program{
        "adaptiso-simplify", {"--data"}, {"--output", "--report", "--pictures"}};
    std::vector<BatchItem> items =
        findBatchItems(command.batch, command.inputs, surfaceName, findSurfaces);
    for (BatchItem& item : items) {
        const std::filesystem::path& input = item.inputs.front();
        item.output = command.batch.bids.empty() ? input.filename().string() : bidsName(input);
    }
    return runBatch(program, std::move(items), command.batch, command.common);
}

}  // namespace adaptiso::simplifier
