#pragma once

#include <string>
#include <typeinfo>
#include <utility>

#include "adaptiso/Core/Errors.h"

namespace adaptiso {

/// What `work` returns. What it refuses (InvalidInput) is refused with `subject`, the option or the
/// file that it is about, before it: the library knows of neither.
template <class Work>
decltype(auto) naming(const std::string& subject, Work&& work) {
    try {
        return std::forward<Work>(work)();
    } catch (const InvalidInput& error) {
        if (typeid(error) != typeid(InvalidInput)) throw;
        throw InvalidInput(subject + ": " + error.what());
    }
}

}  // namespace adaptiso
