#include "Common/ResultOutput.h"

#include <iostream>
#include <vector>

#include "Common/AtomicOutput.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso {

void checkReportFile(const CommonOptions& common, const std::filesystem::path& input) {
    if (!common.wantsJson() || common.wantsJsonOnStdout()) return;
    checkNotInput(common.json, input);
    checkOutput(common.json);
}

void deliverReport(const CommonOptions& common, const std::filesystem::path& input,
                   const std::string& json, const std::function<void(std::ostream&)>& printText) {
    if (common.wantsJsonOnStdout()) {
        std::cout << json;
    } else if (!common.isQuiet) {
        printText(std::cout);
    }
    if (common.wantsJson() && !common.wantsJsonOnStdout()) {
        checkReportFile(common, input);
        std::vector<AtomicOutput> outputs;
        outputs.emplace_back(common.json).writeText(json);
        AtomicOutput::commit(outputs);
    }
    if (!std::cout.flush()) throw FileError("standard output: can't be written");
}

}  // namespace adaptiso
