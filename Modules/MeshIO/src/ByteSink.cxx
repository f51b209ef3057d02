#include "ByteSink.h"

#include <charconv>

namespace adaptiso::meshio {

ByteSink& ByteSink::operator<<(std::int64_t number) {
    char text[24];
    const auto end = std::to_chars(text, text + sizeof(text), number).ptr;
    return *this << std::string_view(text, static_cast<std::size_t>(end - text));
}

ByteSink& ByteSink::operator<<(double number) {
    char text[40];
    const auto end = std::to_chars(text, text + sizeof(text), number + 0.0,  // + 0.0: no "-0"
                                   std::chars_format::general, 9)
                         .ptr;
    return *this << std::string_view(text, static_cast<std::size_t>(end - text));
}

}  // namespace adaptiso::meshio
