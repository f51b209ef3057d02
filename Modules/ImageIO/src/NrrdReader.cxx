#include <fmt/core.h>

#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>

#include "FileFault.h"
#include "HeaderText.h"
#include "ItkDecoder.h"
#include "Readers.h"

// The header is read here, after teem.sourceforge.net/nrrd/format.html: ITK 5.2.1 flips the wrong
// axis for left-anterior-superior, takes unknown spaces as LPS and opens any file a header names.
// ITK decodes the samples once all of them are known to be there.
namespace adaptiso::detail {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t kLongestHeader = std::size_t{1} << 20;

struct NrrdHeader {
    std::map<std::string, std::string, std::less<>> fields;  ///< names without blanks, lower case
    std::uint64_t byteCount = 0;                             ///< up to and with the blank line

    std::optional<std::string_view> find(std::string_view name) const {
        const auto it = fields.find(name);
        if (it == fields.end()) return std::nullopt;
        return it->second;
    }
    std::string_view require(const fs::path& file, std::string_view name) const {
        if (const auto value = find(name)) return *value;
        refuse(file, fmt::format("its NRRD header misses the field '{}'", name),
               "repair the header");
    }
};

std::string canonicalName(std::string_view name) {
    std::string canonical = lowerCase(trimmed(name));
    std::erase(canonical, ' ');
    return canonical == "centerings" ? "centers" : canonical;
}

NrrdHeader parseHeader(const fs::path& file) {
    const std::string text = readHead(file, kLongestHeader);
    NrrdHeader header;
    bool isFirst = true;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find('\n', begin), text.size());
        const std::string_view line = trimmed(std::string_view(text).substr(begin, end - begin));
        begin = std::min(end + 1, text.size());
        header.byteCount = begin;
        if (line.empty()) return header;
        const bool isMagicOrComment = isFirst || line.starts_with('#');
        isFirst = false;
        if (isMagicOrComment || line.find(":=") != std::string_view::npos) continue;
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

PixelType parseType(const fs::path& file, std::string_view text) {
    static const std::map<std::string_view, PixelType> kTypes = {
        {"signed char", PixelType::Int8},
        {"int8", PixelType::Int8},
        {"int8_t", PixelType::Int8},
        {"uchar", PixelType::UInt8},
        {"unsigned char", PixelType::UInt8},
        {"uint8", PixelType::UInt8},
        {"uint8_t", PixelType::UInt8},
        {"short", PixelType::Int16},
        {"short int", PixelType::Int16},
        {"signed short", PixelType::Int16},
        {"signed short int", PixelType::Int16},
        {"int16", PixelType::Int16},
        {"int16_t", PixelType::Int16},
        {"ushort", PixelType::UInt16},
        {"unsigned short", PixelType::UInt16},
        {"unsigned short int", PixelType::UInt16},
        {"uint16", PixelType::UInt16},
        {"uint16_t", PixelType::UInt16},
        {"int", PixelType::Int32},
        {"signed int", PixelType::Int32},
        {"int32", PixelType::Int32},
        {"int32_t", PixelType::Int32},
        {"uint", PixelType::UInt32},
        {"unsigned int", PixelType::UInt32},
        {"uint32", PixelType::UInt32},
        {"uint32_t", PixelType::UInt32},
        {"longlong", PixelType::Int64},
        {"long long", PixelType::Int64},
        {"long long int", PixelType::Int64},
        {"signed long long", PixelType::Int64},
        {"signed long long int", PixelType::Int64},
        {"int64", PixelType::Int64},
        {"int64_t", PixelType::Int64},
        {"ulonglong", PixelType::UInt64},
        {"unsigned long long", PixelType::UInt64},
        {"unsigned long long int", PixelType::UInt64},
        {"uint64", PixelType::UInt64},
        {"uint64_t", PixelType::UInt64},
        {"float", PixelType::Float32},
        {"double", PixelType::Float64}};
    const auto it = kTypes.find(lowerCase(text));
    if (it == kTypes.end()) {
        refuse(file, fmt::format("unsupported NRRD type '{}'", printable(text)),
               "convert it to a scalar integer or float type");
    }
    return it->second;
}

Index3 parseSizes(const fs::path& file, const NrrdHeader& header) {
    const auto dimension = parseInteger(header.require(file, "dimension"));
    if (!dimension || *dimension < 1 || *dimension > 16) {
        refuse(file, "its NRRD header is damaged: dimension must be 1 to 16", "repair the header");
    }
    const auto sizes = words(header.require(file, "sizes"));
    if (std::ssize(sizes) != *dimension) {
        refuse(file,
               fmt::format("its NRRD header is damaged: dimension {} but {} sizes", *dimension,
                           sizes.size()),
               "repair the header");
    }
    if (*dimension != 3) {
        refuse(file,
               fmt::format("has {} dimensions (colour, vector components or several "
                           "volumes), must have 3",
                           *dimension),
               "extract one scalar volume first");
    }
    Index3 size{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto extent = parseInteger(sizes[axis]);
        if (!extent) {
            refuse(file,
                   fmt::format("its NRRD header is damaged: size '{}' is no whole number",
                               printable(sizes[axis])),
                   "repair the header");
        }
        size[axis] = *extent;
    }
    return size;
}

void requireDomainAxes(const fs::path& file, const NrrdHeader& header) {
    for (const std::string_view kind : words(header.find("kinds").value_or(""))) {
        const std::string lower = lowerCase(kind);
        if (lower != "domain" && lower != "space" && lower != "???" && lower != "none") {
            refuse(file,
                   fmt::format("an axis is a '{}', not a direction in space (components or "
                               "a list of images)",
                               printable(kind)),
                   "extract one scalar volume first");
        }
    }
}

/// What turns a point of the named space into LPS.
Mat3 spaceToLps(const fs::path& file, std::string_view name) {
    const std::string space = lowerCase(name);
    if (space == "left-posterior-superior" || space == "lps") return Mat3::diagonal(1, 1, 1);
    if (space == "right-anterior-superior" || space == "ras") return Mat3::diagonal(-1, -1, 1);
    if (space == "left-anterior-superior" || space == "las") return Mat3::diagonal(1, -1, 1);
    refuse(file,
           fmt::format("its space '{}' does not say where left and right are", printable(name)),
           "use left-posterior-superior, right-anterior-superior or left-anterior-superior");
}

double millimetresPerUnit(const fs::path& file, std::string_view unitsText) {
    std::string units = lowerCase(unitsText);
    std::erase(units, '"');
    double scale = 0;
    for (const std::string_view unit : words(units)) {
        const double one = unit == "mm" || unit == "millimeter" || unit == "millimeters" ? 1
                           : unit == "m" || unit == "meter" || unit == "meters"          ? 1000
                           : unit == "cm"                                                ? 10
                           : unit == "um" || unit == "micron" || unit == "microns"       ? 0.001
                                                                                         : 0;
        if (one == 0 || (scale != 0 && one != scale)) {
            refuse(file, fmt::format("unknown or mixed space units {}", printable(unitsText)),
                   "use mm");
        }
        scale = one;
    }
    return scale == 0 ? 1 : scale;
}

/// "(1,0,0) (0,1,0) ..." or "none" in place of a vector.
std::vector<Vec3> parseVectors(const fs::path& file, std::string_view field,
                               std::string_view text) {
    std::vector<Vec3> vectors;
    for (text = trimmed(text); !text.empty(); text = trimmed(text)) {
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
            refuse(file,
                   fmt::format("its NRRD header is damaged: {} are not vectors of three "
                               "numbers for each axis",
                               field),
                   "repair the header");
        }
        vectors.push_back(vector);
        text.remove_prefix(close + 1);
    }
    return vectors;
}

ImageGeometry spacedGeometry(const fs::path& file, const NrrdHeader& header, const Index3& size,
                             std::vector<std::string>& warnings) {
    const auto spacings = words(header.find("spacings").value_or("1 1 1"));
    ImageGeometry geometry{size, {}, {}};
    if (spacings.size() != 3) {
        refuse(file, "its NRRD header is damaged: spacings are not three numbers",
               "repair the header");
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto spacing = parseNumber(spacings[axis]);
        if (!spacing || !(*spacing > 0)) {
            refuse(file,
                   fmt::format("voxel spacing '{}' must be a number above zero",
                               printable(spacings[axis])),
                   "repair the header");
        }
        const int a = static_cast<int>(axis);
        geometry.indexToPhysical.column[axis] = {};
        geometry.indexToPhysical.column[axis][a] = *spacing;
    }
    warnings.push_back(
        fmt::format("no space field: orientation and position are unknown; {} "
                    "used along left, posterior, superior",
                    header.find("spacings") ? "the spacings alone were" : "a spacing of 1 mm was"));
    return geometry;
}

ImageGeometry geometryOf(const fs::path& file, const NrrdHeader& header, const Index3& size,
                         std::vector<std::string>& warnings) {
    const auto space = header.find("space");
    if (!space) {
        if (header.find("spacedirections") || header.find("spacedimension")) {
            refuse(file,
                   "it has space directions but no named space, so left and right are "
                   "unknown",
                   "add a 'space' field such as left-posterior-superior");
        }
        return spacedGeometry(file, header, size, warnings);
    }
    const Mat3 toLps = spaceToLps(file, *space);
    const double scale = millimetresPerUnit(file, header.find("spaceunits").value_or(""));
    if (scale != 1) warnings.push_back("space units were turned into mm");

    const auto directions =
        parseVectors(file, "space directions", header.require(file, "spacedirections"));
    if (directions.size() != 3) {
        refuse(file,
               fmt::format("its NRRD header is damaged: {} space directions for 3 axes",
                           directions.size()),
               "repair the header");
    }
    ImageGeometry geometry{size, {}, {}};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        geometry.indexToPhysical.column[axis] = scale * (toLps * directions[axis]);
    }
    if (const auto text = header.find("spaceorigin")) {
        const auto origin = parseVectors(file, "space origin", *text);
        if (origin.size() != 1) {
            refuse(file, "its NRRD header is damaged: space origin is not one vector",
                   "repair the header");
        }
        geometry.originMm = scale * (toLps * origin.front());
    } else {
        warnings.emplace_back("no space origin: the first voxel was put at 0, 0, 0");
    }
    return geometry;
}

std::uint64_t parseSkip(const fs::path& file, const NrrdHeader& header, std::string_view name,
                        bool mayCountFromEnd, bool& countsFromEnd) {
    const auto text = header.find(name);
    if (!text) return 0;
    const auto skip = parseInteger(*text);
    countsFromEnd = mayCountFromEnd && skip && *skip == -1;
    if (!skip || (*skip < 0 && !countsFromEnd)) {
        refuse(file,
               fmt::format("its NRRD header is damaged: {} '{}'",
                           name == "byteskip" ? "byte skip" : "line skip", printable(*text)),
               mayCountFromEnd ? "it must be at least 0, or -1 for raw data at the file's end"
                               : "it must be at least 0");
    }
    return countsFromEnd ? 0 : static_cast<std::uint64_t>(*skip);
}

void requireAsciiNumbers(const fs::path& file, ByteSource& source, std::int64_t count) {
    std::vector<char> piece(std::size_t{1} << 16);
    std::int64_t found = 0;
    bool inNumber = false;
    while (const std::size_t got = source.readSome(piece.data(), piece.size())) {
        for (std::size_t i = 0; i < got; ++i) {
            const bool isBlank =
                piece[i] == ' ' || piece[i] == ',' || (piece[i] >= '\t' && piece[i] <= '\r');
            found += !isBlank && !inNumber;
            inNumber = !isBlank;
        }
    }
    if (found < count) {
        refuse(file, fmt::format("truncated: its data hold {} of {} numbers", found, count),
               "get the whole file");
    }
}

/// Reads through the data once, so that ITK is only given a file that holds every sample.
void requireAllData(const fs::path& file, const NrrdHeader& header, PixelType type,
                    const ImageGeometry& geometry) {
    const auto detached = header.find("datafile");
    const fs::path dataFile = detached ? requireDataFile(file, *detached) : file;
    const std::string encoding = lowerCase(header.require(file, "encoding"));
    const bool isRaw = encoding == "raw";
    const bool isGzip = encoding == "gzip" || encoding == "gz";
    const bool isAscii = encoding == "ascii" || encoding == "text" || encoding == "txt";
    if (!isRaw && !isGzip && !isAscii) {
        refuse(file, fmt::format("unsupported NRRD encoding '{}'", printable(encoding)),
               "save it with encoding raw or gzip");
    }
    if ((isRaw || isGzip) && bytesPerPixel(type) > 1) {
        const std::string endian = lowerCase(header.require(file, "endian"));
        if (endian != "little" && endian != "big") {
            refuse(file, fmt::format("its NRRD header is damaged: endian '{}'", printable(endian)),
                   "it must be little or big");
        }
    }
    bool countsFromEnd = false;
    const std::uint64_t lines = parseSkip(file, header, "lineskip", false, countsFromEnd);
    const std::uint64_t skipped = parseSkip(file, header, "byteskip", isRaw, countsFromEnd);
    if (lines > 0 && !isRaw) {
        refuse(file, "line skip before compressed or ascii data is not supported",
               "save it without line skip");
    }

    const std::uint64_t byteCount = requireImageBytes(file, geometry.size, type);
    const std::uint64_t begin = detached ? 0 : header.byteCount;
    ByteSource source(dataFile, begin,
                      isGzip ? ByteSource::Encoding::Deflate : ByteSource::Encoding::Raw);
    if (isAscii) {
        source.skip(skipped);
        requireAsciiNumbers(file, source, geometry.voxelCount());
    } else if (isRaw) {
        for (std::uint64_t line = 0; line < lines; ++line) source.skipLine();
        source.requireRoomFor(skipped);
        source.skip(skipped);
        source.requireRoomFor(byteCount);
        source.skip(byteCount);
    } else {
        source.requireRoomFor(skipped);
        source.requireRoomFor(byteCount);
        source.skip(skipped);
        source.skip(byteCount);
        source.finish();
    }
}

}  // namespace

bool looksLikeNrrd(std::string_view head) {
    return head.starts_with("NRRD");
}

ReadVolume readNrrd(const fs::path& file) {
    const NrrdHeader header = parseHeader(file);
    const Index3 size = parseSizes(file, header);
    const PixelType type = parseType(file, header.require(file, "type"));
    requireDomainAxes(file, header);
    requireImageBytes(file, size, type);
    std::vector<std::string> warnings;
    const ImageGeometry geometry = geometryOf(file, header, size, warnings);
    requireUsableGeometry(file, geometry);
    requireAllData(file, header, type, geometry);
    return {decodeWithItk(ItkFormat::Nrrd, file, type, geometry), "NRRD", std::move(warnings)};
}

}  // namespace adaptiso::detail
