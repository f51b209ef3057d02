// libFuzzer target: bytes that claim to be a plan or a piece of adaptiso-giant. They are refused
// with a FileError, or what they say is said again to the byte.
//
// An odd first byte: a plan. An even one: a piece, whose checksums are mended, as a forger would:
// else no input would get past them.

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "Common/Sha256.h"
#include "OneLine.h"
#include "adaptiso-giant/GiantPlan.h"
#include "adaptiso-giant/PieceFile.h"

namespace {

void seal(std::string& bytes, std::size_t begin, std::size_t end) {
    const std::string sum = adaptiso::sha256Of(std::string_view(bytes).substr(begin, end - begin));
    bytes.replace(end, sum.size(), sum);
}

/// Where the first part of a piece ends, without its checksum; 0: nobody knows.
std::size_t endOfSummary(const std::string& bytes) {
    constexpr std::size_t kBegin = 16, kComponent = 32, kVertex = 32, kEdge = 8, kMost = 1 << 20;
    if (bytes.size() < kBegin) return 0;
    std::uint64_t length = 0;
    std::memcpy(&length, bytes.data() + 8, sizeof length);
    if (length > bytes.size() - kBegin) return 0;
    const auto header = nlohmann::json::parse(bytes.substr(kBegin, length), nullptr, false);
    std::size_t end = kBegin + length;
    for (const auto& [key, size] : {std::pair<const char*, std::size_t>{"components", kComponent},
                                    {"borderVertices", kVertex},
                                    {"borderEdges", kEdge}}) {
        if (!header.is_object() || !header.contains(key) || !header[key].is_number_unsigned() ||
            header[key].get<std::uint64_t>() > kMost) {
            return 0;
        }
        end += size * header[key].get<std::size_t>();
    }
    return end;
}

void tryPiece(std::string bytes) {
    constexpr std::size_t kSum = 64;
    const std::size_t end = endOfSummary(bytes);
    if (end != 0 && end + 2 * kSum <= bytes.size()) {
        seal(bytes, 0, end);
        seal(bytes, end + kSum, bytes.size() - kSum);
    }
    const adaptiso::giant::Piece piece = adaptiso::giant::decodePiece(bytes, "piece");
    const std::string again = adaptiso::giant::encodePiece(piece);
    const adaptiso::giant::Piece same = adaptiso::giant::decodePiece(again, "piece");
    if (same.mesh.points.size() != piece.mesh.points.size() ||
        same.mesh.triangles != piece.mesh.triangles) {
        std::abort();
    }
}

void tryPlan(const std::string& text) {
    const std::string again =
        adaptiso::giant::encodePlan(adaptiso::giant::decodePlan(text, "plan"));
    if (adaptiso::giant::encodePlan(adaptiso::giant::decodePlan(again, "plan")) != again)
        std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    const std::string bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
    try {
        if (data[0] & 1) {
            tryPlan(bytes);
        } else {
            tryPiece(bytes);
        }
    } catch (const adaptiso::FileError& refusal) {
        adaptiso::fuzz::requireOneLine(refusal);
    }
    return 0;
}
