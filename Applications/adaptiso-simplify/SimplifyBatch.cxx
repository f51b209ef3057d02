#include "Common/Batch.h"
#include "Common/Bids.h"
#include "Run.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso::simplifier {
namespace {

std::string says(const Json& report) {
    if (!report.contains("output")) return {};
    if (report.value("failedBySoundness", false)) return "is not sound";
    return formatCount(report.at("output").at("triangles").get<long long>()) + " triangles of " +
           formatCount(report.at("input").at("triangles").get<long long>());
}

std::vector<std::string> outputs(const Json& report) {
    std::vector<std::string> files;
    const Json output = report.value("output", Json::object());
    if (!output.is_object() || !output.value("written", false)) return files;
    files.push_back(output.at("file"));
    for (const Json& data : report.at("data")) files.push_back(data.at("output"));
    return files;
}

/// Files that this program made are not simplified again.
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
    BatchProgram program;
    program.name = "adaptiso-simplify";
    program.inputs = command.inputs;
    program.inputOptions = {"--data"};
    program.outputOptions = {"--output", "--report", "--pictures"};
    const bool isBids = !command.batch.bids.empty();
    program.defaultOutputOf = [isBids](const BatchItem& item) {
        const std::filesystem::path& input = item.inputs.front();
        return isBids ? bidsName(input) : input.filename().string();
    };
    program.nameOf = surfaceName;
    program.findInBids = findSurfaces;
    program.says = says;
    program.outputs = outputs;
    return runBatch(program, command.batch, command.common);
}

}  // namespace adaptiso::simplifier
