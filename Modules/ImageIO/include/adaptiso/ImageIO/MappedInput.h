#pragma once

namespace adaptiso {

/// The file whose mapped samples (ReadOptions::mapFiles) lie at `address`, or nullptr: what a
/// handler of SIGBUS asks to tell a disk that fails from a bug. Async-signal-safe.
///
/// \return valid as long as the volume that holds the samples
const char* mappedFileAt(const void* address) noexcept;

}  // namespace adaptiso
