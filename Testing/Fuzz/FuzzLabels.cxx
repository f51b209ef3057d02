// libFuzzer target: bytes that claim to be a table of labels, of whichever kind. Whatever they
// hold, they are refused with a FileError or give a table whose names can be shown.

#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "OneLine.h"
#include "adaptiso/LabelNames/LabelTable.h"

namespace adaptiso {
namespace {

bool isPlain(std::string_view text) {
    for (const char c : text) {
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) return false;
    }
    return true;
}

/// What decodeLabelTable() promises of a table that it does not refuse.
void requireSound(const LabelTable& table) {
    if (table.entries.empty()) std::abort();
    for (std::size_t n = 0; n < table.entries.size(); ++n) {
        const LabelEntry& entry = table.entries[n];
        if (n > 0 && table.entries[n - 1].value >= entry.value) std::abort();
        if (!isPlain(entry.name) || !isPlain(entry.abbreviation)) std::abort();
        if (table.find(entry.value) != &entry) std::abort();
    }
    for (const Warning& warning : table.warnings) {
        if (!isPlain(warning.line())) std::abort();
    }
}

}  // namespace
}  // namespace adaptiso

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view bytes(reinterpret_cast<const char*>(data), size);
    try {
        adaptiso::requireSound(adaptiso::decodeLabelTable(bytes, "fuzzed"));
    } catch (const adaptiso::FileError& refusal) {
        adaptiso::fuzz::requireOneLine(refusal);
    }
    try {
        const adaptiso::LabelTable inside = adaptiso::decodeEmbeddedTable(bytes, size % 2);
        if (!inside.entries.empty()) adaptiso::requireSound(inside);
    } catch (const adaptiso::FileError& refusal) {
        adaptiso::fuzz::requireOneLine(refusal);
    }
    return 0;
}
