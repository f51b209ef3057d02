#include "Common/Warnings.h"

#include "Common/ExitCodes.h"
#include "Common/RunApp.h"
#include "adaptiso/Core/Numbers.h"

namespace adaptiso {

void printWarnings(const std::string& program, const CommonOptions& common,
                   std::span<const Warning> warnings) {
    if (common.hidesWarnings) return;
    for (const Warning& warning : warnings) printError(program, "warning: " + warning.line());
}

Warning countMissed(const std::string& file, const std::string& what, std::int64_t written,
                    std::int64_t wanted, const std::string& kept, double errorBoundMm) {
    return {"count-missed",
            "has " + formatCount(written) + " " + what + ", not " + formatCount(wanted) +
                " as asked for: these are the fewest reached with " + kept + ", and lie up to " +
                formatShort(errorBoundMm) + " mm off; more triangles lie closer",
            file};
}

bool failsStrict(const CommonOptions& common, std::span<const Warning> warnings) {
    return common.isStrict && !warnings.empty();
}

std::string strictFailure(std::span<const Warning> warnings, const std::string& consequence) {
    std::string text = "--strict: " + std::to_string(warnings.size()) +
                       (warnings.size() == 1 ? " warning" : " warnings") +
                       (consequence.empty() ? "" : ", " + consequence);
    for (std::size_t n = 0; n < warnings.size(); ++n)
        text += (n == 0 ? ": " : "; ") + warnings[n].line();
    return text;
}

int strictVerdict(const std::string& program, const CommonOptions& common,
                  std::span<const Warning> warnings, const std::string& consequence, int exitCode) {
    if (!failsStrict(common, warnings)) return exitCode;
    printError(program, strictFailure(warnings, consequence));
    return kExitCheckFailed;
}

}  // namespace adaptiso
