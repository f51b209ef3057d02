#include "DicomAgreement.h"

#include <fmt/core.h>

#include <algorithm>
#include <functional>
#include <map>

#include "FileFault.h"

namespace adaptiso::detail {
namespace fs = std::filesystem;

namespace {

constexpr const char* kRemedy = "get the series again, or give its slices of one kind";

/// How many slices say what.
using Votes = std::map<std::string, std::size_t>;

/// "HU (20 slices) and US (1 slice)"
std::string listOf(const Votes& votes) {
    std::string list;
    for (const auto& [value, count] : votes) {
        list += fmt::format("{}{} ({} slice{})", list.empty() ? "" : " and ", printable(value),
                            count, count > 1 ? "s" : "");
    }
    return list;
}

/// \param say  what a plane's header says, empty where it says nothing
Votes count(const std::vector<DicomPlane>& planes,
            const std::function<std::string_view(const DicomPlane&)>& say) {
    Votes votes;
    for (const DicomPlane& plane : planes) {
        const std::string_view value = say(plane);
        if (!value.empty()) ++votes[std::string(value)];
    }
    return votes;
}

bool isRescaled(const DicomPlane& plane) {
    return plane.slope != 1 || plane.intercept != 0;
}

}  // namespace

void requireAgreement(const fs::path& input, const std::vector<DicomFile>& files,
                      const std::vector<DicomPlane>& planes, std::vector<Warning>& warnings) {
    const auto votesOf = [&](DicomTag tag) {
        return count(planes, [&](const DicomPlane& plane) {
            return files[plane.file].header.dataset.text(tag).value_or("");
        });
    };
    const Votes photometric = votesOf(tag::kPhotometric);
    if (photometric.size() > 1) {
        refuse(input,
               fmt::format("mixes slices that store dark as low and as high values: {}",
                           listOf(photometric)),
               kRemedy);
    }
    const Votes types = count(
        planes, [](const DicomPlane& plane) -> std::string_view { return plane.rescaleType; });
    if (types.size() > 1) {
        refuse(input, fmt::format("its slices are rescaled to several units: {}", listOf(types)),
               kRemedy);
    }
    const Votes units = votesOf(tag::kUnits);
    if (units.size() > 1) {
        refuse(input, fmt::format("its slices are of several units: {}", listOf(units)), kRemedy);
    }
    const auto silent = std::ranges::count(planes, false, &DicomPlane::hasRescale);
    if (silent > 0 && std::ranges::any_of(planes, isRescaled)) {
        refuse(
            input,
            fmt::format("{} of its {} slices have no RescaleSlope and RescaleIntercept, the others "
                        "are rescaled by theirs",
                        silent, planes.size()),
            kRemedy);
    }
    const Votes signs = votesOf(tag::kPixelRepresentation);
    if (signs.size() > 1) {
        warnings.push_back({"mixed-signedness",
                            "some slices hold signed samples and some unsigned ones; each was read "
                            "as its own header says"});
    }
}

}  // namespace adaptiso::detail
