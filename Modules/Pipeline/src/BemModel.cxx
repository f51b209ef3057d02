#include "adaptiso/Pipeline/BemModel.h"

#include "adaptiso/Core/Numbers.h"

namespace adaptiso {
namespace {

std::string rasText(const Vec3& lps) {
    return "(" + formatFixed(-lps.x, 1) + ", " + formatFixed(-lps.y, 1) + ", " +
           formatFixed(lps.z, 1) + ") mm RAS";
}

}  // namespace

std::string BemModel::failureText() const {
    std::string text = findings.front().what + " at " + rasText(findings.front().pointMm);
    if (findings.size() > 1) {
        text += " (and " + formatCount(std::ssize(findings) - 1) + " more)";
    }
    return text;
}

std::string bemSurfaceName(std::size_t surface) {
    return std::string(toString(static_cast<HeadSurface>(surface)));
}

}  // namespace adaptiso
