#include "Common/Threads.h"

#include <iterator>
#include <latch>
#include <system_error>
#include <thread>
#include <vector>

namespace adaptiso {

int startableThreads(int wanted) {
    std::latch end(1);  // they live at the same time
    std::vector<std::thread> threads;
    threads.reserve(static_cast<std::size_t>(wanted));
    try {
        while (std::ssize(threads) < wanted) threads.emplace_back([&end] { end.wait(); });
    } catch (const std::system_error&) {
        // as many as there are
    }
    end.count_down();
    for (std::thread& thread : threads) thread.join();
    return static_cast<int>(threads.size());
}

}  // namespace adaptiso
