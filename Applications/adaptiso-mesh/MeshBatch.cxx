#include "Common/Batch.h"
#include "Common/Bids.h"
#include "Common/Naming.h"
#include "Run.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso::mesher {

int runMeshBatch(const MeshOptions& options) {
    BatchProgram program{"adaptiso-mesh", {}, {"--output", "--report", "--pictures"}, "--iso"};
    program.surfaceFiles = [&options](const std::filesystem::path& output, const auto&) {
        MeshOptions named;
        named.output = output;
        named.isovalues = options.isovalues;
        std::vector<std::filesystem::path> files;
        for (const IsovalueChoice& choice : options.isovalues) {
            files.push_back(
                outputPath(named, choice.isAutomatic() ? "auto" : formatNumber(*choice.value)));
        }
        return files;
    };
    std::vector<BatchItem> items =
        findBatchItems(options.batch, options.inputs, inputStem, findBidsScans);
    for (BatchItem& item : items) {
        item.output = options.batch.bids.empty() ? "{name}-iso{iso}.vtp"
                                                 : "{name}_desc-iso{isolabel}_mesh.vtp";
    }
    return runBatch(program, std::move(items), options.batch, options.common);
}

}  // namespace adaptiso::mesher
