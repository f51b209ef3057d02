#include "adaptiso/Core/ReturnMemory.h"

#include <cstdlib>  // says which C library it is

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace adaptiso {

void returnFreedMemory() {
#ifdef __GLIBC__
    malloc_trim(0);
#endif
}

void keepFreedMemory() {
#ifdef __GLIBC__
    constexpr int kLargestKept = 1 << 30;  // bytes
    mallopt(M_MMAP_THRESHOLD, kLargestKept);
    mallopt(M_TRIM_THRESHOLD, kLargestKept);
#endif
}

}  // namespace adaptiso
