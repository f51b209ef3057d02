#include "PointColors.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

namespace adaptiso::meshio {
namespace {

std::optional<std::uint8_t> shadeOf(std::string_view word, ColorScale scale) {
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value))
        return {};
    const bool isPart =
        scale == ColorScale::One || word.find_first_of(".eE") != std::string_view::npos;
    constexpr double kFull = 255;
    return static_cast<std::uint8_t>(
        std::lround(std::clamp(isPart ? kFull * value : value, 0.0, kFull)));
}

}  // namespace

void PointColors::add(ByteSource& line, ColorScale scale) {
    if (!areWanted_) return;
    Color color;
    for (std::uint8_t& shade : color) {
        const std::optional<std::uint8_t> read = shadeOf(line.word(), scale);
        if (!read) {
            areWanted_ = false;  // one without a colour: none has
            return;
        }
        shade = *read;
    }
    colors_.push_back(color);
}

std::vector<PointArray> PointColors::take(std::size_t points) {
    if (!areWanted_ || points == 0 || colors_.size() != points) return {};
    return {PointArray{"RGB", std::move(colors_)}};
}

const std::vector<Color>* colorsOf(const MeshWriteOptions& options) {
    if (options.pointArrays.empty()) return nullptr;
    return std::get_if<std::vector<Color>>(&options.pointArrays.front().values);
}

}  // namespace adaptiso::meshio
