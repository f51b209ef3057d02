#include <algorithm>
#include <set>

#include "Rows.h"
#include "adaptiso/Core/FoundFiles.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;
using namespace labelnames;

/// The image's name without its ending.
std::string stemOf(const std::string& name) {
    const std::string lower = lowerCase(name);
    for (const std::string_view ending :
         {".nii.gz", ".hdr.gz", ".img.gz", ".seg.nrrd", ".nii", ".hdr", ".img", ".nrrd", ".nhdr",
          ".mha", ".mhd", ".mgh", ".mgz", ".dcm"}) {
        if (lower.size() > ending.size() && lower.ends_with(ending)) {
            return name.substr(0, name.size() - ending.size());
        }
    }
    return name;
}

/// Names that tables of this image go by, the likeliest first.
std::vector<fs::path> ownNames(const fs::path& image) {
    const std::string name = image.filename().string(), stem = stemOf(name);
    std::vector<fs::path> names;
    for (const LabelTableKind& kind : labelTableKinds()) {
        for (const std::string_view ending : kind.endings) {
            // MRIcron's names keep .nii but not .gz
            for (std::string own : {stem, stem + ".nii", name, stem + "_lut", stem + "-lut",
                                    stem + "_LUT", stem + "_labels"}) {
                const fs::path path = image.parent_path() / own.append(ending);
                if (std::ranges::find(names, path) == names.end()) names.push_back(path);
            }
        }
    }
    return names;
}

/// "sub-01", "space-T1w" and, last, "dseg" of "sub-01_space-T1w_dseg".
std::vector<std::string> partsOf(const std::string& stem) {
    std::vector<std::string> parts(1);
    for (const char c : stem) {
        if (c == '_') {
            parts.emplace_back();
        } else {
            parts.back() += c;
        }
    }
    return parts;
}

bool isRootOfDataset(const fs::path& folder) {
    std::error_code error;
    return fs::exists(folder / "dataset_description.json", error);
}

/// The folders from the image's up to the root of its dataset; none when it is in none.
std::vector<fs::path> foldersOfDataset(const fs::path& image) {
    constexpr int kDeepest = 6;  // root/derivatives/x/sub-/ses-/anat
    std::error_code error;
    std::vector<fs::path> folders;
    fs::path folder = fs::absolute(image, error).lexically_normal().parent_path();
    for (int n = 0; n < kDeepest && !error; ++n, folder = folder.parent_path()) {
        folders.push_back(folder);
        if (isRootOfDataset(folder)) return folders;
        if (folder == folder.parent_path()) break;
    }
    return {};
}

/// By BIDS's principle of inheritance: the nearest folder's, of several there the one with the most
/// entities.
std::vector<fs::path> inheritedTables(const fs::path& image, const std::vector<fs::path>& folders) {
    const std::vector<std::string> own = partsOf(stemOf(image.filename().string()));
    const std::set<std::string> entities(own.begin(), own.end());
    std::vector<fs::path> found;
    for (const fs::path& folder : folders) {
        std::vector<std::pair<std::size_t, fs::path>> here;
        std::error_code error;
        fs::directory_iterator entry(folder, error);
        for (const fs::directory_iterator end; !error && entry != end; entry.increment(error)) {
            const fs::path& path = entry->path();
            if (path.extension() != ".tsv") continue;
            const std::vector<std::string> parts = partsOf(path.stem().string());
            const bool isOurs = parts.back() == own.back() &&
                                std::ranges::all_of(parts, [&](const std::string& part) {
                                    return entities.contains(part);
                                });
            if (isOurs) here.emplace_back(parts.size(), path);
        }
        std::ranges::sort(here, [](const auto& a, const auto& b) {
            return a.first != b.first ? a.first > b.first : a.second < b.second;
        });
        for (auto& [count, path] : here) found.push_back(std::move(path));
    }
    return found;
}

bool hasNames(const LabelTable& table) {
    return std::ranges::any_of(table.entries,
                               [](const auto& entry) { return !entry.name.empty(); });
}

/// Adds to `table` what is missing from `more`: colours, or all if `table` is empty.
void addTo(LabelTable& table, LabelTable more) {
    if (table.entries.empty()) {
        table.format = more.format;
        table.entries = std::move(more.entries);
        return;
    }
    if (!hasNames(table) && hasNames(more)) std::swap(table, more);
    for (LabelEntry& entry : table.entries) {
        const LabelEntry* const other = more.find(entry.value);
        if (other != nullptr && !entry.color) entry.color = other->color;
    }
    std::vector<LabelEntry> others;
    for (LabelEntry& entry : more.entries) {
        if (table.find(entry.value) == nullptr) others.push_back(std::move(entry));
    }
    table.entries.insert(table.entries.end(), others.begin(), others.end());
    std::ranges::sort(table.entries, {}, &LabelEntry::value);
}

bool hasAllColors(const LabelTable& table) {
    return std::ranges::all_of(table.entries,
                               [](const auto& entry) { return entry.color.has_value(); });
}

}  // namespace

FoundLabelTables findLabelTables(const fs::path& image, std::int64_t volume) {
    FoundLabelTables found;
    std::vector<Warning> warnings;
    std::vector<fs::path> candidates = ownNames(image);
    const std::vector<fs::path> folders = foldersOfDataset(image);
    const fs::path root = folders.empty() ? image.parent_path() : folders.back();
    for (fs::path& path : inheritedTables(image, folders)) candidates.push_back(std::move(path));
    candidates.push_back(image);
    for (const fs::path& path : candidates) {
        std::error_code error;
        const bool isInside = path == image;
        if (!fs::is_regular_file(path, error) || (!isInside && fs::equivalent(path, image, error)))
            continue;
        try {
            if (!isInside && !liesBeside(path, image)) requireIn(path, root);
            LabelTable table = isInside ? readEmbeddedTable(image, volume) : readLabelTable(path);
            if (table.entries.empty()) continue;
            const bool isUseful = hasNames(table)
                                      ? !hasNames(found.table)
                                      : found.table.entries.empty() || !hasAllColors(found.table);
            if (!isUseful) continue;
            addWarnings(warnings, table.warnings, path.filename().string());
            addTo(found.table, std::move(table));
            found.files.push_back(path);
        } catch (const NoLabelTable&) {
            // something else of that name
        } catch (const FileError& fault) {
            // the file's own name, without folders: reports may be passed on
            const std::string said = fault.what(), whole = path.string();
            warnings.push_back(
                {"names-not-used",
                 "its names are not used: " +
                     (said.starts_with(whole) ? path.filename().string() + said.substr(whole.size())
                                              : said)});
        }
        if (hasNames(found.table) && hasAllColors(found.table)) break;
    }
    found.table.warnings = std::move(warnings);
    return found;
}

}  // namespace adaptiso
