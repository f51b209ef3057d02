#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/Core/Warning.h"

namespace adaptiso::detail {

/// Answer of a fenced child to its parent: a volume's description, or the error it threw.
struct FenceAnswer {
    enum class Kind : std::uint32_t {
        Volume,
        FileError,
        InvalidInput,
        InternalError,
        OutOfMemory,
        UnknownError
    };
    Kind kind = Kind::UnknownError;
    std::string message;  ///< of an error

    PixelType pixelType = PixelType::UInt8;
    ImageGeometry geometry;
    std::uint64_t offset = 0, byteCount = 0;  ///< of the samples in the shared memory
    std::string format;
    std::vector<Warning> warnings;
};

/// Longer answers are refused.
inline constexpr std::size_t kLongestAnswer = std::size_t{1} << 20;

std::string packFenceAnswer(const FenceAnswer& answer);

/// \param bytes  from a process whose memory may be damaged: anything at all
/// \return nothing unless `bytes` is one whole answer. Control characters of texts become blanks.
std::optional<FenceAnswer> parseFenceAnswer(std::string_view bytes);

}  // namespace adaptiso::detail
