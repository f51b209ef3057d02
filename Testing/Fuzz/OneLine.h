#pragma once

#include <algorithm>
#include <cstdlib>
#include <string_view>

#include "adaptiso/Core/Errors.h"

namespace adaptiso::fuzz {

/// A refusal is one line that a terminal shows as it is, whatever text the input holds.
inline void requireOneLine(const Error& refusal) {
    const std::string_view message = refusal.what();
    const auto isControl = [](unsigned char c) { return c < 0x20 || c == 0x7f; };
    constexpr std::size_t kLongest = 1000;
    if (message.empty() || message.size() > kLongest || std::ranges::any_of(message, isControl))
        std::abort();
}

}  // namespace adaptiso::fuzz
