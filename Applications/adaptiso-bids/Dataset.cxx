#include "Dataset.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <set>
#include <system_error>

#include "adaptiso/Core/Errors.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

bool isLabel(std::string_view text) {
    return !text.empty() && std::all_of(text.begin(), text.end(),
                                        [](unsigned char c) { return std::isalnum(c) != 0; });
}

std::vector<std::string> splitAt(const std::string& text, char separator) {
    std::vector<std::string> parts;
    for (std::size_t begin = 0, end = 0; end != std::string::npos; begin = end + 1) {
        end = text.find(separator, begin);
        parts.push_back(text.substr(begin, end == std::string::npos ? end : end - begin));
    }
    return parts;
}

void requireDescription(const fs::path& root) {
    std::ifstream file(root / "dataset_description.json");
    const Json said = Json::parse(file, nullptr, false);
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

ChosenSubjects chooseSubjects(const BidsOptions& options) {
    const fs::path& root = options.dataset;
    ChosenSubjects chosen;
    std::vector<fs::path>& folders = chosen.folders;
    folders = bidsSubjects(root, root, options.participants, "--participant-label");
    std::sort(folders.begin(), folders.end());
    folders.erase(std::unique(folders.begin(), folders.end()), folders.end());
    if (folders.empty()) throw InvalidInput(root.string() + ": holds no participant (sub-*)");
    warnOfList(options, chosen);
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

}  // namespace adaptiso
