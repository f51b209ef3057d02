#pragma once

#include <functional>
#include <string>

namespace adaptiso::testing {

/// The message of the E that `call` throws; empty if it throws none.
template <class E>
std::string messageOf(const std::function<void()>& call) {
    try {
        call();
    } catch (const E& error) {
        return error.what();
    }
    return {};
}

}  // namespace adaptiso::testing
