#include "adaptiso/HeadPipeline/BemModel.h"

#include <array>

#include "adaptiso/Core/Text.h"

namespace adaptiso {

const char* toString(BemSource source) {
    constexpr std::array<const char*, 5> kNames{"t1", "labels", "probabilities", "ct", "surfaces"};
    return kNames[static_cast<std::size_t>(source)];
}

std::string rasText(const Vec3& lps) {
    return "(" + formatFixed(-lps.x, 1) + ", " + formatFixed(-lps.y, 1) + ", " +
           formatFixed(lps.z, 1) + ") mm RAS";
}

std::string BemModel::failureText() const {
    std::string text = findings.front().what + " at " + rasText(findings.front().pointMm);
    if (findings.size() > 1) {
        text += " (and " + formatCount(std::ssize(findings) - 1) + " more)";
    }
    return text;
}

std::vector<double> BemModelOptions::minGapsMm() const {
    std::vector<double> gaps;
    for (std::size_t n = 0; n + 1 < surfaceCount(); ++n) {
        gaps.push_back(boundaries.minGapMm(surface(n)));
    }
    return gaps;
}

std::string bemSurfaceName(std::size_t surface, std::size_t count) {
    return std::string(toString(headSurface(surface, count)));
}

}  // namespace adaptiso
