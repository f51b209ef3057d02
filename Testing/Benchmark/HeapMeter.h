#pragma once

#include <cstdint>
#include <functional>

namespace adaptiso::benchmarks {

/// The most heap bytes that `work` holds at one time beyond what is held when it begins, summed
/// over all threads and libraries of the process (a peer's memory is counted as ours is).
///
/// HeapMeter.cxx replaces malloc and its kin, on which operator new stands, and adds up what
/// malloc_usable_size says of each block. While this function does not run that costs one read of
/// a flag for each allocation, so timing belongs outside it. Stacks, mapped files and what the
/// heap loses to fragmentation are left out. \pre not called from two threads at once
std::int64_t peakHeapBytes(const std::function<void()>& work);

/// Lets the heap keep what is freed, from the first run on: blocks up to 32 MiB come from memory
/// that earlier runs touched. glibc comes to that by itself as large blocks are freed (mallopt,
/// M_MMAP_THRESHOLD), but then the runs before pay for fresh pages and those after do not.
void keepFreedMemory();

}  // namespace adaptiso::benchmarks
