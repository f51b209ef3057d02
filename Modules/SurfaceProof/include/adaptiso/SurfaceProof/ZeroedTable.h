#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>

namespace adaptiso::detail {

/// A large table of zeros of which little is ever touched: memory is used only where it is.
class ZeroedTable {
public:
    explicit ZeroedTable(std::size_t count)
        : numbers_(static_cast<std::uint32_t*>(
              std::calloc(count, sizeof(std::uint32_t)))) {  // NOLINT: leaves pages untouched
        if (!numbers_) throw std::bad_alloc();
    }
    std::uint32_t& operator[](std::size_t i) { return numbers_.get()[i]; }
    std::uint32_t operator[](std::size_t i) const { return numbers_.get()[i]; }

private:
    struct Free {
        void operator()(std::uint32_t* p) const { std::free(p); }  // NOLINT: as above
    };
    std::unique_ptr<std::uint32_t, Free> numbers_;
};

}  // namespace adaptiso::detail
