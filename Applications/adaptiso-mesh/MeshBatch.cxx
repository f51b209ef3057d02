#include "Common/Batch.h"
#include "Common/Bids.h"
#include "Common/Naming.h"
#include "Run.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso::mesher {
namespace {

std::string says(const Json& report) {
    std::string text;
    for (const Json& surface : report.value("surfaces", Json::array())) {
        if (!text.empty()) text += "; ";
        text += surface.at("output").at("file").get<std::string>() + ", " +
                formatCount(surface.at("triangles").get<long long>()) + " triangles at " +
                formatShort(surface.at("isovalue").get<double>());
    }
    return text;
}

std::vector<std::string> outputs(const Json& report) {
    std::vector<std::string> files;
    for (const Json& surface : report.value("surfaces", Json::array())) {
        const Json& output = surface.at("output");
        if (output.value("written", true)) files.push_back(output.at("file"));
    }
    return files;
}

}  // namespace

int runMeshBatch(const MeshOptions& options) {
    BatchProgram program;
    program.name = "adaptiso-mesh";
    program.inputs = options.inputs;
    program.outputOptions = {"--output", "--report", "--pictures"};
    program.surfaceOption = "--iso";
    program.surfaceFiles = [&options](const std::filesystem::path& output,
                                      const std::vector<std::string>&) {
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
    program.defaultOutput = "{name}-iso{iso}.vtp";
    program.defaultBidsOutput = "{name}_desc-iso{isolabel}_mesh.vtp";
    program.nameOf = inputStem;
    program.findInBids = findBidsScans;
    program.says = says;
    program.outputs = outputs;
    return runBatch(program, options.batch, options.common);
}

}  // namespace adaptiso::mesher
