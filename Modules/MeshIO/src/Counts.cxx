#include "Counts.h"

#include <limits>
#include <string>

#include "Bytes.h"
#include "Codecs.h"
#include "adaptiso/Core/Surplus.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/MeshIO/Formats.h"
#include "adaptiso/MeshIO/Xml.h"

namespace adaptiso::meshio {
namespace {

constexpr const char* kRemedy =
    "are two files joined? give each by itself; or correct the count, or get the file again";

/// Words of the file, as PLY's elements.
std::string shownWhat(const Counted& counted) {
    constexpr std::size_t kMost = 40;
    return visibleAscii(counted.what.substr(0, kMost));
}

std::string behind(const Counted& counted) {
    return " behind the " + std::to_string(counted.count) + " " + shownWhat(counted) +
           " that it counts";
}

[[noreturn]] void refuseMore(const Counted& counted, std::int64_t more) {
    const std::string amount =
        more > 0 ? std::to_string(more) + " more" : "half as many bytes again, or more,";
    unsupported("it holds " + amount + behind(counted), kRemedy);
}

/// Refuses bytes that begin as a surface does.
void requireNoSecondFile(const Counted& counted, std::string_view rest) {
    constexpr std::size_t kLeast = 12;  // fewer may be chance
    if (rest.size() < kLeast) return;
    const MeshFormat* format = recognizeMeshFormat(rest.substr(0, kMeshHeadBytes), rest.size());
    if (format != nullptr) refuseSecondFile(counted, format->name);
}

void warn(const Counted& counted, std::string_view rest, std::vector<Warning>& warnings) {
    const bool isPadding = areZeros(rest);
    warnings.push_back(
        {"trailing-bytes", std::to_string(rest.size()) + " bytes" + (isPadding ? ", all 0," : "") +
                               " follow the " + std::to_string(counted.count) + " " +
                               shownWhat(counted) + " that it counts; they were left out"});
}

}  // namespace

void refuseSecondFile(const Counted& counted, std::string_view name) {
    unsupported("it holds another surface (" + std::string(name) + ")" + behind(counted), kRemedy);
}

void requireNoMore(const Counted& counted, std::string_view rest, std::vector<Warning>& warnings) {
    if (rest.empty()) return;
    if (rest.size() > kMostPadding || !areZeros(rest)) {
        requireNoSecondFile(counted, rest);
        const auto record = static_cast<std::uint64_t>(counted.each);
        if (isMoreData(rest.size(), record, record * static_cast<std::uint64_t>(counted.count))) {
            refuseMore(counted, rest.size() % record == 0
                                    ? static_cast<std::int64_t>(rest.size() / record)
                                    : 0);
        }
    }
    warn(counted, rest, warnings);
}

void requireNoMoreText(const Counted& counted, std::string_view rest,
                       std::vector<Warning>& warnings) {
    if (trimmed(rest).empty()) return;
    requireNoSecondFile(counted, rest);
    rest = trimmed(rest);
    std::int64_t numbers = 0;
    ByteSource words(rest);
    for (std::string_view word = words.word(); !word.empty(); word = words.word()) {
        if (word.find_first_not_of("0123456789+-.eEdD") != std::string_view::npos) break;
        ++numbers;
    }
    if (numbers >= counted.each) {
        std::int64_t lines = 0;
        for (ByteSource left(rest); !left.atEnd();) lines += !trimmed(left.line()).empty();
        refuseMore(counted, counted.each == 1 ? numbers : lines);
    }
    warn(counted, rest, warnings);
}

void Unpacking::add(std::int64_t count, std::size_t bytesEach) {
    const auto most = std::numeric_limits<std::size_t>::max() / 2;
    const auto numbers = static_cast<std::size_t>(count);
    bytes_ += numbers > (most - bytes_) / bytesEach ? most - bytes_ : numbers * bytesEach;
    requirePlausibleSize(fileBytes_, bytes_);
}

bool isUnset(std::int64_t count) {
    return count == 0 || count == -1 || count == std::numeric_limits<std::uint32_t>::max();
}

void setToThere(Counted& counted, std::int64_t there, std::vector<Warning>& warnings) {
    warnings.push_back({"count-unset", "its count of " + shownWhat(counted) + " is " +
                                           std::to_string(counted.count) + "; the " +
                                           std::to_string(there) + " that follow were read"});
    counted.count = there;
}

}  // namespace adaptiso::meshio
