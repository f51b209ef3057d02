#include "NrrdHeader.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>

#include "DataPlace.h"
#include "FileFault.h"
#include "HeaderText.h"
#include "Readers.h"
#include "Samples.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/TextLines.h"

namespace adaptiso::detail {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void refuseHeader(const fs::path& file, std::string_view what) {
    refuse(file, fmt::format("its NRRD header is damaged: {}", what), "repair the header");
}

std::string canonicalName(std::string_view name) {
    std::string canonical = lowerCase(trimmed(name));
    std::erase(canonical, ' ');
    return canonical == "centerings" ? "centers" : canonical;
}

/// Signs that turn a point of the header's space into LPS: of the named one, else of the given one.
Mat3 spaceToLps(const fs::path& file, std::optional<std::string_view> name,
                std::optional<ImageSpace> given) {
    const auto named = [&](const Mat3& signs) {
        if (!given) return signs;
        refuse(file, fmt::format("its header names its space, {}", printable(*name)),
               "leave --image-space out");
    };
    const std::string space = lowerCase(name.value_or(""));
    if (space == "left-posterior-superior" || space == "lps") return named(toLps(ImageSpace::Lps));
    if (space == "right-anterior-superior" || space == "ras") return named(toLps(ImageSpace::Ras));
    if (space == "left-anterior-superior" || space == "las") return named(Mat3::diagonal(1, -1, 1));
    if (given) return toLps(*given);
    refuse(
        file,
        name ? fmt::format("its space '{}' does not say where left and right are", printable(*name))
             : "it has space directions but no named space, so left and right are unknown",
        "give --image-space lps or ras");
}

/// The texts of a list, in quotes or not: "mm" "" mm
std::vector<std::string> quotedWords(std::string_view text) {
    std::vector<std::string> found;
    for (text = trimmed(text); !text.empty(); text = trimmed(text)) {
        const bool isQuoted = text.front() == '"';
        if (isQuoted) text.remove_prefix(1);
        const std::size_t end =
            std::min(text.find_first_of(isQuoted ? "\"" : " \t\""), text.size());
        found.emplace_back(trimmed(text.substr(0, end)));
        text.remove_prefix(std::min(end + (isQuoted ? 1 : 0), text.size()));
    }
    return found;
}

/// Empty where the text names no unit. \throws FileError  an unknown one
std::optional<double> millimetresPerUnit(const fs::path& file, const std::string& text) {
    const std::string unit = lowerCase(text);
    if (unit.empty() || unit == "???" || unit == "none") return std::nullopt;
    if (unit == "mm" || unit == "millimeter" || unit == "millimeters") return 1;
    if (unit == "m" || unit == "meter" || unit == "meters") return 1000;
    if (unit == "cm" || unit == "centimeter" || unit == "centimeters") return 10;
    if (unit == "nm" || unit == "nanometer" || unit == "nanometers") return 1e-6;
    if (unit == "um" || unit == "micron" || unit == "microns" || unit == "micrometer" ||
        unit == "micrometers" || unit == "\u00b5m" || unit == "\u03bcm") {
        return 0.001;
    }
    refuse(file, fmt::format("its unit '{}' is not known here", printable(text)), "use mm");
}

/// Of "space units": one for all axes.
std::optional<double> spaceUnitMm(const fs::path& file, std::string_view text) {
    std::optional<double> scale;
    for (const std::string& unit : quotedWords(text)) {
        const std::optional<double> one = millimetresPerUnit(file, unit);
        if (!one) continue;
        if (scale && *one != *scale) {
            refuse(file, fmt::format("its space units {} differ", printable(text)), "use mm");
        }
        scale = one;
    }
    return scale;
}

/// "(1,0,0) none (0,1,0) ..."; nothing stands for none.
std::vector<std::optional<Vec3>> parseVectors(const fs::path& file, std::string_view field,
                                              std::string_view text) {
    std::vector<std::optional<Vec3>> vectors;
    for (text = trimmed(text); !text.empty(); text = trimmed(text)) {
        constexpr std::string_view kNone = "none";
        if (lowerCase(text.substr(0, kNone.size())) == kNone) {
            vectors.emplace_back();
            text.remove_prefix(kNone.size());
            continue;
        }
        const std::size_t close = text.find(')');
        Vec3 vector;
        bool isGood = text.front() == '(' && close != std::string_view::npos;
        std::string_view inside = isGood ? text.substr(1, close - 1) : std::string_view{};
        for (int row = 0; isGood && row < 3; ++row) {
            const std::size_t comma = inside.find(',');
            isGood = (comma == std::string_view::npos) == (row == 2);
            const auto value = parseNumber(inside.substr(0, comma));
            isGood = isGood && value && std::isfinite(*value);
            if (isGood) vector[row] = *value;
            inside = comma == std::string_view::npos ? "" : inside.substr(comma + 1);
        }
        if (!isGood) {
            refuseHeader(file,
                         fmt::format("{} are not vectors of three numbers for each axis", field));
        }
        vectors.emplace_back(vector);
        text.remove_prefix(close + 1);
    }
    return vectors;
}

/// The kinds of axes, lower case; as many as there are axes, "???" where the header does not say.
std::vector<std::string> kindsOf(const NrrdHeader& header, std::size_t axisCount) {
    std::vector<std::string> kinds;
    for (const std::string_view kind : words(header.find("kinds").value_or(""))) {
        kinds.push_back(lowerCase(kind));
    }
    kinds.resize(axisCount, "???");
    return kinds;
}

/// The one of four axes that is no direction in space.
std::size_t findVolumeAxis(const fs::path& file, const NrrdHeader& header,
                           const std::vector<std::string>& kinds) {
    std::vector<std::size_t> candidates;
    if (const auto text = header.find("spacedirections")) {
        const auto directions = parseVectors(file, "space directions", *text);
        for (std::size_t axis = 0; axis < directions.size() && axis < 4; ++axis) {
            if (!directions[axis]) candidates.push_back(axis);
        }
    } else {
        for (std::size_t axis = 0; axis < 4; ++axis) {
            if (!isSpatialKind(kinds[axis])) candidates.push_back(axis);
        }
    }
    if (candidates.size() != 1 || candidates[0] == 1 || candidates[0] == 2) {
        refuse(file,
               "has 4 dimensions, of which not exactly one, the first or last, is no direction in "
               "space",
               "extract one scalar volume first");
    }
    const std::string& kind = kinds[candidates[0]];
    if (kind != "list" && kind != "time" && !isSpatialKind(kind)) {
        refuse(file,
               fmt::format("its samples have components: an axis of its 4 dimensions is a '{}'",
                           printable(kind)),
               "extract one scalar volume first");
    }
    return candidates[0];
}

/// What "spacings" and "units" say of an axis in space.
struct AxisStep {
    std::optional<double> spacing;  ///< in its unit; none where it is not said
    std::optional<double> unitMm;
};

std::array<AxisStep, 3> axisSteps(const fs::path& file, const NrrdHeader& header,
                                  const NrrdAxes& axes, bool haveDirections) {
    const auto spacings = words(header.find("spacings").value_or(""));
    const auto units = quotedWords(header.find("units").value_or(""));
    for (const auto& [count, name] :
         {std::pair{spacings.size(), "spacings"}, std::pair{units.size(), "units"}}) {
        if (count == 0 || count == axes.count()) continue;
        refuseHeader(file, fmt::format("{} {} for {} axes", count, name, axes.count()));
    }
    std::array<AxisStep, 3> steps;
    for (std::size_t axis = 0, spatial = 0; axis < axes.count(); ++axis) {
        if (axis == axes.volumeAxis) continue;
        AxisStep& step = steps[spatial++];
        if (!units.empty()) step.unitMm = millimetresPerUnit(file, units[axis]);
        if (spacings.empty() || (haveDirections && lowerCase(spacings[axis]) == "nan")) continue;
        step.spacing = parseNumber(spacings[axis]);
        if (!step.spacing || !(*step.spacing > 0)) {
            refuse(file,
                   fmt::format("voxel spacing '{}' must be a number above zero",
                               printable(spacings[axis])),
                   "repair the header");
        }
    }
    return steps;
}

void warnOfUnit(std::vector<Warning>& warnings) {
    warnings.push_back({"unit-converted", "its units of length were turned into mm"});
}

/// Without a space: steps of 1 mm where none is said.
ImageGeometry spacedGeometry(const fs::path& file, const NrrdHeader& header, const NrrdAxes& axes,
                             std::optional<ImageSpace> given, std::vector<Warning>& warnings) {
    const std::array<AxisStep, 3> steps = axisSteps(file, header, axes, false);
    const auto says = [](const AxisStep& step) { return step.spacing.has_value(); };
    const auto named =
        std::ranges::count_if(steps, [](const AxisStep& step) { return step.unitMm.has_value(); });
    const bool areMm = std::ranges::all_of(
        steps, [](const AxisStep& step) { return step.unitMm.value_or(1) == 1; });
    if (named > 0 && named < 3 && !areMm) {
        refuse(file, "some of its axes in space have a unit, others none", "repair the header");
    }
    const double spaceMm = spaceUnitMm(file, header.find("spaceunits").value_or("")).value_or(1);
    Vec3 spacing;
    bool isConverted = false;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const AxisStep& step = steps[axis];
        const double unitMm = step.spacing ? step.unitMm.value_or(spaceMm) : 1;
        isConverted = isConverted || unitMm != 1;
        spacing[static_cast<int>(axis)] = unitMm * step.spacing.value_or(1);
    }
    if (isConverted) warnOfUnit(warnings);
    const bool hasAll = std::ranges::all_of(steps, says);
    if (!hasAll) {
        warnings.push_back({"guessed-spacing", "no spacings: a spacing of 1 mm was used"});
    }
    if (given) {
        warnings.push_back(
            {"guessed-position", "no space field: the first voxel was put at 0, 0, 0"});
    } else {
        warnings.push_back(
            {"guessed-orientation",
             fmt::format(
                 "no space field: orientation and position are unknown; {} used along left, "
                 "posterior, superior (--image-space chooses)",
                 hasAll ? "the spacings alone were" : "a spacing of 1 mm was")});
    }
    const Mat3 toLps = detail::toLps(given.value_or(ImageSpace::Lps));
    return {axes.size, {}, toLps * Mat3::diagonal(spacing.x, spacing.y, spacing.z)};
}

/// Spacings or units of axes that have a direction say what that says, or nothing.
void requireNoOtherSteps(const fs::path& file, const NrrdHeader& header, const NrrdAxes& axes,
                         const ImageGeometry& geometry, double scale) {
    const std::array<AxisStep, 3> steps = axisSteps(file, header, axes, true);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const AxisStep& step = steps[axis];
        if (step.unitMm && *step.unitMm != scale) {
            refuse(file, "its header contradicts itself: units and space units differ",
                   "remove the wrong one");
        }
        constexpr double kSlack = 0.01;  // of numbers with few digits: 0.7 for 0.703125
        const double lengthMm = norm(geometry.indexToPhysical.column[axis]);
        if (step.spacing && !(std::abs(*step.spacing * scale - lengthMm) <= kSlack * lengthMm)) {
            refuse(file,
                   fmt::format("its header contradicts itself: the spacing of axis {} is {}, and "
                               "its space direction is {} long",
                               axis, number(*step.spacing), number(lengthMm / scale)),
                   "remove the wrong one");
        }
    }
}

}  // namespace

std::string_view NrrdHeader::require(const fs::path& file, std::string_view name) const {
    if (const auto value = find(name)) return *value;
    refuse(file, fmt::format("its NRRD header misses the field '{}'", name), "repair the header");
}

NrrdHeader readNrrdHeader(const fs::path& file) {
    const std::string text = readHead(file, kLongestHeader);
    NrrdHeader header;
    bool isFirst = true;
    TextLines lines(text, LineEnds::OfFirst);
    while (const auto whole = lines.next()) {
        const std::string_view line = trimmed(*whole);
        header.byteCount = lines.position();
        if (line.empty()) return header;
        const bool isMagicOrComment = isFirst || line.starts_with('#');
        isFirst = false;
        if (isMagicOrComment) continue;
        if (const std::size_t sign = line.find(":="); sign != std::string_view::npos) {
            header.pairs.emplace(line.substr(0, sign), line.substr(sign + 2));
            continue;
        }
        const std::size_t colon = line.find(": ");
        const bool hasColon = colon != std::string_view::npos || line.ends_with(':');
        if (!hasColon) {
            refuse(file,
                   "its NRRD header is damaged or not ended by an empty line (a line is no "
                   "'field: value')",
                   "repair the header");
        }
        const auto name = canonicalName(line.substr(0, std::min(colon, line.size() - 1)));
        const auto value = colon == std::string_view::npos ? "" : trimmed(line.substr(colon + 2));
        if (!header.fields.emplace(name, value).second) {
            refuse(file, fmt::format("its NRRD header has the field '{}' twice", printable(name)),
                   "repair the header");
        }
    }
    if (text.size() == kLongestHeader) {
        refuse(file, "its NRRD header is longer than 1 MiB", "remove key/value pairs from it");
    }
    return header;
}

std::string volumesNameOf(const NrrdHeader& header) {
    std::map<std::int64_t, std::string> layers;
    for (int segment = 0;; ++segment) {
        const std::string prefix = fmt::format("Segment{}_", segment);
        const auto name = header.pairs.find(prefix + "Name");
        const auto layer = header.pairs.find(prefix + "Layer");
        if (name == header.pairs.end() || layer == header.pairs.end()) break;
        std::string& names = layers[parseInteger(layer->second).value_or(0)];
        addPart(names, printable(name->second));
    }
    if (layers.empty()) return "volumes";
    std::string text = "layers of segments that overlap (";
    for (const auto& [layer, names] : layers) {
        text += fmt::format("{}{}: {}", text.back() == '(' ? "" : "; ", layer, names);
    }
    return text + ")";
}

PixelType pixelTypeOf(const fs::path& file, const NrrdHeader& header) {
    const std::string_view text = header.require(file, "type");
    static constexpr std::pair<PixelType, std::string_view> kTypes[] = {
        {PixelType::Int8, "signed char, int8, int8_t"},
        {PixelType::UInt8, "uchar, unsigned char, uint8, uint8_t"},
        {PixelType::Int16, "short, short int, signed short, signed short int, int16, int16_t"},
        {PixelType::UInt16, "ushort, unsigned short, unsigned short int, uint16, uint16_t"},
        {PixelType::Int32, "int, signed int, int32, int32_t"},
        {PixelType::UInt32, "uint, unsigned int, uint32, uint32_t"},
        {PixelType::Int64,
         "longlong, long long, long long int, signed long long, signed long long int, int64, "
         "int64_t"},
        {PixelType::UInt64,
         "ulonglong, unsigned long long, unsigned long long int, uint64, uint64_t"},
        {PixelType::Float32, "float"},
        {PixelType::Float64, "double"}};
    const std::string name = lowerCase(text);
    for (const auto& [type, names] : kTypes) {
        const bool isIt =
            name.find(',') == name.npos &&
            fmt::format(", {}, ", names).find(fmt::format(", {}, ", name)) != name.npos;
        if (isIt) return type;
    }
    refuse(file, fmt::format("unsupported NRRD type '{}'", printable(text)),
           "convert it to a scalar integer or float type");
}

NrrdAxes axesOf(const fs::path& file, const NrrdHeader& header) {
    const auto dimension = parseInteger(header.require(file, "dimension"));
    if (!dimension || *dimension < 1 || *dimension > 16) {
        refuseHeader(file, "dimension must be 1 to 16");
    }
    const auto sizes = words(header.require(file, "sizes"));
    if (std::ssize(sizes) != *dimension) {
        refuseHeader(file, fmt::format("dimension {} but {} sizes", *dimension, sizes.size()));
    }
    if (*dimension != 3 && *dimension != 4) {
        refuse(file, fmt::format("has {} dimensions, must have 3", *dimension),
               "extract one scalar volume first");
    }
    const std::vector<std::string> kinds = kindsOf(header, sizes.size());
    NrrdAxes axes;
    if (*dimension == 4) axes.volumeAxis = findVolumeAxis(file, header, kinds);
    for (std::size_t axis = 0, spatial = 0; axis < sizes.size(); ++axis) {
        const auto extent = parseInteger(sizes[axis]);
        if (!extent) {
            refuseHeader(file, fmt::format("size '{}' is no whole number", printable(sizes[axis])));
        }
        if (axis == axes.volumeAxis) {
            if (*extent < 1) refuseHeader(file, "a size is below 1");
            axes.volumeCount = *extent;
            continue;
        }
        if (!isSpatialKind(kinds[axis])) {
            refuse(file,
                   fmt::format("an axis is a '{}', not a direction in space (components or "
                               "a list of images)",
                               printable(kinds[axis])),
                   "extract one scalar volume first");
        }
        axes.size[spatial++] = *extent;
    }
    return axes;
}

ImageGeometry geometryOf(const fs::path& file, const NrrdHeader& header, const NrrdAxes& axes,
                         std::optional<ImageSpace> given, std::vector<Warning>& warnings) {
    const auto space = header.find("space");
    if (!space && !header.find("spacedirections") && !header.find("spacedimension")) {
        return spacedGeometry(file, header, axes, given, warnings);
    }
    const Mat3 toLps = spaceToLps(file, space, given);
    const double scale = spaceUnitMm(file, header.find("spaceunits").value_or("")).value_or(1);
    if (scale != 1) warnOfUnit(warnings);

    const auto directions =
        parseVectors(file, "space directions", header.require(file, "spacedirections"));
    if (directions.size() != axes.count()) {
        refuseHeader(
            file, fmt::format("{} space directions for {} axes", directions.size(), axes.count()));
    }
    ImageGeometry geometry{axes.size, {}, {}};
    for (std::size_t axis = 0, spatial = 0; axis < directions.size(); ++axis) {
        if (axis == axes.volumeAxis) continue;
        if (!directions[axis]) {
            refuseHeader(file, "space directions miss an axis, so its direction is unknown");
        }
        geometry.indexToPhysical.column[spatial++] = scale * (toLps * *directions[axis]);
    }
    requireNoOtherSteps(file, header, axes, geometry, scale);
    const auto text = header.find("spaceorigin");
    if (!text) {
        warnings.push_back(
            {"guessed-position", "no space origin: the first voxel was put at 0, 0, 0"});
        return geometry;
    }
    const auto origin = parseVectors(file, "space origin", *text);
    if (origin.size() != 1 || !origin.front()) {
        refuseHeader(file, "space origin is not one vector");
    }
    geometry.originMm = scale * (toLps * *origin.front());
    return geometry;
}

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
        // 2^53: exact in double
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
    const auto samplesOf = [&](std::size_t a, std::size_t b) {
        return static_cast<std::uint64_t>(geometry.size[a] * geometry.size[b]);
    };
    const ImageExtent extent{samplesOf(0, 1), static_cast<std::uint64_t>(count), samplesOf(0, 2),
                             samplesOf(1, 2)};
    if (isMoreImage(more, extent)) {
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
