#include <algorithm>
#include <cstring>
#include <type_traits>

#include "Sandbox.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso::detail {
namespace {

constexpr std::uint64_t kMagic = 0x6f7369747061'6466;  // "fdaptiso"

/// The part of fixed length, by which an answer begins.
struct Fixed {
    std::uint64_t magic;
    std::uint64_t wholeBytes;
    std::uint32_t kind, pixelType;
    std::int64_t size[3];
    double originMm[3], axes[9];
    std::uint64_t offset, byteCount;
    std::uint64_t textCount;
};
static_assert(std::is_trivially_copyable_v<Fixed>);

void appendText(std::string& bytes, std::string_view text) {
    const std::uint64_t length = text.size();
    bytes.append(reinterpret_cast<const char*>(&length), sizeof length);
    bytes.append(text);
}

std::optional<std::string> takeText(std::string_view& bytes) {
    std::uint64_t length = 0;
    if (bytes.size() < sizeof length) return std::nullopt;
    std::memcpy(&length, bytes.data(), sizeof length);
    bytes.remove_prefix(sizeof length);
    if (length > bytes.size()) return std::nullopt;
    std::string text = withoutControls(bytes.substr(0, length));
    bytes.remove_prefix(length);
    return text;
}

}  // namespace

std::string packSandboxAnswer(const SandboxAnswer& answer) {
    std::vector<std::string_view> texts{answer.message, answer.format, answer.scaling};
    for (const Warning& warning : answer.warnings) {
        texts.insert(texts.end(), {warning.code, warning.text});
    }
    std::string tail;
    for (const std::string_view text : texts) appendText(tail, text);

    Fixed fixed{};
    fixed.magic = kMagic;
    fixed.wholeBytes = sizeof fixed + tail.size();
    fixed.kind = static_cast<std::uint32_t>(answer.kind);
    fixed.pixelType = static_cast<std::uint32_t>(answer.pixelType);
    for (int axis = 0; axis < 3; ++axis) {
        fixed.size[axis] = answer.geometry.size[static_cast<std::size_t>(axis)];
        fixed.originMm[axis] = answer.geometry.originMm[axis];
        for (int row = 0; row < 3; ++row) {
            fixed.axes[3 * axis + row] = answer.geometry.indexToPhysical.column[axis][row];
        }
    }
    fixed.offset = answer.offset;
    fixed.byteCount = answer.byteCount;
    fixed.textCount = texts.size();
    return std::string(reinterpret_cast<const char*>(&fixed), sizeof fixed) + tail;
}

std::optional<SandboxAnswer> parseSandboxAnswer(std::string_view bytes) {
    Fixed fixed{};
    if (bytes.size() < sizeof fixed || bytes.size() > kLongestAnswer) return std::nullopt;
    std::memcpy(&fixed, bytes.data(), sizeof fixed);
    if (fixed.magic != kMagic || fixed.wholeBytes != bytes.size() ||
        fixed.kind > static_cast<std::uint32_t>(SandboxAnswer::Kind::UnknownError) ||
        fixed.pixelType > static_cast<std::uint32_t>(PixelType::Float64) || fixed.textCount < 3 ||
        fixed.textCount % 2 == 0) {
        return std::nullopt;
    }
    SandboxAnswer answer;
    answer.kind = static_cast<SandboxAnswer::Kind>(fixed.kind);
    answer.pixelType = static_cast<PixelType>(fixed.pixelType);
    for (int axis = 0; axis < 3; ++axis) {
        answer.geometry.size[static_cast<std::size_t>(axis)] = fixed.size[axis];
        answer.geometry.originMm[axis] = fixed.originMm[axis];
        for (int row = 0; row < 3; ++row) {
            answer.geometry.indexToPhysical.column[axis][row] = fixed.axes[3 * axis + row];
        }
    }
    answer.offset = fixed.offset;
    answer.byteCount = fixed.byteCount;

    bytes.remove_prefix(sizeof fixed);
    for (std::uint64_t n = 0; n < fixed.textCount; ++n) {
        auto text = takeText(bytes);
        if (!text) return std::nullopt;
        if (n == 0) {
            answer.message = std::move(*text);
        } else if (n == 1) {
            answer.format = std::move(*text);
        } else if (n == 2) {
            answer.scaling = std::move(*text);
        } else if (n % 2 == 1) {
            answer.warnings.push_back({std::move(*text), {}});
        } else {
            answer.warnings.back().text = std::move(*text);
        }
    }
    if (!bytes.empty()) return std::nullopt;
    return answer;
}

}  // namespace adaptiso::detail
