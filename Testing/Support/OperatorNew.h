#pragma once

#include <cstddef>

namespace adaptiso::testing {

/// Where every `new` of a program gets its memory, to be defined by a program that OperatorNew.cxx
/// is a source of: it may note what is asked for, or refuse it.
/// \return memory to be given back by std::free, or nullptr: then new throws std::bad_alloc
void* memoryForNew(std::size_t byteCount) noexcept;

}  // namespace adaptiso::testing
