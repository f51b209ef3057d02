#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include "adaptiso/Core/FoundFiles.h"
#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/ImageIO/ImageNames.h"
#include "adaptiso/ImageIO/ListSeries.h"
#include "adaptiso/LabelPipeline/Masks.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

bool isHidden(const fs::path& path) {
    return path.filename().native().starts_with('.');
}

/// The samples of an Analyze or NIfTI pair, which its .hdr stands for.
bool isHalfOfPair(const fs::path& file) {
    const std::string name = file.string(), lower = lowerCase(name);
    std::error_code ignored;
    for (const std::string_view ending : {".img", ".img.gz"}) {
        if (!lower.ends_with(ending)) continue;
        const std::string stem = name.substr(0, name.size() - ending.size());
        if (fs::exists(stem + ".hdr", ignored) || fs::exists(stem + ".hdr.gz", ignored))
            return true;
    }
    return false;
}

/// \return empty for a link out of `folder` and for what is no image
std::string_view formatOf(const fs::path& file, const fs::path& folder) {
    return liesIn(file, folder) ? recognizeImage(file) : std::string_view();
}

/// The images at the top of a folder, by path; none if it can't be listed.
std::vector<fs::path> imagesOf(const fs::path& folder) {
    std::vector<fs::path> images;
    std::error_code error, ignored;
    fs::directory_iterator entry(folder, error);
    for (const fs::directory_iterator end; !error && entry != end; entry.increment(error)) {
        const fs::path& path = entry->path();
        if (isHidden(path) || entry->is_directory(ignored)) continue;
        // one that is named as an image and can't be read is refused, not left out
        const bool isImage = !imageExtension(path).empty() || !formatOf(path, folder).empty();
        if (isImage && !isHalfOfPair(path)) images.push_back(path);
    }
    std::ranges::sort(images);
    return images;
}

/// A folder of more files than that is taken for DICOM's, whose reader refuses it.
constexpr std::int64_t kMostEntries = 200'000;

/// A folder, or one below it, holds a DICOM file, recognised by content.
bool holdsDicom(const fs::path& folder) {
    std::int64_t entries = 0;
    std::error_code error, ignored;
    fs::recursive_directory_iterator entry(folder, error);
    for (const fs::recursive_directory_iterator end; !error && entry != end;
         entry.increment(error)) {
        if (++entries > kMostEntries) return true;
        const fs::path& path = entry->path();
        if (entry->is_directory(ignored)) {
            if (isHidden(path)) entry.disable_recursion_pending();
        } else if (formatOf(path, folder) == "DICOM") {
            return true;
        }
    }
    return false;
}

std::string nameOf(const std::string& name, Label label) {
    const std::string shown = withoutControls(toUtf8(name));
    return shown.empty() ? "segment " + std::to_string(label) : shown;
}

/// Those of a DICOM segmentation, by their numbers.
std::vector<MaskSource> segmentsOf(const fs::path& input, const ReadOptions& read) {
    std::vector<MaskSource> masks;
    const std::string file = input.string();
    for (const DicomSeries& series : listSeries(input).series) {
        if (!series.segment) continue;
        const auto label = static_cast<Label>(*series.segment);
        if (!series.isReadable()) throw FileError(file + ": " + series.fault);
        if (std::ranges::count(masks, label, &MaskSource::label) > 0) {
            throw InvalidInput(file + ": holds several segmentations; give the file of one");
        }
        masks.push_back({input, nameOf(series.segmentLabel, label), label});
        masks.back().read = read;
        masks.back().read.series = std::to_string(series.number);
    }
    if (masks.empty()) throw InvalidInput(file + ": holds no segment; leave --segments out");
    std::ranges::sort(masks, {}, &MaskSource::label);
    return masks;
}

/// Those of a .seg.nrrd, numbered from 1 layer by layer. None of one with a single layer, which is
/// a map.
std::vector<MaskSource> layersOf(const fs::path& input, const ReadOptions& read) {
    std::vector<MaskSource> masks;
    std::int64_t layers = 1;
    try {
        readVolume(input, read);
    } catch (const ChoiceNeeded& choice) {
        layers = choice.count();
    }
    for (std::int64_t layer = 0; layers > 1 && layer < layers; ++layer) {
        for (const LabelEntry& entry : readEmbeddedTable(input, layer).entries) {
            const auto label = static_cast<Label>(masks.size() + 1);
            masks.push_back({input, nameOf(entry.name, label), label, entry.color});
            masks.back().read = read;
            masks.back().read.volumeIndex = layer;
            masks.back().value = entry.value;
        }
    }
    if (layers > 1 && masks.empty()) {
        throw InvalidInput(input.string() + ": names no segment; choose a volume (--volume-index)");
    }
    return masks;
}

/// The row of a name; case counts only where two differ by it.
const LabelEntry* findName(const LabelTable& table, const std::string& name) {
    const auto find = [&](const auto& isSame) -> const LabelEntry* {
        const auto at = std::ranges::find_if(table.entries, [&](const LabelEntry& entry) {
            return entry.value != 0 && isSame(entry.name);
        });
        return at == table.entries.end() ? nullptr : &*at;
    };
    if (const LabelEntry* const same = find([&](auto& other) { return other == name; }))
        return same;
    return find([&](auto& other) { return lowerCase(other) == lowerCase(name); });
}

}  // namespace

std::vector<MaskSource> masksOfFiles(const std::vector<fs::path>& files, const ReadOptions& read) {
    std::vector<MaskSource> masks;
    for (const fs::path& file : files) {
        masks.push_back({file, withoutControls(toUtf8(inputStem(file)))});
        masks.back().read = read;
    }
    std::ranges::stable_sort(masks, {}, &MaskSource::name);
    const auto twin = std::ranges::adjacent_find(masks, {}, &MaskSource::name);
    if (twin != masks.end()) {
        throw InvalidInput(twin[0].file.string() + " and " + twin[1].file.filename().string() +
                           ": are two masks of one name, " + twin->name +
                           "; rename one, or move it away");
    }
    Label number = 0;
    for (MaskSource& mask : masks) mask.label = ++number;
    return masks;
}

std::vector<MaskSource> masksOfFolder(const fs::path& folder, const ReadOptions& read) {
    std::error_code error;
    if (!fs::is_directory(folder, error) || recognizeImage(folder) == "Zarr") return {};
    const std::vector<fs::path> files = imagesOf(folder);
    if (files.empty() || holdsDicom(folder)) return {};
    for (const fs::path& file : files) {
        if (fs::is_symlink(file, error)) requireIn(file, folder);
    }
    return masksOfFiles(files, read);
}

std::vector<MaskSource> masksOfSegments(const fs::path& file, const ReadOptions& read) {
    return recognizeImage(file) == "DICOM" ? segmentsOf(file, read) : layersOf(file, read);
}

std::vector<Warning> numberByTable(std::vector<MaskSource>& masks, const LabelTable& table,
                                   const std::string& file) {
    std::set<Label> taken;
    std::vector<std::string> unnamed;
    Label last = 0;
    for (const LabelEntry& entry : table.entries) {
        if (std::in_range<Label>(entry.value))
            last = std::max(last, static_cast<Label>(entry.value));
    }
    for (MaskSource& mask : masks) {
        const LabelEntry* const entry = findName(table, mask.name);
        const bool isLabel = entry != nullptr && std::in_range<Label>(entry->value);
        if (isLabel && taken.insert(static_cast<Label>(entry->value)).second) {
            mask.label = static_cast<Label>(entry->value);
            mask.color = entry->color;
        } else {
            mask.label = ++last;
            unnamed.push_back(mask.name);
        }
    }
    std::ranges::sort(masks, {}, &MaskSource::label);
    if (unnamed.empty()) return {};
    constexpr std::size_t kMost = 5;
    const std::size_t count = unnamed.size();
    if (count > kMost) unnamed.resize(kMost);
    return {{"label-nameless",
             "has no row for " + counted(static_cast<std::int64_t>(count), "mask") + ": " +
                 joined(unnamed) + (count > kMost ? ", ..." : "") + "; numbered behind its rows",
             file}};
}

}  // namespace adaptiso
