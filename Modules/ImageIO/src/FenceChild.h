#pragma once

#include <sys/types.h>

#include <cstdint>
#include <functional>
#include <span>

#include "adaptiso/ImageIO/ReadVolume.h"

namespace adaptiso::detail {

/// Input of a fenced child.
struct FenceChildSetup {
    int answerPipe;             ///< to write the answer into
    int sharedMemory;           ///< a memfd that the samples go into
    std::span<char> blameNote;  ///< shared with the parent, zeros
    std::uint64_t memoryBytes;  ///< the limit
};

/// Forks. The child fences itself in, calls `read`, writes a FenceAnswer and ends.
/// \return the child's id to the parent, -1 with errno when it can't be made. Never to the child.
pid_t forkFenceChild(const FenceChildSetup& setup, const std::function<ReadVolume()>& read);

}  // namespace adaptiso::detail
