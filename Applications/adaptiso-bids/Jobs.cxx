#include "Jobs.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <string_view>
#include <utility>

#include "Common/OptionValues.h"
#include "Common/RunApp.h"
#include "Common/UsageWords.h"
#include "Dataset.h"
#include "SideFiles.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/FoundFiles.h"
#include "adaptiso/Core/ParseJson.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/MeshIO/Formats.h"

namespace adaptiso::bids {
namespace {

namespace fs = std::filesystem;

const std::string kIso = "--iso=", kFormat = "--format=";

/// Options that adaptiso-bids sets, or that make no result, of all programs.
const std::vector<std::string> kRefused{
    "output",        "output-dir",  "list",          "bids",     "participant",  "jobs",
    "skip-existing", "summary",     "report",        "pictures", "json",         "quiet",
    "threads",       "no-warnings", "strict",        "help",     "version",      "allow",
    "list-series",   "info",        "show-phi",      "force",    "subjects-dir", "subject",
    "dry-run",       "t1",          "probabilities", "ct",       "surfaces",     "volume",
    "nested",        "self-test",   "log",           "csv"};

std::string outputOf(const fs::path& program, const std::string& option) {
    const ChildResult result = runChild(program, {option});
    if (result.isGood()) return result.output;
    throw InvalidInput(program.string() + ": does not answer to " + option +
                       "; install adaptiso again");
}

ProgramInfo findProgram(const std::string& name) {
    std::error_code error;
    ProgramInfo program{
        name, fs::read_symlink("/proc/self/exe", error).parent_path() / name, {}, {}};
    if (!fs::exists(program.executable, error)) {
        throw InvalidInput(name + ": is not beside adaptiso-bids, in " +
                           program.executable.parent_path().string() + "; install adaptiso whole");
    }
    program.version = outputOf(program.executable, "--version");
    while (program.version.ends_with('\n')) program.version.pop_back();
    const Json help = parseJson<Json>(outputOf(program.executable, "--help-json"));
    if (!help.is_object()) {
        throw InvalidInput(program.executable.string() + ": is of another version");
    }
    for (const Json& option : help.at("options")) {
        for (const Json& text : option.at("names")) {
            const std::string known = text.get<std::string>();
            if (known.starts_with("--")) program.options.push_back(known.substr(2));
        }
    }
    return program;
}

/// "iso" of "iso=100" and of "iso"; empty if the part is no option.
std::string nameOf(const std::string& part) {
    const std::string name = part.substr(0, part.find('='));
    const bool isName = !name.empty() && std::islower(static_cast<unsigned char>(name[0])) != 0 &&
                        std::all_of(name.begin(), name.end(), [](unsigned char c) {
                            return std::islower(c) != 0 || std::isdigit(c) != 0 || c == '-';
                        });
    return isName ? name : std::string();
}

/// Brings isovalues to one text ("100" for "100.0") and takes the format out. \throws UsageError
std::string prepareMeshOptions(std::vector<std::string>& options) {
    std::string format = "vtp";
    std::vector<std::string> prepared;
    for (const std::string& option : options) {
        if (option.starts_with(kFormat)) {
            format = option.substr(kFormat.size());
            continue;
        }
        std::string text = option;
        if (option.starts_with(kIso) && option != kIso + "auto") {
            text =
                kIso + formatNumber(parseNumber("--surfaces iso", option.substr(kIso.size()), {}));
        }
        if (text.starts_with(kIso) && std::ranges::count(prepared, text) > 0) {
            throw UsageError("--surfaces " + text.substr(2) + ": is given twice");
        }
        prepared.push_back(text);
    }
    options = std::move(prepared);
    const auto isIso = [](const std::string& option) { return option.starts_with(kIso); };
    if (std::ranges::none_of(options, isIso)) options.push_back(kIso + "auto");
    try {
        findMeshFormat("mesh." + format);
    } catch (const InvalidInput&) {
        throw UsageError("--surfaces format=" + shown(format) +
                         ": is no format of meshes; adaptiso-mesh --help lists them");
    }
    return format;
}

/// Where "{isolabel}" stands in the files' name.
std::vector<fs::path> surfaceFiles(const fs::path& output,
                                   const std::vector<std::string>& isovalues) {
    std::vector<fs::path> files;
    for (const std::string& isovalue : isovalues) {
        std::string name = output.filename().string();
        const std::size_t at = name.find(kIsoLabel);
        if (at != std::string::npos) name.replace(at, kIsoLabel.size(), bidsLabel(isovalue));
        files.push_back(output.parent_path() / name);
    }
    return files;
}

/// The JSON file that BIDS asks for beside a result.
Json sidecarOf(const BidsOptions& options, const std::string& product, const BatchItem& item,
               const Json& report) {
    const bool isElsewhere = product == "labels" && !options.segmentations.empty();
    const fs::path& root = isElsewhere ? options.segmentations : options.dataset;
    const std::string uri = std::string(isElsewhere ? "bids:segmentations:" : "bids:raw:") +
                            item.inputs.front().lexically_relative(root).generic_string();
    Json json{{"Sources", {uri}}, {"SpatialReference", uri}};
    if (product == "surfaces") {
        const Json& surface = report.at("surfaces").at(0);
        json["Description"] = "Isosurface of the image, inside where it is >= Isovalue";
        json["Isovalue"] = surface.at("isovalue");
        json["IsovalueChosenBy"] = surface.at("isovalueChosenBy");
        json["Method"] = surface.at("method");
        json["ErrorBoundMm"] = surface.at("errorBoundMm");
        json["Coordinates"] = surface.at("output").at("coordinates");
        return json;
    }
    json["Description"] = product == "bem"
                              ? "Surfaces of a boundary element head model"
                              : "Surfaces of the regions of a label map, with shared walls";
    json["Coordinates"] = report.at("output").at("coordinates");
    return json;
}

Job newJob(const BidsOptions& options, const std::string& product) {
    Job job;
    job.product = product;
    const bool isMesh = product == "surfaces", isBem = product == "bem";
    ProgramInfo info = findProgram("adaptiso-" + (isMesh ? "mesh" : product));
    BatchProgram& program = job.program;
    program.name = info.name;
    program.executable = info.executable;
    program.version = info.version;
    program.outputOptions = {"--pictures"};
    program.removesFormer = true;
    program.request = requestOf(options, product);
    BatchOptions& batch = job.batch;
    batch.outputFolder = options.output;
    batch.jobs = options.jobs;
    batch.skipsExisting = true;
    if (options.common.isStrict) batch.runOptions.emplace_back("--strict");
    for (const std::string& code : options.common.allowed) {
        batch.runOptions.push_back("--allow=" + code);
    }
    if (isMesh) info.options.emplace_back("format");
    std::vector<std::string> refused = kRefused;
    if (isBem) refused.emplace_back("labels");
    if (product == "check") refused.emplace_back("iso");
    std::vector<std::string> chosen =
        programOptions(isMesh ? "--surfaces" : "--" + product + "-options",
                       options.wanted.at(product), info, refused);
    std::string output = product == "labels" ? "{name}_mesh" : "{name}_desc-bem_mesh";
    if (isMesh) {
        output = "{name}_desc-iso{isolabel}_mesh." + prepareMeshOptions(chosen);
        program.surfaceOption = "--iso";
        program.surfaceFiles = surfaceFiles;
    }
    if (product == "check") {
        std::ranges::move(chosen, std::back_inserter(batch.runOptions));
        return job;
    }
    if (!isMesh) chosen.emplace_back("--force");
    if (isBem) {
        program.inputOption = "--t1";
        program.inputOptions = {"--brain-mask", "--aseg", "--pial", "--electrodes", "--lesion"};
    } else if (!isMesh) {
        program.inputOptions = {"--names"};
    }
    // by name, so that their order makes no difference; several of one name keep theirs
    std::ranges::stable_sort(
        chosen, {}, [](const std::string& option) { return option.substr(0, option.find('=')); });
    std::ranges::move(chosen, std::back_inserter(batch.runOptions));
    batch.runOptions.push_back("--output=" + output);
    if (options.makesPictures) {
        batch.runOptions.push_back("--pictures={name}_desc-" + (isMesh ? "iso" : product) +
                                   "_figures");
    }
    program.outputOptions.emplace_back("--output");
    program.sidecar = [&options, product](const BatchItem& item, const Json& report) {
        return sidecarOf(options, product, item, report);
    };
    return job;
}

}  // namespace

std::vector<std::string> programOptions(const std::string& option, const std::string& list,
                                        const ProgramInfo& program,
                                        const std::vector<std::string>& refused) {
    std::vector<std::string> parts;
    for (std::size_t begin = 0, end = list.empty() ? std::string::npos : 0;
         end != std::string::npos; begin = end + 1) {
        end = list.find(',', begin);
        const std::string part = list.substr(begin, end == std::string::npos ? end : end - begin);
        if (parts.empty() || !nameOf(part).empty()) {
            parts.push_back(part);
        } else {
            parts.back() += "," + part;
        }
    }
    std::vector<std::string> options;
    for (const std::string& part : parts) {
        const std::string name = nameOf(part);
        const auto isIn = [&](const std::vector<std::string>& words) {
            return std::find(words.begin(), words.end(), name) != words.end();
        };
        const std::string given = option + " " + shown(part);
        if (isIn(refused)) {
            throw UsageError(given + ": is set by adaptiso-bids and cannot be passed on");
        }
        if (!isIn(program.options)) {
            throw UsageError(given + ": " + program.name + " has no such option" +
                             suggestion(name, program.options));
        }
        if (part.ends_with('=')) throw UsageError(given + ": its value is missing");
        options.push_back("--" + part);
    }
    return options;
}

Json requestOf(const BidsOptions& options, const std::string& product) {
    Json request{{"product", product},
                 {"pictures", options.makesPictures},
                 {"strict", options.common.isStrict},
                 {"allow", options.common.allowed},
                 {"options", options.wanted.at(product)}};
    if (product == "labels" && !options.segmentations.empty()) {
        std::error_code error;
        request["segmentations"] =
            fs::proximate(options.segmentations, options.output, error).generic_string();
    }
    return request;
}

Json requestOf(const BidsOptions& options) {
    Json request = Json::array();
    for (const char* const product : kProducts) {
        if (options.makes(product)) request.push_back(requestOf(options, product));
    }
    return request;
}

namespace {

/// Ages of children by participants.tsv, where the options have none.
std::map<std::string, double> childrenOf(const BidsOptions& options) {
    constexpr double kAdultYears = 18;
    std::map<std::string, double> ages;
    const std::string wanted = options.makes("bem") ? "," + options.wanted.at("bem") : ",age=";
    if (wanted.find(",age=") != std::string::npos) return ages;
    const auto text = [&](const char* name) {
        return readFoundFile(options.dataset / name, options.dataset).value_or("");
    };
    if (const std::string list = text("participants.tsv"); !list.empty()) {
        try {
            ages = agesIn(list, text("participants.json"));
        } catch (const FileError&) {
            ages.clear();  // which is warned of
        }
    }
    std::erase_if(ages, [&](const auto& each) { return each.second >= kAdultYears; });
    return ages;
}

}  // namespace

std::vector<Job> findJobs(const BidsOptions& options, const std::vector<fs::path>& subjects) {
    std::vector<Job> jobs;
    const std::map<std::string, double> children = childrenOf(options);
    for (const std::string product : kProducts) {
        if (product == "check" || !options.makes(product)) continue;
        Job& job = jobs.emplace_back(newJob(options, product));
        const bool isLabels = product == "labels";
        const BidsImages& images = isLabels ? kBidsSegmentations : kBidsScans;
        const fs::path& root =
            isLabels && !options.segmentations.empty() ? options.segmentations : options.dataset;
        job.needs = images.what;
        std::vector<BatchItem> items;
        for (const fs::path& subject : subjects) {
            const fs::path name = subject.filename();
            std::vector<BatchItem> found =
                bidsImagesOf(root / name, options.sessions, options.output / name, images);
            if (found.empty()) job.without.push_back(name.string());
            const auto child = children.find(name.string());
            for (BatchItem& item : found) {
                if (product != "bem" || child == children.end()) break;
                item.options.push_back("--age=" + formatNumber(child->second));
            }
            std::ranges::move(found, std::back_inserter(items));
        }
        job.runs = planRuns(job.program, std::move(items), job.batch, options.common);
    }
    return jobs;
}

Job checkJob(const BidsOptions& options, const Job& surfaces) {
    Job job = newJob(options, "check");
    std::vector<BatchItem> items;
    for (const PlannedRun& run : surfaces.runs) {
        RunRecord record;
        const bool isRead = readRecord(run.record, record) == RecordFault::None;
        if (!isRead || !record.hasEnded || !record.hasPassed()) continue;
        for (const std::string& output : record.outputs) {
            items.push_back({output, {run.item.folder / output}, run.item.folder});
        }
    }
    job.runs = planRuns(job.program, std::move(items), job.batch, options.common);
    return job;
}

}  // namespace adaptiso::bids
