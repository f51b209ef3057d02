#include "adaptiso/HeadPipeline/BemFiles.h"

#include <utility>

#include "BemFileKinds.h"
#include "BemReadme.h"
#include "adaptiso/Core/Bytes.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso {

namespace fs = std::filesystem;

std::vector<std::string> bemFileNames() {
    std::vector<std::string> names{"report.json", "spots.png", "README.md"};
    for (const BemFileRow& row : bemFileRows()) {
        names.insert(names.end(), row.files.begin(), row.files.end());
    }
    return names;
}

std::string bemFileName(HeadSurface surface, const char* extension) {
    return std::string(toString(surface)) + extension;
}

void writeBemFiles(const BemModel& model, const BemFileOptions& options, const std::string& maker,
                   const std::function<fs::path(const std::string&)>& place) {
    const BemFileSource source{model, options};
    for (const BemFileRow& row : bemFileRows()) {
        if (row.isWanted(source)) row.kind(source, row.files).write(place);
    }
    writeText(place("README.md"), bemReadme(model, options, maker));
}

std::vector<std::vector<std::string>> openMeegCommands(bool hasDipoles, bool hasElectrodes) {
    std::vector<std::vector<std::string>> commands{
        {"om_assemble", "-HM", "model.geom", "model.cond", "hm.mat"},
        {"om_minverser", "hm.mat", "hm_inv.mat"}};
    const auto assemble = [&](const char* what, const char* points, const char* made) {
        commands.push_back({"om_assemble", what, "model.geom", "model.cond", points, made});
    };
    if (hasDipoles) assemble("-DSM", "dipoles.txt", "dsm.mat");
    if (hasElectrodes) assemble("-H2EM", "electrodes.txt", "h2em.mat");
    if (!hasDipoles || !hasElectrodes) return commands;
    commands.push_back({"om_gain", "-EEG", "hm_inv.mat", "dsm.mat", "h2em.mat", "gain.txt"});
    return commands;
}

AffineTransform toMriCoordinates(const BemModel& model, const BemFileOptions& options) {
    const BemFileSource source{model, options};
    return source.into(source.mriFrame()) * inverse(source.into(options.frame));
}

void checkBemFiles(const fs::path& folder, const BemFileOptions& options, BemModel& model) {
    const BemFileSource source{model, options};
    for (const BemFileRow& row : bemFileRows()) {
        if (!row.isWanted(source)) continue;
        BemFileFault fault;
        try {
            fault = row.kind(source, row.files).check(folder);
        } catch (const FileError& error) {
            std::string what = error.what();
            if (what.starts_with(folder.string() + "/")) what.erase(0, folder.string().size() + 1);
            fault = source.fault(what);
        }
        BemCheck check{std::string(row.name), std::string(row.promise), !fault, "", {}};
        if (fault) {
            check.detail = fault->what;
            check.pointMm = fault->pointMm;
        }
        model.addCheck(std::move(check));
    }
}

}  // namespace adaptiso
