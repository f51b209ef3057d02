#include "NrrdText.h"

#include <fmt/core.h>

#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>

#include "DataPlace.h"
#include "FileFault.h"
#include "HeaderText.h"
#include "Samples.h"

namespace adaptiso::detail {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t kLongestWord = 400;  // longer than any double's digits

/// The words of a file, one after the other; of longer ones than kLongestWord the beginning.
class WordStream {
public:
    explicit WordStream(ByteSource& source) : source_(source) {}

    /// The next word; empty at the end.
    std::string_view next() {
        word_.clear();
        for (;;) {
            if (at_ == piece_.size() && !refill()) return word_;
            const char c = piece_[at_++];
            const bool isBlank = c == ' ' || c == ',' || (c >= '\t' && c <= '\r');
            if (isBlank && !word_.empty()) return word_;
            if (!isBlank && word_.size() <= kLongestWord) word_ += c;
        }
    }

private:
    bool refill() {
        piece_.resize(std::size_t{1} << 16);
        piece_.resize(source_.readSome(piece_.data(), piece_.size()));
        at_ = 0;
        return !piece_.empty();
    }

    ByteSource& source_;
    std::string piece_, word_;
    std::size_t at_ = 0;
};

/// Nothing where `word` is no number that T holds.
template <class T>
std::optional<T> sampleOf(std::string_view word) {
    if (word.size() > kLongestWord) return std::nullopt;
    if constexpr (std::is_integral_v<T>) {
        if (const auto whole = parseNumberAs<T>(word)) return whole;
        const auto value = parseNumber(word);  // 12.0, 1e3
        // 2^53: what a double tells apart
        if (!value || *value != std::floor(*value) || std::abs(*value) > 9007199254740992.0) {
            return std::nullopt;
        }
        if (*value < static_cast<double>(std::numeric_limits<T>::lowest()) ||
            *value > static_cast<double>(std::numeric_limits<T>::max())) {
            return std::nullopt;
        }
        return static_cast<T>(*value);
    } else {
        const auto value = parseNumber(word);
        if (!value) return std::nullopt;
        const T sample = scaledSample<T>(*value, 1, 0);
        if (std::isfinite(*value) && !std::isfinite(sample)) return std::nullopt;
        return sample;
    }
}

template <class T>
void readWords(const fs::path& file, WordStream& stream, std::int64_t count, T* out) {
    for (std::int64_t n = 0; n < count; ++n) {
        const std::string_view word = stream.next();
        if (word.empty()) {
            refuse(file, fmt::format("truncated: its data hold {} of {} numbers", n, count),
                   "get the whole file");
        }
        const std::optional<T> sample = sampleOf<T>(word);
        if (!sample) {
            refuse(file,
                   fmt::format("number {} of its data, '{}', is none of its type ({} bits{})",
                               n + 1, printable(word), 8 * sizeof(T),
                               std::is_floating_point_v<T> ? ", floating-point"
                               : std::is_signed_v<T>       ? ", integer"
                                                           : ", integer without sign"),
                   "correct the header's type, or the number");
        }
        out[n] = *sample;
    }
}

}  // namespace

Volume readNrrdText(const fs::path& file, ByteSource& source, PixelType type,
                    const ImageGeometry& geometry, std::vector<Warning>& warnings) {
    requireUsableGeometry(file, geometry);
    const std::int64_t count = geometry.voxelCount();
    const std::uint64_t byteCount = requireImageBytes(file, geometry.size, type);
    source.requireRoomFor(2 * static_cast<std::uint64_t>(count) - 1);  // a digit and a blank each
    SampleBuffer samples = allocateSamples(file, byteCount);
    WordStream stream(source);
    withPixelType(type, [&]<class T>(T) {
        readWords(file, stream, count, reinterpret_cast<T*>(samples.get()));
    });

    std::uint64_t more = 0;
    const auto enough = static_cast<std::uint64_t>(count) + 1;
    while (more < enough && !stream.next().empty()) ++more;
    const auto slice = static_cast<std::uint64_t>(geometry.size[0] * geometry.size[1]);
    if (isMoreImage(more, {slice, static_cast<std::uint64_t>(count)})) {
        refuse(file,
               fmt::format("its data hold {}{} numbers, its header describes {}",
                           more == enough ? "at least " : "",
                           static_cast<std::uint64_t>(count) + more, count),
               "correct the header's sizes, or cut the file to one image");
    }
    if (more > 0) {
        warnings.push_back(
            {"trailing-bytes",
             fmt::format("{} words follow the image that its header describes; they were left out",
                         more)});
    }
    return makeVolume(std::move(samples), type, geometry);
}

}  // namespace adaptiso::detail
