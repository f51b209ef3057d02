#pragma once

#include <cstdint>

namespace adaptiso::detail {

/// Is the surface in a window of 4 x 4 x 4 samples a single sheet?
///
/// \param inside  bit x + 4 (y + 4 z): the sample is inside
/// \return  true when there is one of 26 lattice directions such that, along it and along all
///          lattice directions within 50 degrees of it, every line of samples goes from inside to
///          outside at most once and never back: the surface is then a graph over the plane at
///          right angles to that direction.
bool isSingleSheet(std::uint64_t inside);

}  // namespace adaptiso::detail
