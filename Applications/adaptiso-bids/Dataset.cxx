#include "Dataset.h"

#include <algorithm>
#include <cctype>
#include <fstream>
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

void lookAtDescription(const fs::path& root, std::vector<std::string>& faults) {
    std::ifstream file(root / "dataset_description.json");
    const Json said = Json::parse(file, nullptr, false);
    for (const char* const key : {"Name", "BIDSVersion"}) {
        if (said.is_object() && said.contains(key) && said[key].is_string()) continue;
        faults.push_back("dataset_description.json: has no " + std::string(key));
    }
}

/// Of "sub-01_ses-2_acq-hi" in the folder sub-01/ses-2.
void lookAtName(const std::string& name, const std::string& begin,
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

void lookAtSubject(const fs::path& subject, std::vector<std::string>& faults) {
    const std::string name = subject.filename().string();
    if (!isLabel(name.substr(std::min<std::size_t>(name.size(), 4)))) {
        faults.push_back(name + ": its label has more than letters and digits");
        return;
    }
    for (const BidsImages* images : {&kBidsScans, &kBidsSegmentations}) {
        for (const BatchItem& item : bidsImagesOf(subject, {}, subject, *images)) {
            const fs::path session = item.inputs.front().parent_path().parent_path().filename();
            lookAtName(item.name, session == name ? name : name + "_" + session.string(), faults);
        }
    }
}

}  // namespace

std::vector<std::string> bidsFaults(const fs::path& root, const std::vector<fs::path>& subjects) {
    std::vector<std::string> faults;
    lookAtDescription(root, faults);
    for (const fs::path& subject : subjects) lookAtSubject(subject, faults);
    return faults;
}

std::vector<fs::path> chosenSubjects(const BidsOptions& options) {
    const fs::path& root = options.dataset;
    std::vector<fs::path> subjects =
        bidsSubjects(root, root, options.participants, "--participant-label");
    std::sort(subjects.begin(), subjects.end());
    subjects.erase(std::unique(subjects.begin(), subjects.end()), subjects.end());
    if (subjects.empty()) throw InvalidInput(root.string() + ": holds no participant (sub-*)");
    if (options.skipsValidation) return subjects;
    const std::vector<std::string> faults = bidsFaults(root, subjects);
    if (faults.empty()) return subjects;
    throw InvalidInput(
        root.string() + ": is no valid BIDS dataset: " + faults.front() +
        (faults.size() == 1 ? "" : "; and " + std::to_string(faults.size() - 1) + " more") +
        "; --skip-bids-validation takes it as it is");
}

std::string entityOf(const std::string& name, const std::string& key) {
    for (const std::string& part : splitAt(name, '_')) {
        if (part.starts_with(key + "-")) return part.substr(key.size() + 1);
    }
    return {};
}

}  // namespace adaptiso
