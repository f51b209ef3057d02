#pragma once

#include <cstdint>
#include <span>

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

/// Calls both, in parallel where a thread is free; they have ended when it returns.
template <class First, class Second>
void parallelInvoke(const First& first, const Second& second) {
    detail::runBoth(detail::BodyRef<>::to(first), detail::BodyRef<>::to(second));
}

}  // namespace adaptiso
