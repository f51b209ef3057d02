#include "Dataset.h"

#include <fnmatch.h>

#include <algorithm>
#include <cctype>
#include <optional>
#include <set>
#include <span>
#include <sstream>
#include <system_error>

#include "Common/CommonOptions.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/FoundFiles.h"
#include "adaptiso/Core/ParseJson.h"

namespace adaptiso::bids {

const BidsImages kBidsScans{"T1w", "T1w image"};
const BidsImages kBidsSegmentations{"dseg", "label map (*_dseg.nii.gz)"};

namespace {

namespace fs = std::filesystem;

constexpr const char* kDescription = "dataset_description.json";

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

std::vector<std::string> splitAt(const std::string& text, char separator) {
    std::vector<std::string> parts;
    for (std::size_t begin = 0, end = 0; end != std::string::npos; begin = end + 1) {
        end = text.find(separator, begin);
        parts.push_back(text.substr(begin, end == std::string::npos ? end : end - begin));
    }
    return parts;
}

/// Parts of `path` that are not empty.
std::vector<std::string> partsOf(const std::string& path) {
    std::vector<std::string> parts = splitAt(path, '/');
    std::erase(parts, "");
    return parts;
}

/// Matches the path or a folder above it; "**" stands for any number of folders.
/// \pre no "**" follows another, so that the parts of `path` bound the depth and the ways to try
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
        std::istringstream file(readFoundFile(root / ".bidsignore", root).value_or(""));
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
            const auto isBoth = [](const std::string& a, const std::string& b) {
                return a == "**" && b == "**";
            };
            const auto repeats = std::ranges::unique(rule.pattern, isBoth);
            rule.pattern.erase(repeats.begin(), repeats.end());
            rules_.push_back(std::move(rule));
        }
    }
    const fs::path& root() const { return root_; }
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
            if (fs::exists(file, error) && !liesIn(file, ignored.root())) {
                item.fault =
                    "is, or lies behind, a link to outside of its dataset; put the file "
                    "itself there";
            }
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

/// participant_id in participants.tsv ("sub-01"); empty if there is no such table.
std::optional<std::set<std::string>> listedParticipants(const fs::path& root) {
    std::istringstream file(readFoundFile(root / "participants.tsv", root).value_or(""));
    std::string line;
    if (!std::getline(file, line)) return std::nullopt;
    if (line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
    const auto cells = [](std::string row) {
        if (row.ends_with('\r')) row.pop_back();
        return splitAt(row, '\t');
    };
    const std::vector<std::string> header = cells(line);
    const auto column = std::ranges::find(header, "participant_id") - header.begin();
    if (column == std::ssize(header)) return std::nullopt;
    std::set<std::string> listed;
    while (std::getline(file, line)) {
        const std::vector<std::string> row = cells(line);
        if (column >= std::ssize(row)) continue;
        const std::string& id = row[static_cast<std::size_t>(column)];
        if (!id.empty()) listed.insert(withPrefix(id, "sub-"));
    }
    return listed;
}

/// The folders sub-* of `participants`, labels with or without "sub-"; empty: all.
/// \throws InvalidInput  `root` is no BIDS dataset, or there is no such participant
std::vector<fs::path> subjectsOf(const fs::path& root,
                                 const std::vector<std::string>& participants) {
    if (!fs::exists(root / kDescription)) {
        throw InvalidInput(root.string() + ": is no BIDS dataset, it has no " + kDescription);
    }
    if (participants.empty()) {
        std::vector<fs::path> found = foldersIn(root, "sub-");
        const BidsIgnore ignored(root);
        std::erase_if(found, [&](const fs::path& folder) { return ignored.contains(folder); });
        return found;
    }
    std::vector<fs::path> folders;
    for (const std::string& label : participants) {
        const std::string name = withPrefix(label, "sub-");
        if (name.find('/') != std::string::npos || !fs::is_directory(root / name)) {
            throw InvalidInput("--participant-label " + label + ": there is no folder " + name +
                               " in " + root.string());
        }
        folders.push_back(root / name);
    }
    return folders;
}

bool isLabel(std::string_view text) {
    return !text.empty() && std::all_of(text.begin(), text.end(),
                                        [](unsigned char c) { return std::isalnum(c) != 0; });
}

void requireDescription(const fs::path& root) {
    const auto said = parseJson<Json>(readFoundFile(root / kDescription, root).value_or(""));
    for (const char* const key : {"Name", "BIDSVersion"}) {
        if (said.is_object() && said.contains(key) && said[key].is_string()) continue;
        throw InvalidInput(root.string() +
                           ": is no valid BIDS dataset: dataset_description.json has no " + key +
                           "; add it, or give --skip-bids-validation");
    }
}

/// Checks "sub-01_ses-2_acq-hi" in the folder sub-01/ses-2.
void checkName(const std::string& name, const std::string& begin,
               std::vector<std::string>& faults) {
    if (name != begin && !name.starts_with(begin + "_")) {
        faults.push_back(name + ": lies in the folder of " + begin);
    }
    for (const std::string& part : splitAt(name, '_')) {
        const std::vector<std::string> pair = splitAt(part, '-');
        if (pair.size() == 2 && isLabel(pair[0]) && isLabel(pair[1])) continue;
        faults.push_back(name + ": '" + part +
                         "' is no entity of BIDS (key-value, letters and "
                         "digits)");
    }
}

void checkSubject(const fs::path& subject, std::vector<std::string>& faults) {
    const std::string name = subject.filename().string();
    if (!isLabel(name.substr(std::min<std::size_t>(name.size(), 4)))) {
        faults.push_back(name + ": its label has more than letters and digits");
        return;
    }
    for (const BidsImages* images : {&kBidsScans, &kBidsSegmentations}) {
        for (const BatchItem& item : bidsImagesOf(subject, {}, subject, *images)) {
            const fs::path session = item.inputs.front().parent_path().parent_path().filename();
            checkName(item.name, session == name ? name : name + "_" + session.string(), faults);
        }
    }
}

/// Warns where participants.tsv and the folders differ.
void warnOfList(const BidsOptions& options, ChosenSubjects& chosen) {
    const auto listed = listedParticipants(options.dataset);
    if (!listed) return;
    std::set<std::string> there;
    for (const fs::path& folder : chosen.folders) there.insert(folder.filename().string());
    const auto warn = [&](Warning warning, const std::set<std::string>& some,
                          const std::set<std::string>& others) {
        std::string names;
        std::size_t count = 0;
        for (const std::string& name : some) {
            if (others.contains(name)) continue;
            constexpr std::size_t kMost = 5;
            if (count++ < kMost) names += (count == 1 ? "" : ", ") + name;
        }
        if (count == 0) return;
        if (count > 5) names += " and " + std::to_string(count - 5) + " more";
        warning.text += names;
        warning.file = "participants.tsv";
        chosen.warnings.push_back(std::move(warning));
    };
    warn(Warning{"subject-not-listed", "does not list "}, there, *listed);
    if (options.participants.empty()) {
        warn(Warning{"subject-not-there", "lists participants without a folder: "}, *listed, there);
    }
}

}  // namespace

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

ChosenSubjects chooseSubjects(const BidsOptions& options) {
    const fs::path& root = options.dataset;
    ChosenSubjects chosen;
    std::vector<fs::path>& folders = chosen.folders;
    folders = subjectsOf(root, options.participants);
    std::sort(folders.begin(), folders.end());
    folders.erase(std::unique(folders.begin(), folders.end()), folders.end());
    if (folders.empty()) throw InvalidInput(root.string() + ": holds no participant (sub-*)");
    warnOfList(options, chosen);
    std::erase_if(folders, [&](const fs::path& subject) {
        if (liesIn(subject, root)) return false;
        chosen.faulty.emplace_back(subject.filename().string(),
                                   "is a link to outside of the dataset; put the folder itself "
                                   "there");
        return true;
    });
    if (options.skipsValidation) return chosen;
    requireDescription(root);
    std::erase_if(folders, [&](const fs::path& subject) {
        std::vector<std::string> faults;
        checkSubject(subject, faults);
        if (faults.empty()) return false;
        chosen.faulty.emplace_back(subject.filename().string(),
                                   faults.front() + "; rename it, or give --skip-bids-validation");
        return true;
    });
    return chosen;
}

std::string entityOf(const std::string& name, const std::string& key) {
    for (const std::string& part : splitAt(name, '_')) {
        if (part.starts_with(key + "-")) return part.substr(key.size() + 1);
    }
    return {};
}

}  // namespace adaptiso::bids
