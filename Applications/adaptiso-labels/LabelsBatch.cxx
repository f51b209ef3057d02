#include "Common/Batch.h"
#include "Common/Bids.h"
#include "Common/Naming.h"
#include "Run.h"

namespace adaptiso::labels {

int runLabelsBatch(const LabelsOptions& options) {
    const BatchProgram program{
        "adaptiso-labels", {"--names", "--volume"}, {"--output", "--report", "--pictures"}};
    std::vector<BatchItem> items =
        findBatchItems(options.batch, options.inputs, inputStem, findBidsSegmentations);
    for (BatchItem& item : items) {
        item.output = options.batch.bids.empty() ? "{name}-labels" : "{name}_mesh";
    }
    return runBatch(program, std::move(items), options.batch, options.common);
}

}  // namespace adaptiso::labels
