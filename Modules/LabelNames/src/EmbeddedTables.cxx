// Tables inside label images: 3D Slicer's segments in a NRRD header, and Connectome's LabelTable in
// a NIfTI extension, which TotalSegmentator writes too.
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <memory>
#include <system_error>

#include "Rows.h"
#include "adaptiso/Core/TextLines.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;
using namespace labelnames;

constexpr std::size_t kMostNrrdBytes = std::size_t{1} << 20;
constexpr std::size_t kMostNiftiBytes = std::size_t{16} << 20;

/// The first bytes of a file, unpacked where it is gzip; empty if it can't be read.
std::string readStart(const fs::path& file, std::size_t most) {
    const std::unique_ptr<gzFile_s, decltype(&gzclose)> stream(gzopen(file.c_str(), "rb"),
                                                               &gzclose);
    if (!stream) return {};
    std::string bytes(most, '\0');
    const int read = gzread(stream.get(), bytes.data(), static_cast<unsigned>(most));
    bytes.resize(static_cast<std::size_t>(std::max(read, 0)));
    return bytes;
}

/// A segment of 3D Slicer as "Segment0_Name:=liver" and the like give it.
struct Segment {
    std::string id;
    LabelEntry entry;
    std::optional<std::int64_t> value, layer;
};

/// Blanks for line ends, which NRRD spells "\n".
std::string unescaped(std::string_view text) {
    std::string result;
    for (std::size_t n = 0; n < text.size(); ++n) {
        const bool isEscape = text[n] == '\\' && n + 1 < text.size();
        if (isEscape) ++n;
        result += isEscape && text[n] == 'n' ? ' ' : text[n];
    }
    return result;
}

/// "0.8 0.4 0.3", parts of 1.
std::optional<LabelColor> parseParts(std::string_view text) {
    LabelColor color{};
    for (std::uint8_t& channel : color) {
        text = trimmed(text);
        const std::size_t end = std::min(text.find(' '), text.size());
        const std::optional<double> part = realNumber(text.substr(0, end));
        if (!part || *part < 0 || *part > 1) return std::nullopt;
        channel = static_cast<std::uint8_t>(std::lround(*part * 255));
        text.remove_prefix(end);
    }
    return color;
}

std::map<std::int64_t, Segment> segmentsOf(std::string_view header) {
    constexpr std::string_view kSegment = "Segment";
    std::map<std::int64_t, Segment> segments;
    TextLines lines(header, LineEnds::OfFirst);
    lines.next();  // NRRD's version
    while (const auto whole = lines.next()) {
        const std::string_view line = trimmed(*whole);
        if (line.empty()) break;  // data follow
        const std::size_t colon = line.find(":="), mark = line.find('_');
        if (!line.starts_with(kSegment) || mark > colon || colon == std::string_view::npos)
            continue;
        const auto number = wholeNumber(line.substr(kSegment.size(), mark - kSegment.size()));
        if (!number || *number < 0) continue;
        const std::string_view key = line.substr(mark + 1, colon - mark - 1);
        const std::string value = unescaped(line.substr(colon + 2));
        Segment& segment = segments[*number];
        if (key == "ID") segment.id = value;
        if (key == "Name") segment.entry.name = toUtf8(value);
        if (key == "Color") segment.entry.color = parseParts(value);
        if (key == "LabelValue") segment.value = wholeNumber(value);
        if (key == "Layer") segment.layer = wholeNumber(value);
    }
    return segments;
}

LabelTable decodeSegments(std::string_view header, std::int64_t layer) {
    Collector found("3D Slicer segmentation");
    bool isAny = false;
    for (auto& [number, segment] : segmentsOf(header)) {
        // files of Slicer 4.10 and before name neither: each segment is a layer of its own
        const std::int64_t own = segment.layer.value_or(segment.value ? 0 : number);
        const std::int64_t value = segment.value.value_or(1);
        constexpr std::int64_t kMost = (std::int64_t{1} << 31) - 1;
        if (own != layer || std::abs(value) > kMost) continue;
        LabelEntry entry = segment.entry;
        entry.value = static_cast<std::int32_t>(value);
        if (entry.name.empty()) entry.name = toUtf8(segment.id);
        found.add(std::move(entry));
        isAny = true;
    }
    return isAny ? found.finish() : LabelTable{};
}

template <class T>
T loaded(std::string_view bytes, std::size_t at, bool isSwapped) {
    std::array<char, sizeof(T)> raw{};
    std::memcpy(raw.data(), bytes.data() + at, sizeof(T));
    if (isSwapped) std::ranges::reverse(raw);
    return std::bit_cast<T>(raw);
}

/// GIFTI's LabelTable of a volume: that of its number, or the only one.
LabelTable decodeConnectome(std::string_view extension, std::int64_t volume) {
    constexpr std::string_view kBegin = "<LabelTable", kEnd = "</LabelTable>";
    std::vector<std::string_view> tables;
    for (std::size_t at = extension.find(kBegin); at != std::string_view::npos;
         at = extension.find(kBegin, at + 1)) {
        const std::size_t end = extension.find(kEnd, at);
        if (end == std::string_view::npos) break;
        tables.push_back(extension.substr(at, end + kEnd.size() - at));
    }
    if (tables.empty()) return {};
    const auto place = static_cast<std::size_t>(volume);
    const std::string_view own = place < tables.size() ? tables[place] : tables.front();
    if (own.find("<Label ") == std::string_view::npos) return {};
    LabelTable table = decodeXml("<GIFTI>" + toUtf8(own) + "</GIFTI>");
    table.format = "NIfTI extension";
    return table;
}

LabelTable decodeExtensions(std::string_view bytes, std::int64_t volume) {
    if (bytes.size() < 352) return {};
    const bool isSwapped = bytes[0] == 0 && bytes[1] == 0;
    const bool isSecond = loaded<std::int32_t>(bytes, 0, isSwapped) == 540;
    if (isSecond && bytes.size() < 544) return {};
    const std::size_t header = isSecond ? 540 : 348;
    const auto said = isSecond ? static_cast<double>(loaded<std::int64_t>(bytes, 168, isSwapped))
                               : double{loaded<float>(bytes, 108, isSwapped)};
    std::size_t end = bytes.size();
    if (said > 0 && said < static_cast<double>(end)) end = static_cast<std::size_t>(said);
    if (bytes[header] == 0) return {};
    for (std::size_t at = header + 4; at + 8 <= end;) {
        const auto size = loaded<std::int32_t>(bytes, at, isSwapped);
        if (size < 8 || static_cast<std::size_t>(size) > end - at) return {};
        const std::string_view extension = bytes.substr(at + 8, static_cast<std::size_t>(size) - 8);
        at += static_cast<std::size_t>(size);
        const std::string_view text = extension.substr(0, extension.find('\0'));
        LabelTable table = decodeConnectome(text, volume);
        if (!table.entries.empty()) return table;
    }
    return {};
}

bool isNrrd(std::string_view bytes) {
    return withoutByteOrderMark(bytes).starts_with("NRRD000");
}

bool isNifti(std::string_view bytes) {
    return (bytes.size() >= 348 && bytes.substr(344, 3) == "n+1") ||
           bytes.substr(std::min<std::size_t>(4, bytes.size()), 3) == "n+2";
}

}  // namespace

LabelTable decodeEmbeddedTable(std::string_view bytes, std::int64_t volume) {
    if (isNrrd(bytes)) return decodeSegments(bytes.substr(0, kMostNrrdBytes), volume);
    return isNifti(bytes) ? decodeExtensions(bytes, volume) : LabelTable{};
}

LabelTable readEmbeddedTable(const fs::path& image, std::int64_t volume) {
    std::error_code error;
    if (!fs::is_regular_file(image, error)) return {};
    constexpr std::size_t kMagic = 348;
    const std::string head = readStart(image, kMagic);
    if (isNrrd(head)) {
        return decodeEmbeddedTable(readStart(image, kMostNrrdBytes), volume);
    }
    return isNifti(head) ? decodeEmbeddedTable(readStart(image, kMostNiftiBytes), volume)
                         : LabelTable{};
}

}  // namespace adaptiso
