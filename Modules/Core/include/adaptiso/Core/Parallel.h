#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <utility>

namespace adaptiso {
namespace detail {

/// A function object and how it is called, without its type: oneTBB's templates are compiled once,
/// in Core, and not for every body of every sample type. It must outlive the call.
template <class... Arguments>
struct BodyRef {
    const void* body;
    void (*call)(const void* body, Arguments... arguments);

    template <class Body>
    static BodyRef to(const Body& body) {
        return {&body, [](const void* of, Arguments... arguments) {
                    (*static_cast<const Body*>(of))(arguments...);
                }};
    }
    void operator()(Arguments... arguments) const { call(body, arguments...); }
};

void runPieces(std::int64_t count, std::int64_t grain, BodyRef<std::int64_t, std::int64_t> body);
void runLargestFirst(std::span<const std::int64_t> sizes, BodyRef<std::int64_t> body);
void runBoth(BodyRef<> first, BodyRef<> second);
void runInOrder(std::int64_t count, BodyRef<std::int64_t, std::shared_ptr<void>&> make,
                BodyRef<void*> take);
void runIsolated(BodyRef<> body);

}  // namespace detail

/// Calls body(begin, end) over [0, count) cut into pieces of `grain` (the last may be shorter),
/// in parallel. The cuts depend on count and grain alone, never on the number of threads, so a
/// result kept per piece (number begin / grain) is the same on every machine.
template <class Body>
void parallelForPieces(std::int64_t count, std::int64_t grain, const Body& body) {
    detail::runPieces(count, grain, detail::BodyRef<std::int64_t, std::int64_t>::to(body));
}

/// Calls body(n) for every n below the number of sizes, in parallel, the largest first (of equal
/// ones the first): no thread begins a large one when the others are about to end.
template <class Body>
void parallelLargestFirst(std::span<const std::int64_t> sizes, const Body& body) {
    detail::runLargestFirst(sizes, detail::BodyRef<std::int64_t>::to(body));
}

/// Calls all, in parallel where threads are free; they have ended when it returns.
template <class First, class Second, class... Others>
void parallelInvoke(const First& first, const Second& second, const Others&... others) {
    if constexpr (sizeof...(Others) == 0) {
        detail::runBoth(detail::BodyRef<>::to(first), detail::BodyRef<>::to(second));
    } else {
        const auto rest = [&] { parallelInvoke(second, others...); };
        detail::runBoth(detail::BodyRef<>::to(first), detail::BodyRef<>::to(rest));
    }
}

/// Calls take(make(n)) for n = 0 ... count - 1: `make` in parallel, `take` one at a time in the
/// order of n. Four results a thread wait at most.
template <class Make, class Take>
void parallelInOrder(std::int64_t count, const Make& make, const Take& take) {
    using Result = std::invoke_result_t<const Make&, std::int64_t>;
    const auto makeOne = [&](std::int64_t n, std::shared_ptr<void>& result) {
        result = std::make_shared<Result>(make(n));
    };
    const auto takeOne = [&](void* result) { take(std::move(*static_cast<Result*>(result))); };
    detail::runInOrder(count, detail::BodyRef<std::int64_t, std::shared_ptr<void>&>::to(makeOne),
                       detail::BodyRef<void*>::to(takeOne));
}

/// Calls body(). While this thread waits for the tasks of `body` it takes no others: none that
/// needs a lock it holds.
template <class Body>
void isolated(const Body& body) {
    detail::runIsolated(detail::BodyRef<>::to(body));
}

/// Threads that parallel work may use, >= 1; 1 where the library is built without oneTBB.
int threadLimit();

/// Lowers threadLimit() to `threads` >= 1 while it lives.
class ThreadLimitGuard {
public:
    explicit ThreadLimitGuard(int threads);
    ~ThreadLimitGuard();
    ThreadLimitGuard(const ThreadLimitGuard&) = delete;
    ThreadLimitGuard& operator=(const ThreadLimitGuard&) = delete;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Name of the thread library: "oneTBB 2021.8.0", or "one thread".
std::string threadingName();

}  // namespace adaptiso
