#include <malloc.h>

#include "CommandLine.h"
#include "Common/RunApp.h"
#include "Pipeline.h"

int main(int argc, char** argv) {
    // Solids are blocks of tens of MB: mapped each, they go back to the system when freed. glibc
    // would raise its threshold to their size and keep them: 10 % more memory at most.
    constexpr int kMappedBytes = 4 << 20;
    mallopt(M_MMAP_THRESHOLD, kMappedBytes);
    return adaptiso::runApp(argc, argv, adaptiso::bemProgram(), adaptiso::declareBemOptions,
                            adaptiso::runBem);
}
