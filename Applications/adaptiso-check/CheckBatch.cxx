#include "Common/Batch.h"
#include "Common/Bids.h"
#include "Run.h"

namespace adaptiso::checker {
namespace {

/// The checks that a surface, or a pair of them, failed.
std::string failedOf(const Json& checked, const std::string& subject) {
    std::string text;
    for (const Json& name : checked.value("failed", Json::array())) {
        text += (text.empty() ? "" : ", ") + name.get<std::string>();
    }
    return text.empty() || subject.empty() ? text : subject + ": " + text;
}

std::string says(const Json& report) {
    const Json surfaces = report.value("surfaces", Json::array());
    std::vector<std::string> faults;
    for (const Json& surface : surfaces) {
        const bool isAlone = surfaces.size() == 1;
        faults.push_back(failedOf(surface, isAlone ? "" : surface.at("file").get<std::string>()));
    }
    if (report.contains("nesting") && report.at("nesting").is_object()) {
        for (const Json& pair : report.at("nesting").at("pairs")) {
            faults.push_back(failedOf(pair, pair.at("inner").get<std::string>() + " in " +
                                                pair.at("outer").get<std::string>()));
        }
    }
    std::string text;
    for (const std::string& fault : faults) {
        if (!fault.empty()) text += (text.empty() ? "" : "; ") + fault;
    }
    return text.empty() ? "all that is required holds" : text;
}

}  // namespace

int runCheckBatch(const CheckOptions& options) {
    BatchProgram program;
    program.name = "adaptiso-check";
    program.inputs = options.files;
    program.isOneItem = options.isNested;
    program.keepsRecords = false;
    program.inputOptions = {"--volume"};
    program.outputOptions = {"--report", "--pictures"};
    program.nameOf = [](const std::filesystem::path& file) { return file.filename().string(); };
    program.findInBids = findBidsSurfaces;
    program.says = says;
    program.outputs = [](const Json&) { return std::vector<std::string>{}; };
    return runBatch(program, options.batch, options.common);
}

}  // namespace adaptiso::checker
