#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>

#include "adaptiso/ImageIO/ReadVolume.h"

/// Runs untrusted code: GDCM and ITK assert(), abort(), loop and overrun buffers
/// on odd files. Decisions/0003-decoders-behind-a-fence.md says why it is a forked child.
namespace adaptiso::detail {

struct FenceLimits {
    std::chrono::milliseconds time;  ///< of the wall clock, from start to answer
    std::uint64_t memoryBytes;       ///< heap and stack above what the parent has; samples apart
};

/// Generous for what honest files take: 15 s and 1 s for each MB of input; 1 GiB and 64 bytes for
/// each byte of input, at most the machine's memory.
FenceLimits fenceLimitsFor(const std::filesystem::path& input);

/// Runs `read` in a child process and hands back what it returns. Its samples are not copied: the
/// child decodes into shared memory (allocateSamples), which the volume then owns.
///
/// The child has the limits given, writes nothing to stdout and stderr, dumps no core and dies
/// with the parent. Nothing of it is left when this returns or throws.
///
/// \param input  what a message names when the child can't say more itself
/// \param read   uses no other thread and no lock that one may hold: no TBB (a forked child has
///               the calling thread alone). Behind a fence already, it is called directly.
/// \throws what `read` throws of this library's errors; FileError when the child crashes, ends
///         early, answers nonsense or exceeds a limit, and for other exceptions
ReadVolume readBehindFence(const std::filesystem::path& input, const FenceLimits& limits,
                           const std::function<ReadVolume()>& read);

/// Behind a fence: from now on a crash or a limit reached is laid to `file`, not to the input.
void blameBehindFence(const std::filesystem::path& file);

bool isBehindFence();

/// Memory that outlives the child. \pre isBehindFence() \return empty when memory is short
std::shared_ptr<std::byte[]> allocateSharedBytes(std::uint64_t byteCount);

/// The machine's memory and swap space.
std::uint64_t machineMemoryBytes();

}  // namespace adaptiso::detail
