#include "Common/Warnings.h"

#include "Common/ExitCodes.h"
#include "Common/RunApp.h"

namespace adaptiso {

void printWarnings(const std::string& program, const CommonOptions& common,
                   std::span<const std::string> warnings) {
    if (common.hidesWarnings) return;
    for (const std::string& warning : warnings) printError(program, "warning: " + warning);
}

bool failsStrict(const CommonOptions& common, std::span<const std::string> warnings) {
    return common.isStrict && !warnings.empty();
}

std::string strictFailure(std::span<const std::string> warnings, const std::string& consequence) {
    std::string text = "--strict: " + std::to_string(warnings.size()) +
                       (warnings.size() == 1 ? " warning" : " warnings") +
                       (consequence.empty() ? "" : ", " + consequence);
    for (std::size_t n = 0; n < warnings.size(); ++n) text += (n == 0 ? ": " : "; ") + warnings[n];
    return text;
}

int strictVerdict(const std::string& program, const CommonOptions& common,
                  std::span<const std::string> warnings, const std::string& consequence,
                  int exitCode) {
    if (!failsStrict(common, warnings)) return exitCode;
    printError(program, strictFailure(warnings, consequence));
    return kExitCheckFailed;
}

}  // namespace adaptiso
