#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "adaptiso/Core/ImageGeometry.h"
#include "adaptiso/Core/Volume.h"
#include "adaptiso/Core/Warning.h"
#include "adaptiso/ImageIO/ReadVolume.h"

/// Runs untrusted code: GDCM and ITK assert(), abort(), loop and overrun buffers
/// on odd files. Decisions/0003-decoders-in-a-sandbox.md says why it is a forked child.
namespace adaptiso::detail {

struct SandboxLimits {
    /// Processor time until the answer, so that a busy machine changes nothing; ten times that by
    /// the clock, for what waits.
    std::chrono::milliseconds time;
    std::uint64_t memoryBytes;  ///< heap and stack above what the parent has; samples apart
};

/// Generous for what honest files take: 15 s and 1 s for each MB of input; 1 GiB and 64 bytes for
/// each byte of input, at most the machine's memory.
SandboxLimits sandboxLimitsFor(const std::filesystem::path& input);

/// Runs `read` in a child process and hands back what it returns. Its samples are not copied: the
/// child decodes into shared memory (allocateSamples), which the volume then owns.
///
/// The child has the limits given, writes nothing to stdout and stderr, dumps no core and dies
/// with the parent. Nothing of it is left when this returns or throws.
///
/// \param input  what a message names when the child can't say more itself
/// \param read   uses no other thread and no lock that one may hold: no TBB (a forked child has
///               the calling thread alone). In a sandbox process already, it is called directly.
/// \throws what `read` throws of this library's errors; FileError when the child crashes, ends
///         early, answers nonsense or exceeds a limit, and for other exceptions
ReadVolume readInSandbox(const std::filesystem::path& input, const SandboxLimits& limits,
                         const std::function<ReadVolume()>& read);

/// In a sandbox process: from now on a crash or a limit reached is laid to `file`, not to the
/// input.
void blameInSandbox(const std::filesystem::path& file);

bool isInSandbox();

/// In a sandbox process: from now on it opens files below `places` alone, wherever links and names
/// in files lead, and writes none. Places that are missing are passed over.
/// \return false, and nothing is changed, where the kernel has no Landlock (Linux 5.13)
bool openOnlyBelow(const std::vector<std::filesystem::path>& places);

/// Memory that outlives the child. \pre isInSandbox() \return empty when memory is short
std::shared_ptr<std::byte[]> allocateSharedBytes(std::uint64_t byteCount);

/// The machine's memory and swap space.
std::uint64_t machineMemoryBytes();

/// Answer of a sandboxed child to its parent: a volume's description, or the error it threw.
struct SandboxAnswer {
    enum class Kind : std::uint32_t {
        Volume,
        FileError,
        Shortage,
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
    std::string scaling{};
};

/// Longer answers are refused.
inline constexpr std::size_t kLongestAnswer = std::size_t{1} << 20;

std::string packSandboxAnswer(const SandboxAnswer& answer);

/// \param bytes  from a process whose memory may be damaged: anything at all
/// \return nothing unless `bytes` is one whole answer. Control characters of texts become blanks.
std::optional<SandboxAnswer> parseSandboxAnswer(std::string_view bytes);

/// Input of a sandboxed child.
struct SandboxChildSetup {
    int answerPipe;             ///< to write the answer into
    int sharedMemory;           ///< a memfd that the samples go into
    std::span<char> blameNote;  ///< shared with the parent, zeros
    std::uint64_t memoryBytes;  ///< the limit
};

/// Forks. The child confines itself, calls `read`, writes a SandboxAnswer and ends.
/// \return the child's id to the parent, -1 with errno when it can't be made. Never to the child.
pid_t forkSandboxChild(const SandboxChildSetup& setup, const std::function<ReadVolume()>& read);

}  // namespace adaptiso::detail
