#pragma once

#include <array>
#include <cstdint>

namespace adaptiso {

/// An RGB colour.
using ReportColor = std::array<std::uint8_t, 3>;

/// The colour map viridis, dark violet at 0 to yellow at 1: ten samples of matplotlib's table,
/// linear in between. Values beyond 0 and 1 get the end's colour, NaN that of 0.
ReportColor viridis(double part);

/// The colour of surface number `n` in pictures and in the viewer: told apart with any colour
/// vision [Okabe2008], light enough for a black ground. The seventh is the first again.
ReportColor surfaceColor(std::size_t n);

}  // namespace adaptiso
