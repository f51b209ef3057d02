#include "Common/Batch.h"
#include "Common/Bids.h"
#include "Common/Naming.h"
#include "Run.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso::labels {
namespace {

std::string says(const Json& report) {
    if (!report.contains("walls")) return {};
    for (const Json& check : report.value("checks", Json::array())) {
        if (!check.value("passed", true)) return "failed: " + check.at("name").get<std::string>();
    }
    return formatCount(static_cast<long long>(report.at("regions").size())) + " regions, " +
           formatCount(report.at("walls").at("triangles").get<long long>()) + " triangles";
}

/// The files of the whole map, without those of single regions.
std::vector<std::string> outputs(const Json& report) {
    std::vector<std::string> files;
    const Json output = report.value("output", Json::object());
    if (!output.value("written", false)) return files;
    for (const Json& file : output.at("files")) {
        const std::string name = file.at("file");
        if (name.find('/') != std::string::npos) continue;
        files.push_back(output.at("folder").get<std::string>() + "/" + name);
    }
    return files;
}

}  // namespace

int runLabelsBatch(const LabelsOptions& options) {
    BatchProgram program;
    program.name = "adaptiso-labels";
    program.inputs = options.inputs;
    program.outputOptions = {"--output", "--report", "--pictures"};
    program.inputOptions = {"--names", "--volume"};
    program.defaultOutput = "{name}-labels";
    program.defaultBidsOutput = "{name}_mesh";
    program.nameOf = inputStem;
    program.findInBids = findBidsSegmentations;
    program.says = says;
    program.outputs = outputs;
    return runBatch(program, options.batch, options.common);
}

}  // namespace adaptiso::labels
