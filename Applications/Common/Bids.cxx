#include <algorithm>
#include <system_error>

#include "Common/AtomicOutput.h"
#include "Common/BatchItems.h"
#include "Common/CommonOptions.h"
#include "Common/Json.h"
#include "adaptiso/MeshIO/Formats.h"

namespace adaptiso {
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

/// The folders of the participants asked for in `within`, which is `root` or its derivatives.
std::vector<fs::path> participantFolders(const fs::path& root, const fs::path& within,
                                         const std::vector<std::string>& participants) {
    if (!fs::exists(root / kDescription)) {
        throw InvalidInput("--bids " + root.string() + ": is no BIDS dataset, it has no " +
                           kDescription);
    }
    if (participants.empty()) return foldersIn(within, "sub-");
    std::vector<fs::path> folders;
    for (const std::string& label : participants) {
        const std::string name = label.starts_with("sub-") ? label : "sub-" + label;
        if (name.find('/') != std::string::npos || !fs::is_directory(within / name)) {
            throw InvalidInput("--participant " + label + ": there is no folder " + name + " in " +
                               within.string());
        }
        folders.push_back(within / name);
    }
    return folders;
}

void requireFound(const std::vector<BatchItem>& items, std::size_t before, const fs::path& where,
                  const std::string& what) {
    if (items.size() == before) throw InvalidInput("--bids: no " + what + " in " + where.string());
}

/// Images of one suffix, as --bids looks for them.
struct BidsImages {
    std::string suffix;  ///< "T1w"
    std::string what;    ///< for messages
};
const BidsImages kScans{"T1w", "T1w image"};
const BidsImages kSegmentations{"dseg", "label map (*_dseg.nii.gz)"};
constexpr const char* kSurface = "surface";

void addImages(const fs::path& folder, const fs::path& target, const BidsImages& images,
               std::vector<BatchItem>& items) {
    std::vector<fs::path> files;
    std::error_code error;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder / "anat", error)) {
        files.push_back(entry.path());
    }
    for (const fs::path& file : sorted(files)) {
        const std::string name = file.filename().string();
        for (const char* const type : {".nii", ".nii.gz"}) {
            const std::string ending = "_" + images.suffix + type;
            if (!name.ends_with(ending) || name.starts_with(".")) continue;
            items.push_back({name.substr(0, name.size() - ending.size()), {file}, target / "anat"});
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
    for (const fs::path& subject : participantFolders(root, root, participants)) {
        const std::size_t before = items.size();
        const fs::path target = derivatives / subject.filename();
        addImages(subject, target, images, items);
        for (const fs::path& session : foldersIn(subject, "ses-")) {
            addImages(session, target / session.filename(), images, items);
        }
        if (!participants.empty()) requireFound(items, before, subject, images.what);
    }
    requireFound(items, 0, root, images.what);
    return items;
}

}  // namespace

std::vector<BatchItem> findBidsScans(const fs::path& root,
                                     const std::vector<std::string>& participants,
                                     const fs::path& derivatives) {
    return findImages(root, participants, derivatives, kScans);
}

std::vector<BatchItem> findBidsSegmentations(const fs::path& root,
                                             const std::vector<std::string>& participants,
                                             const fs::path& derivatives) {
    return findImages(root, participants, derivatives, kSegmentations);
}

std::vector<BatchItem> findBidsSurfaces(const fs::path& root,
                                        const std::vector<std::string>& participants,
                                        const fs::path& derivatives) {
    std::vector<BatchItem> items;
    for (const fs::path& subject : participantFolders(root, derivatives, participants)) {
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

void makeDerivatives(const fs::path& derivatives, const std::string& program) {
    fs::create_directories(derivatives);
    if (fs::exists(derivatives / kDescription)) return;
    const Json description{{"Name", "adaptiso"},
                           {"BIDSVersion", "1.8.0"},
                           {"DatasetType", "derivative"},
                           {"GeneratedBy", {{{"Name", program}, {"Version", programVersion()}}}}};
    std::vector<AtomicOutput> outputs;
    outputs.emplace_back(derivatives / kDescription).writeText(description.dump(2) + "\n");
    AtomicOutput::commit(outputs);
}

}  // namespace adaptiso
