#include "adaptiso/LabelNames/LabelTable.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <new>

#include "Rows.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/Core/TextLines.h"

namespace adaptiso {
namespace labelnames {

// each at the end of its own .cxx
extern const TableCodec kDelimitedTables, kRowTables, kJsonTables, kXmlTables;

}  // namespace labelnames

namespace {

using namespace labelnames;

constexpr std::size_t kLutBytes = 768;
constexpr std::uintmax_t kMostBytes = std::uintmax_t{64} << 20;

bool isText(std::string_view bytes) {
    return std::ranges::none_of(bytes, [](unsigned char c) {
        return (c < 0x20 && c != '\t' && c != '\n' && c != '\r' && c != '\f' && c != '\v') ||
               c == 0x7f;
    });
}

/// Reds, greens and blues of 0 to 255. MRIcron's own atlases have black where they have no colour.
LabelTable decodeLut(const TableFile& file) {
    LabelTable table;
    table.format = "MRIcron colours";
    for (std::int32_t value = 0; value < 256; ++value) {
        LabelColor color{};
        for (std::size_t n = 0; n < 3; ++n) {
            color[n] =
                static_cast<std::uint8_t>(file.bytes[256 * n + static_cast<std::size_t>(value)]);
        }
        if (color == LabelColor{}) continue;
        LabelEntry& entry = table.entries.emplace_back();
        entry.value = value;
        entry.color = color;
    }
    if (table.entries.empty()) refuseKind("its 768 bytes are all black");
    return table;
}

bool isLut(const TableFile& file) {
    return file.bytes.size() == kLutBytes && file.text.empty();
}

constexpr TableCodec kLutTables{isLut, decodeLut};

const LabelTableKind kKinds[] = {
    {"BIDS, CAT12, TotalSegmentator",
     {".tsv"},
     &kDelimitedTables,
     "tabs, semicolons or commas, a header with `index` and `name` (or `ROIid`, `ROIname`, "
     "`Label`, ...); `abbreviation` and `color` where there are: `#ff8000`, `#f80`, `rgb(255, 128, "
     "0)`, `red`"},
    {"FreeSurfer, MRtrix",
     {".txt"},
     &kRowTables,
     "rows of index, name, R G B A; FreeSurfer's type of tissue behind these, MRtrix's "
     "abbreviation (`L.BSTS`) before the name"},
    {"FSLeyes", {}, &kRowTables, "rows of index, R G B (0 to 1, or to 255), name"},
    {"Connectome Workbench", {}, &kRowTables, "a line with the name, one with index, R G B A"},
    {"ITK-SNAP", {}, &kRowTables, "rows of index, R G B A, two flags, the name in quotes"},
    {"3D Slicer",
     {".ctbl", ".csv"},
     &kRowTables,
     "rows as FreeSurfer's under `# Color table file`, `_` for blanks; or a header with "
     "LabelValue, Name, Color_R, ..."},
    {"JSON",
     {".json"},
     &kJsonTables,
     "names or objects by value, a list of objects, or a colour map of niivue"},
    {"FSL",
     {".xml"},
     &kXmlTables,
     "an atlas in XML; of a probabilistic one label n is the value n + 1"},
    {"GIFTI", {".label.gii"}, &kXmlTables, "the label table of a `.gii`"},
    {"AAL", {}, &kRowTables, "rows of abbreviation, name and index"},
    {"MRIcron", {}, &kRowTables, "rows of index and name, with or without a code"},
    {"MRIcron's colours",
     {".lut"},
     &kLutTables,
     "768 bytes: the reds, greens and blues of the values 0 to 255, no names; black is no colour"},
};

LabelTable decode(std::string_view bytes) {
    if (bytes.empty()) refuseKind("it is empty");
    TableFile file{bytes, {}, 0};
    if (isText(bytes)) {
        file.text = toUtf8(withoutByteOrderMark(bytes));
        const std::string_view start = trimmed(std::string_view(file.text).substr(0, 4096));
        if (start.empty()) refuseKind("it holds nothing but blanks");
        file.first = start.front();
    }
    for (const LabelTableKind& kind : kKinds) {
        const auto recognizes = kind.codec->recognizes;
        if (recognizes != nullptr && recognizes(file)) return kind.codec->decode(file);
    }
    if (file.first != 0) return kRowTables.decode(file);
    if (isUtf16(bytes)) throw FileError(faultOfText(bytes));
    refuseKind("it is no text");
}

}  // namespace

std::span<const LabelTableKind> labelTableKinds() {
    return kKinds;
}

std::string labelTableNames() {
    return joined(kKinds, [](const LabelTableKind& kind) { return kind.name; });
}

const LabelEntry* LabelTable::find(std::int64_t value) const {
    const auto at = std::ranges::lower_bound(entries, value, {}, &LabelEntry::value);
    return at != entries.end() && at->value == value ? &*at : nullptr;
}

LabelTable decodeLabelTable(std::string_view bytes, std::string_view name) {
    const std::string prefix = std::string(name) + ": ";
    try {
        return decode(bytes);
    } catch (const NoLabelTable& error) {
        throw NoLabelTable(prefix + error.what());
    } catch (const FileError& error) {
        throw FileError(prefix + error.what());
    } catch (const std::bad_alloc&) {
        throw FileError(prefix + "the table does not fit into memory");
    }
}

LabelTable readLabelTable(const std::filesystem::path& file) {
    namespace fs = std::filesystem;
    std::error_code error;
    const fs::file_status status = fs::status(file, error);
    if (!fs::exists(status)) throw FileError(file.string() + ": no such file; check the name");
    if (!fs::is_regular_file(status)) {
        throw FileError(file.string() + ": not a regular file; give a file on disk");
    }
    const std::uintmax_t size = fs::file_size(file, error);
    if (!error && size > kMostBytes) {
        throw NoLabelTable(file.string() + ": is no table of labels: it has " +
                           std::to_string(size) + " bytes, must be 64 MiB or less");
    }
    errno = 0;
    std::ifstream stream(file, std::ios::binary);
    std::string bytes(error ? 0 : size, '\0');
    stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    if (error || !stream || static_cast<std::uintmax_t>(stream.gcount()) != size) {
        throw FileError(file.string() + ": can't be read (" +
                        (errno != 0 ? std::strerror(errno) : "unknown reason") + ")");
    }
    return decodeLabelTable(bytes, file.string());
}

LabelColor labelColor(std::int32_t value) {
    // hues a golden angle apart are far from those of the values near; brightness and strength take
    // turns, so that the next nearest hues differ as well
    constexpr double kGolden = 0.6180339887498949;
    const auto n = static_cast<std::uint32_t>(value);
    const double turn = kGolden * n - std::floor(kGolden * n);
    const double bright = n % 3 == 0 ? 0.95 : n % 3 == 1 ? 0.8 : 0.65;
    const double strength = n % 2 == 0 ? 0.75 : 0.5;
    LabelColor color{};
    for (std::size_t channel = 0; channel < 3; ++channel) {
        // a channel is full for a third of the circle, gone for another, and ramps between
        const double at = turn + (3.0 - static_cast<double>(channel)) / 3;
        const double away = std::abs(6 * (at - std::floor(at)) - 3);
        const double part = std::clamp(away - 1, 0.0, 1.0);
        color[channel] =
            static_cast<std::uint8_t>(std::lround(255 * bright * (1 - strength * (1 - part))));
    }
    return color;
}

namespace {

/// Squared distance of colours as eyes have it, roughly ("redmean"): 9 * 255^2 of black and white.
double apartness(const LabelColor& a, const LabelColor& b) {
    const double red = (a[0] + b[0]) / 2.0;
    const auto square = [&](std::size_t channel) {
        const double step = a[channel] - b[channel];
        return step * step;
    };
    return (2 + red / 256) * square(0) + 4 * square(1) + (2 + (255 - red) / 256) * square(2);
}

}  // namespace

std::vector<LabelColor> labelColors(std::span<const std::int32_t> labels,
                                    std::span<const std::optional<LabelColor>> given) {
    constexpr std::size_t kMostKeptApart = 64;
    constexpr std::uint32_t kCandidates = 256;
    constexpr double kAlike = 127.5 * 127.5;  // a sixth of the way from black to white
    std::vector<LabelColor> colors;
    std::vector<LabelColor> taken;
    for (const auto& color : given) {
        if (color) taken.push_back(*color);
    }
    const auto nearest = [&](const LabelColor& color) {
        double least = std::numeric_limits<double>::infinity();
        for (const LabelColor& other : taken) least = std::min(least, apartness(color, other));
        return least;
    };
    for (std::size_t n = 0; n < labels.size(); ++n) {
        colors.push_back(given[n].value_or(labelColor(labels[n])));
        if (given[n] || labels.size() > kMostKeptApart) continue;
        double farthest = nearest(colors.back());
        for (std::uint32_t k = 1; k <= kCandidates && nearest(colors.back()) < kAlike; ++k) {
            const LabelColor other =
                labelColor(static_cast<std::int32_t>(static_cast<std::uint32_t>(labels[n]) + k));
            if (const double far = nearest(other); far > farthest) {
                farthest = far;
                colors.back() = other;
            }
        }
        taken.push_back(colors.back());
    }
    return colors;
}

std::string hexText(const LabelColor& color) {
    constexpr char kDigits[] = "0123456789abcdef";
    std::string text = "#";
    for (const std::uint8_t channel : color) {
        text += kDigits[channel >> 4];
        text += kDigits[channel & 15];
    }
    return text;
}

}  // namespace adaptiso
