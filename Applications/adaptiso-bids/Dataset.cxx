#include "Dataset.h"

#include <algorithm>
#include <cctype>
#include <optional>
#include <set>
#include <system_error>

#include "Common/CommonOptions.h"
#include "SideFiles.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/FoundFiles.h"

namespace adaptiso::bids {

const BidsImages kBidsScans{"T1w", "T1w image"};
const BidsImages kBidsSegmentations{"dseg", "label map (*_dseg.nii.gz)"};

namespace {

namespace fs = std::filesystem;

constexpr const char* kDescription = "dataset_description.json";
constexpr const char* kLinkFault =
    "is, or lies behind, a link to outside of its dataset; put the data themselves there";

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

/// All of a file of the dataset; empty if it is missing.
std::string textOf(const fs::path& root, const char* name) {
    return readFoundFile(root / name, root).value_or("");
}

/// Calls `read` with the text of a file of the dataset.
template <class Read>
auto readText(const fs::path& root, const char* name, const Read& read) {
    const std::string text = textOf(root, name);
    try {
        return read(text);
    } catch (const FileError& fault) {
        throw FileError((root / name).string() + ": " + fault.what());
    }
}

BidsIgnore ignoredIn(const fs::path& root) {
    return readText(root, ".bidsignore", [](const std::string& text) { return BidsIgnore(text); });
}

void addImages(const fs::path& root, const fs::path& folder, const fs::path& target,
               const BidsImages& images, const BidsIgnore& ignored, std::vector<BatchItem>& items) {
    std::vector<fs::path> files;
    std::error_code error;
    const fs::path anat = folder / "anat";
    if (fs::exists(anat, error) && !liesIn(anat, root)) {
        std::string name;  // none of what lies in there
        for (const fs::path& part : folder.lexically_relative(root)) {
            name += (name.empty() ? "" : "_") + part.string();
        }
        items.push_back({name, {anat}, target / "anat", kLinkFault});
        return;
    }
    for (const fs::directory_entry& entry : fs::directory_iterator(anat, error)) {
        files.push_back(entry.path());
    }
    for (const fs::path& file : sorted(files)) {
        const std::string name = file.filename().string();
        for (const char* const type : {".nii", ".nii.gz"}) {
            const std::string ending = "_" + images.suffix + type;
            if (!name.ends_with(ending) || name.starts_with(".") ||
                ignored.contains(file.lexically_relative(root)))
                continue;
            BatchItem item{name.substr(0, name.size() - ending.size()), {file}, target / "anat"};
            if (fs::exists(file, error) && !liesIn(file, root)) {
                item.fault = kLinkFault;
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

/// The folders sub-* of `participants`, labels with or without "sub-"; empty: all.
/// \throws InvalidInput  `root` is no BIDS dataset, or there is no such participant
std::vector<fs::path> subjectsOf(const fs::path& root,
                                 const std::vector<std::string>& participants) {
    if (!fs::exists(root / kDescription)) {
        throw InvalidInput(root.string() + ": is no BIDS dataset, it has no " + kDescription +
                           R"(, which holds at least {"Name": "...", "BIDSVersion": "1.9.0"})");
    }
    if (participants.empty()) {
        std::vector<fs::path> found = foldersIn(root, "sub-");
        const BidsIgnore ignored = ignoredIn(root);
        std::erase_if(found, [&](const fs::path& folder) {
            return ignored.contains(folder.lexically_relative(root));
        });
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
    const std::string key = readText(root, kDescription, missingKeyOf);
    if (key.empty()) return;
    throw InvalidInput(root.string() +
                       ": is no valid BIDS dataset: dataset_description.json has no " + key +
                       "; add it, or give --skip-bids-validation");
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
    constexpr const char* kList = "participants.tsv";
    const std::string text = textOf(options.dataset, kList);
    if (text.empty()) return;
    std::set<std::string> listed;
    try {
        listed = participantsIn(text);
    } catch (const FileError& fault) {
        chosen.warnings.push_back({"participants-not-read", fault.what(), kList});
        return;
    }
    constexpr const char* kAges = "participants.json";
    try {
        if (options.makes("bem")) agesIn(text, textOf(options.dataset, kAges));
    } catch (const FileError& fault) {
        chosen.warnings.push_back(
            {"participants-not-read", std::string(fault.what()) + "; no ages are taken", kAges});
    }
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
        warning.file = kList;
        chosen.warnings.push_back(std::move(warning));
    };
    warn(Warning{"subject-not-listed", "does not list "}, there, listed);
    if (options.participants.empty()) {
        warn(Warning{"subject-not-there", "lists participants without a folder: "}, listed, there);
    }
}

}  // namespace

std::vector<BatchItem> bidsImagesOf(const fs::path& subject,
                                    const std::vector<std::string>& sessions,
                                    const fs::path& target, const BidsImages& images) {
    std::vector<BatchItem> items;
    const fs::path root = subject.parent_path();
    const BidsIgnore ignored = ignoredIn(root);
    if (sessions.empty()) addImages(root, subject, target, images, ignored, items);
    for (const fs::path& session : foldersIn(subject, "ses-")) {
        const std::string name = session.filename().string();
        const bool isWanted = sessions.empty() ||
                              std::any_of(sessions.begin(), sessions.end(), [&](const auto& label) {
                                  return withPrefix(label, "ses-") == name;
                              });
        if (isWanted) addImages(root, session, target / name, images, ignored, items);
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
