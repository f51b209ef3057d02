// libFuzzer target: bytes that claim to be electrodes of the kind that fuzz::ending() says
// (.tsv, .elc, .sfp, .fif; of "caps" the first byte chooses); of .tsv what follows a byte 0 is its
// _coordsystem.json. They are refused with a FileError, or all points have names and are finite.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>

#include "Ending.h"
#include "OneLine.h"
#include "adaptiso/MeshIO/PointFiles.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    std::string_view bytes(reinterpret_cast<const char*>(data), size);
    std::string ending = adaptiso::fuzz::ending();
    if (ending == ".caps") {
        constexpr std::array kCaps{".loc",  ".xyz", ".elp", ".pos",
                                   ".hpts", ".csd", ".txt", ".bvef"};
        if (bytes.empty()) return 0;
        ending = kCaps[static_cast<unsigned char>(bytes.front()) % kCaps.size()];
        bytes.remove_prefix(1);
    }
    std::optional<std::string> json;
    const std::size_t cut = bytes.find('\0');
    if (ending == ".tsv" && cut != bytes.npos) {
        json = std::string(bytes.substr(cut + 1));
        bytes = bytes.substr(0, cut);
    }
    try {
        for (const auto& point : adaptiso::decodePoints(bytes, ending, "input", json).points) {
            if (point.name.empty() || !std::isfinite(squaredNorm(point.point))) std::abort();
        }
    } catch (const adaptiso::FileError& refusal) {
        adaptiso::fuzz::requireOneLine(refusal);
    }
    return 0;
}
