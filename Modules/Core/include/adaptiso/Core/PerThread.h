#pragma once

#ifdef ADAPTISO_SERIAL
#include <functional>
#include <optional>
#include <utility>
#else
#include <tbb/enumerable_thread_specific.h>
#endif

namespace adaptiso {

/// PerThread<T>: a T for each thread that calls local(), made when it first does. Iterates over all
/// of them, in no order; clear() destroys them. Made from a function that makes one, or by T().
#ifdef ADAPTISO_SERIAL
template <class T>
class PerThread {
public:
    PerThread() : make_([] { return T(); }) {}
    template <class Make>
    explicit PerThread(Make make) : make_(std::move(make)) {}

    T& local() {
        if (!value_) value_.emplace(make_());
        return *value_;
    }
    T* begin() { return value_ ? &*value_ : nullptr; }
    T* end() { return value_ ? &*value_ + 1 : nullptr; }
    void clear() { value_.reset(); }

private:
    std::function<T()> make_;
    std::optional<T> value_;
};
#else
template <class T>
using PerThread = tbb::enumerable_thread_specific<T>;
#endif

}  // namespace adaptiso
