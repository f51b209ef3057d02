#pragma once

#include <cstdint>
#include <string_view>

namespace adaptiso {

/// Footer that FreeSurfer's mghWrite puts behind the values of .mgh files: four or five numbers of
/// the scan (TR, flip angle, TE, TI, field of view), and tags, each with its length.
/// OpenEnded: from a tag without a length on nothing can be checked.
/// None: the bytes are no tags, but more of the image or another file.
enum class MghFooter { Whole, OpenEnded, CutOff, None };

/// \param head       the first bytes behind the values, at most 1 MiB of them
/// \param byteCount  of all of them
MghFooter mghFooterOf(std::string_view head, std::uint64_t byteCount);

}  // namespace adaptiso
