#include "Common/Warnings.h"

#include <algorithm>
#include <iterator>
#include <vector>

#include "Common/RunApp.h"
#include "Common/UsageWords.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso {
namespace {

std::vector<Warning>& printed() {
    static std::vector<Warning> all;
    return all;
}

/// The warnings that --strict does not let pass.
std::vector<Warning> failing(const CommonOptions& common, std::span<const Warning> warnings) {
    std::vector<Warning> bad;
    if (!common.isStrict) return bad;
    std::copy_if(warnings.begin(), warnings.end(), std::back_inserter(bad),
                 [&](const Warning& warning) {
                     return !isNote(warning) &&
                            std::ranges::find(common.allowed, warning.code) == common.allowed.end();
                 });
    return bad;
}

}  // namespace

void printWarnings(const std::string& program, const CommonOptions& common,
                   std::span<const Warning> warnings) {
    printed().insert(printed().end(), warnings.begin(), warnings.end());
    if (common.hidesWarnings) return;
    for (const Warning& warning : warnings) {
        printError(program, (isNote(warning) ? "note: " : "warning: ") + warning.line());
    }
}

Warning countMissed(const std::string& file, const std::string& what, std::int64_t written,
                    std::int64_t wanted, const std::string& kept, double errorBoundMm) {
    return {"count-missed",
            "has " + formatCount(written) + " " + what + ", not " + formatCount(wanted) +
                " as asked for: keeping " + kept + " left little to gain; they lie up to " +
                formatBound(errorBoundMm) + " mm off, and more triangles lie closer",
            file};
}

std::span<const Warning> printedWarnings() {
    return printed();
}

std::string warningCode(const std::string& option, const std::string& text) {
    std::vector<std::string> codes;
    for (const WarningCode& known : warningCodes()) codes.emplace_back(known.code);
    if (std::ranges::find(codes, text) != codes.end()) return text;
    throw UsageError(option + " " + shown(text) + ": is no warning's code" +
                     suggestion(text, codes) + "; Documentation/Warnings.md lists all");
}

bool failsStrict(const CommonOptions& common, std::span<const Warning> warnings) {
    return !failing(common, warnings).empty();
}

std::string strictFailure(const CommonOptions& common, std::span<const Warning> warnings,
                          const std::string& consequence) {
    const std::vector<Warning> bad = failing(common, warnings);
    std::string text = "--strict: " + std::to_string(bad.size()) +
                       (bad.size() == 1 ? " warning" : " warnings") +
                       (consequence.empty() ? "" : ", " + consequence);
    for (std::size_t n = 0; n < bad.size(); ++n) text += (n == 0 ? ": " : "; ") + bad[n].line();
    return text;
}

}  // namespace adaptiso
