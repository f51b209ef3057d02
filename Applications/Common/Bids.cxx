#include "Common/Bids.h"

#include <fnmatch.h>

#include <algorithm>
#include <fstream>
#include <span>
#include <sstream>
#include <system_error>

#include "Common/CommonOptions.h"
#include "adaptiso/MeshIO/Formats.h"

namespace adaptiso {

const BidsImages kBidsScans{"T1w", "T1w image"};
const BidsImages kBidsSegmentations{"dseg", "label map (*_dseg.nii.gz)"};

namespace {

namespace fs = std::filesystem;

constexpr const char* kDescription = "dataset_description.json";
constexpr const char* kSurface = "surface";

/// By name, so that the order is the same on every file system.
std::vector<fs::path> sorted(std::vector<fs::path> paths) {
    std::sort(paths.begin(), paths.end());
    return paths;
}

std::vector<fs::path> foldersIn(const fs::path& folder, const std::string& prefix) {
    std::vector<fs::path> found;
    std::error_code error;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
        if (entry.is_directory() && entry.path().filename().string().starts_with(prefix)) {
            found.push_back(entry.path());
        }
    }
    return sorted(found);
}

/// "sub-01" of "01" and of "sub-01".
std::string withPrefix(const std::string& label, const std::string& prefix) {
    return label.starts_with(prefix) ? label : prefix + label;
}

void requireFound(const std::vector<BatchItem>& items, std::size_t before, const fs::path& where,
                  const std::string& what) {
    if (items.size() == before) throw InvalidInput("--bids: no " + what + " in " + where.string());
}

/// Parts of `path` that are not empty.
std::vector<std::string> partsOf(const std::string& path) {
    std::vector<std::string> parts;
    std::istringstream stream(path);
    for (std::string part; std::getline(stream, part, '/');) {
        if (!part.empty()) parts.push_back(part);
    }
    return parts;
}

/// Whether the path, or a folder above it, matches; "**" stands for any number of folders.
bool fits(std::span<const std::string> pattern, std::span<const std::string> path) {
    if (pattern.empty()) return true;
    if (pattern[0] == "**" && fits(pattern.subspan(1), path)) return true;
    if (path.empty()) return false;
    if (pattern[0] == "**") return fits(pattern, path.subspan(1));
    return fnmatch(pattern[0].c_str(), path[0].c_str(), 0) == 0 &&
           fits(pattern.subspan(1), path.subspan(1));
}

/// The paths that .bidsignore of a dataset excludes, by the rules of .gitignore.
class BidsIgnore {
public:
    explicit BidsIgnore(const fs::path& root) : root_(root) {
        std::ifstream file(root / ".bidsignore");
        for (std::string line; std::getline(file, line);) {
            while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
            if (line.empty() || line[0] == '#') continue;
            Rule rule{{}, line[0] == '!'};
            if (rule.isException) line.erase(0, 1);
            const std::size_t slash = line.find('/');
            rule.pattern = partsOf(line);
            // without a slash, except at its end, it is a name anywhere
            if (slash == std::string::npos || slash + 1 == line.size()) {
                rule.pattern.insert(rule.pattern.begin(), "**");
            }
            rules_.push_back(std::move(rule));
        }
    }
    /// \param path  in the dataset, begun as its root is
    bool contains(const fs::path& path) const {
        const std::vector<std::string> parts =
            partsOf(path.lexically_relative(root_).generic_string());
        bool isIgnored = false;
        for (const Rule& rule : rules_) {
            if (fits(rule.pattern, parts)) isIgnored = !rule.isException;
        }
        return isIgnored;
    }

private:
    struct Rule {
        std::vector<std::string> pattern;  ///< by folders
        bool isException = false;          ///< "!"
    };
    fs::path root_;
    std::vector<Rule> rules_;
};

void addImages(const fs::path& folder, const fs::path& target, const BidsImages& images,
               const BidsIgnore& ignored, std::vector<BatchItem>& items) {
    std::vector<fs::path> files;
    std::error_code error;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder / "anat", error)) {
        files.push_back(entry.path());
    }
    for (const fs::path& file : sorted(files)) {
        const std::string name = file.filename().string();
        for (const char* const type : {".nii", ".nii.gz"}) {
            const std::string ending = "_" + images.suffix + type;
            if (!name.ends_with(ending) || name.starts_with(".") || ignored.contains(file))
                continue;
            BatchItem item{name.substr(0, name.size() - ending.size()), {file}, target / "anat"};
            if (!items.empty() && items.back().name == item.name &&
                items.back().folder == item.folder) {
                items.back().fault =
                    "lies beside " + name + ", another image of its name; keep one";
            } else {
                items.push_back(std::move(item));
            }
        }
    }
}

bool isSurface(const fs::path& file) {
    if (file.filename().string().starts_with(".")) return false;
    try {
        findMeshFormat(file);
        return true;
    } catch (const InvalidInput&) {
        return false;
    }
}

std::vector<BatchItem> findImages(const fs::path& root,
                                  const std::vector<std::string>& participants,
                                  const fs::path& derivatives, const BidsImages& images) {
    std::vector<BatchItem> items;
    for (const fs::path& subject : bidsSubjects(root, root, participants, "--participant")) {
        const std::size_t before = items.size();
        for (BatchItem& item :
             bidsImagesOf(subject, {}, derivatives / subject.filename(), images)) {
            items.push_back(std::move(item));
        }
        if (!participants.empty()) requireFound(items, before, subject, images.what);
    }
    requireFound(items, 0, root, images.what);
    return items;
}

/// An entry of SourceDatasets, with the dataset's DOI if it states one.
Json sourceOf(const fs::path& root) {
    std::ifstream file(root / kDescription);
    const Json said = Json::parse(file, nullptr, false);
    Json source{{"URL", "bids:raw:"}};
    if (!said.is_object() || !said.contains("DatasetDOI")) return source;
    std::string doi = said["DatasetDOI"].is_string() ? said["DatasetDOI"].get<std::string>() : "";
    if (doi.starts_with("doi:")) doi.erase(0, 4);
    if (doi.empty()) return source;
    source["DOI"] = doi;
    source["URL"] = doi.starts_with("http") ? doi : "https://doi.org/" + doi;
    return source;
}

}  // namespace

std::optional<std::set<std::string>> listedParticipants(const fs::path& root) {
    std::ifstream file(root / "participants.tsv");
    std::string line;
    if (!std::getline(file, line)) return std::nullopt;
    if (line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
    const auto cells = [](std::string row) {
        if (row.ends_with('\r')) row.pop_back();
        std::vector<std::string> found;
        std::istringstream stream(row);
        for (std::string cell; std::getline(stream, cell, '\t');) found.push_back(cell);
        return found;
    };
    const std::vector<std::string> header = cells(line);
    const auto column = std::ranges::find(header, "participant_id") - header.begin();
    if (column == std::ssize(header)) return std::nullopt;
    std::set<std::string> listed;
    while (std::getline(file, line)) {
        const std::vector<std::string> row = cells(line);
        if (column < std::ssize(row)) {
            listed.insert(withPrefix(row[static_cast<std::size_t>(column)], "sub-"));
        }
    }
    return listed;
}

std::vector<fs::path> bidsSubjects(const fs::path& root, const fs::path& within,
                                   const std::vector<std::string>& participants,
                                   const std::string& option) {
    if (!fs::exists(root / kDescription)) {
        throw InvalidInput((option == "--participant" ? "--bids " : "") + root.string() +
                           ": is no BIDS dataset, it has no " + kDescription);
    }
    if (participants.empty()) {
        std::vector<fs::path> found = foldersIn(within, "sub-");
        const BidsIgnore ignored(within);
        std::erase_if(found, [&](const fs::path& folder) { return ignored.contains(folder); });
        return found;
    }
    std::vector<fs::path> folders;
    for (const std::string& label : participants) {
        const std::string name = withPrefix(label, "sub-");
        if (name.find('/') != std::string::npos || !fs::is_directory(within / name)) {
            throw InvalidInput(option + " " + label + ": there is no folder " + name + " in " +
                               within.string());
        }
        folders.push_back(within / name);
    }
    return folders;
}

std::vector<BatchItem> bidsImagesOf(const fs::path& subject,
                                    const std::vector<std::string>& sessions,
                                    const fs::path& target, const BidsImages& images) {
    std::vector<BatchItem> items;
    const BidsIgnore ignored(subject.parent_path());
    if (sessions.empty()) addImages(subject, target, images, ignored, items);
    for (const fs::path& session : foldersIn(subject, "ses-")) {
        const std::string name = session.filename().string();
        const bool isAsked = sessions.empty() ||
                             std::any_of(sessions.begin(), sessions.end(), [&](const auto& label) {
                                 return withPrefix(label, "ses-") == name;
                             });
        if (isAsked) addImages(session, target / name, images, ignored, items);
    }
    return items;
}

std::vector<BatchItem> findBidsScans(const fs::path& root,
                                     const std::vector<std::string>& participants,
                                     const fs::path& derivatives) {
    return findImages(root, participants, derivatives, kBidsScans);
}

std::vector<BatchItem> findBidsSegmentations(const fs::path& root,
                                             const std::vector<std::string>& participants,
                                             const fs::path& derivatives) {
    return findImages(root, participants, derivatives, kBidsSegmentations);
}

std::vector<BatchItem> findBidsSurfaces(const fs::path& root,
                                        const std::vector<std::string>& participants,
                                        const fs::path& derivatives) {
    std::vector<BatchItem> items;
    for (const fs::path& subject : bidsSubjects(root, derivatives, participants, "--participant")) {
        std::vector<fs::path> files;
        for (const fs::directory_entry& entry : fs::recursive_directory_iterator(subject)) {
            if (entry.is_regular_file() && isSurface(entry.path())) files.push_back(entry.path());
        }
        if (!participants.empty() && files.empty())
            requireFound(items, items.size(), subject, kSurface);
        for (const fs::path& file : sorted(files)) {
            items.push_back({file.filename().string(), {file}, file.parent_path()});
        }
    }
    requireFound(items, 0, derivatives, kSurface);
    return items;
}

std::string bidsLabel(std::string_view number) {
    std::string label;
    for (const char c : number) {
        if (c == '+') continue;  // of an exponent, which has a sign in any case
        label += c == '.' ? 'p' : c == '-' ? 'm' : c;
    }
    return label;
}

Json bidsDescription(const fs::path& root, const fs::path& derivatives,
                     const std::string& program) {
    std::error_code error;
    const fs::path link = fs::proximate(root, derivatives, error);
    Json maker{{"Name", program}, {"Version", programVersion()}};
    if (constexpr std::string_view home = ADAPTISO_HOMEPAGE; !home.empty()) maker["CodeURL"] = home;
    return {{"Name", "adaptiso"},
            {"BIDSVersion", "1.8.0"},
            {"DatasetType", "derivative"},
            {"GeneratedBy", Json::array({maker})},
            {"SourceDatasets", {sourceOf(root)}},
            {"DatasetLinks", {{"raw", link.generic_string()}}}};
}

void makeDerivatives(const fs::path& root, const fs::path& derivatives,
                     const std::string& program) {
    makeFolders(derivatives);
    if (fs::exists(derivatives / kDescription)) return;
    writeWhole(derivatives / kDescription,
               jsonText(bidsDescription(root, derivatives, program)) + "\n");
}

}  // namespace adaptiso
