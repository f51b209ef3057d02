#include "Products.h"

#include <algorithm>
#include <utility>

#include "Common/BatchPlan.h"
#include "Common/Bids.h"
#include "Common/OptionValues.h"
#include "Common/RunApp.h"
#include "Common/UsageWords.h"
#include "Dataset.h"
#include "Siblings.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/MeshIO/Formats.h"

namespace adaptiso {
namespace {

namespace fs = std::filesystem;

constexpr const char* kIso = "--iso";

/// Options that say what a run reads and writes, and how it runs: of all programs.
std::vector<std::string> refusedOptions() {
    return {"output",        "output-dir",  "list",          "bids",     "participant",  "jobs",
            "skip-existing", "summary",     "report",        "pictures", "json",         "quiet",
            "threads",       "no-warnings", "strict",        "help",     "version",      "allow",
            "list-series",   "info",        "show-phi",      "force",    "subjects-dir", "subject",
            "dry-run",       "t1",          "probabilities", "ct",       "surfaces",     "volume",
            "nested",        "self-test"};
}

Json sourceJson(const BidsOptions& options, const BatchItem& item, bool isSegmentation) {
    const bool isElsewhere = isSegmentation && !options.segmentations.empty();
    const fs::path& root = isElsewhere ? options.segmentations : options.dataset;
    const std::string uri = std::string(isElsewhere ? "bids:segmentations:" : "bids:raw:") +
                            item.inputs.front().lexically_relative(root).generic_string();
    return {{"Sources", {uri}}, {"SpatialReference", uri}};
}

Product newProduct(const BidsOptions& options, const std::string& name, const Sibling& sibling) {
    Product product;
    product.name = name;
    BatchProgram& program = product.program;
    program.name = sibling.name;
    program.executable = sibling.executable;
    program.version = sibling.version;
    program.outputOptions = {kOutputOption, "--pictures"};
    program.isPartOfApp = true;
    program.removesFormer = true;
    BatchOptions& batch = product.batch;
    batch.bids = options.dataset;
    batch.outputFolder = options.output;
    batch.jobs = options.jobs;
    batch.skipsExisting = true;
    if (options.common.isStrict) batch.runOptions.push_back("--strict");
    for (const std::string& code : options.common.allowed) {
        batch.runOptions.push_back("--allow=" + code);
    }
    program.asked = askedOf(options, name);
    return product;
}

void addOptions(Product& product, std::vector<std::string> options, const std::string& output,
                const std::string& pictures) {
    // by name, so that their order is no difference; several of one name stay in theirs
    const auto name = [](const std::string& option) { return option.substr(0, option.find('=')); };
    std::ranges::stable_sort(options, {}, name);
    std::vector<std::string>& all = product.batch.runOptions;
    std::move(options.begin(), options.end(), std::back_inserter(all));
    all.push_back(std::string(kOutputOption) + "=" + output);
    if (!pictures.empty()) all.push_back("--pictures=" + pictures);
}

void findItems(Product& product, const BidsOptions& options, const BidsImages& images,
               const std::vector<fs::path>& subjects, const fs::path& root) {
    product.needs = images.what;
    for (const fs::path& subject : subjects) {
        const fs::path name = subject.filename();
        std::vector<BatchItem> found =
            bidsImagesOf(root / name, options.sessions, options.output / name, images);
        if (found.empty()) product.without.push_back(name.string());
        std::move(found.begin(), found.end(), std::back_inserter(product.items));
    }
}

/// "--iso=100" of "--iso=100.0". \throws UsageError
std::string normalized(const std::string& option) {
    const std::string start = std::string(kIso) + "=";
    if (!option.starts_with(start)) return option;
    const std::string value = option.substr(start.size());
    return value == "auto" ? option
                           : start + formatNumber(parseNumber("--surfaces iso", value, {}));
}

/// Takes "--format=stl" out of the options. \throws UsageError
std::string takeFormat(std::vector<std::string>& options) {
    const std::string start = "--format=";
    std::string format = "vtp";
    std::erase_if(options, [&](const std::string& option) {
        if (!option.starts_with(start)) return false;
        format = option.substr(start.size());
        return true;
    });
    try {
        findMeshFormat("mesh." + format);
    } catch (const InvalidInput&) {
        throw UsageError("--surfaces format=" + shown(format) +
                         ": is no format of meshes; adaptiso-mesh --help lists them");
    }
    return format;
}

std::vector<std::string> meshOptions(const std::string& list, Sibling sibling) {
    sibling.options.emplace_back("format");
    std::vector<std::string> options =
        siblingOptions("--surfaces", list, sibling, refusedOptions());
    std::transform(options.begin(), options.end(), options.begin(), normalized);
    for (auto option = options.begin(); option != options.end(); ++option) {
        if (option->starts_with(kIso) && std::find(options.begin(), option, *option) != option) {
            throw UsageError("--surfaces " + option->substr(2) + ": is given twice");
        }
    }
    const bool hasIso = std::any_of(options.begin(), options.end(),
                                    [](const auto& option) { return option.starts_with(kIso); });
    if (!hasIso) options.insert(options.begin(), std::string(kIso) + "=auto");
    return options;
}

Json meshSidecar(const BidsOptions& options, const BatchItem& item, const Json& report) {
    Json json = sourceJson(options, item, false);
    const Json& surface = report.at("surfaces").at(0);
    json["Description"] = "Isosurface of the image, inside where it is >= Isovalue";
    json["Isovalue"] = surface.at("isovalue");
    json["IsovalueChosenBy"] = surface.at("isovalueChosenBy");
    json["Method"] = surface.at("method");
    json["ErrorBoundMm"] = surface.at("errorBoundMm");
    json["Coordinates"] = surface.at("output").at("coordinates");
    return json;
}

std::string meshSays(const Json& report) {
    std::string text;
    for (const Json& surface : report.value("surfaces", Json::array())) {
        text += (text.empty() ? "" : "; ") + surface.at("output").at("file").get<std::string>() +
                ", " + formatCount(surface.at("triangles").get<long long>()) + " triangles at " +
                formatShort(surface.at("isovalue").get<double>());
    }
    return text;
}

std::vector<std::string> meshFiles(const Json& report) {
    std::vector<std::string> files;
    for (const Json& surface : report.value("surfaces", Json::array())) {
        const Json& output = surface.at("output");
        if (output.value("written", true)) files.push_back(output.at("file"));
    }
    return files;
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

Product meshProduct(const BidsOptions& options) {
    const Sibling sibling = findSibling("adaptiso-mesh");
    Product product = newProduct(options, "surfaces", sibling);
    std::vector<std::string> asked = meshOptions(options.surfaces, sibling);
    const std::string format = takeFormat(asked);
    addOptions(product, std::move(asked), "{name}_desc-iso{isolabel}_mesh." + format,
               options.makesPictures ? "{name}_desc-iso_figures" : "");
    BatchProgram& program = product.program;
    program.surfaceOption = kIso;
    program.surfaceFiles = surfaceFiles;
    program.says = meshSays;
    program.outputs = meshFiles;
    program.sidecar = [&options](const BatchItem& item, const Json& report) {
        return meshSidecar(options, item, report);
    };
    return product;
}

Product bemProduct(const BidsOptions& options) {
    const Sibling sibling = findSibling("adaptiso-bem");
    Product product = newProduct(options, "bem", sibling);
    std::vector<std::string> refused = refusedOptions();
    refused.emplace_back("labels");
    std::vector<std::string> asked =
        siblingOptions("--bem-options", options.bemOptions, sibling, refused);
    asked.emplace_back("--force");
    addOptions(product, std::move(asked), "{name}_desc-bem_mesh",
               options.makesPictures ? "{name}_desc-bem_figures" : "");
    BatchProgram& program = product.program;
    program.inputOption = "--t1";
    program.inputOptions = {"--brain-mask", "--aseg", "--pial", "--electrodes"};
    program.says = [](const Json& report) -> std::string {
        if (report.value("model", false)) {
            return "a model of " + std::to_string(report.at("surfaces").size()) + " surfaces";
        }
        const Json findings = report.value("findings", Json::array());
        return "no model: " + (findings.empty() ? std::string("it could not be guaranteed")
                                                : findings[0].at("what").get<std::string>());
    };
    program.outputs = [](const Json& report) {
        std::vector<std::string> files;
        if (!report.value("model", false)) return files;
        for (const Json& file : report.at("output").at("files")) {
            files.push_back("{name}_desc-bem_mesh/" + file.at("file").get<std::string>());
        }
        return files;
    };
    program.sidecar = [&options](const BatchItem& item, const Json& report) {
        Json json = sourceJson(options, item, false);
        json["Description"] = "Surfaces of a boundary element head model";
        json["Coordinates"] = report.at("output").at("coordinates");
        return json;
    };
    return product;
}

std::vector<std::string> labelsFiles(const Json& report) {
    std::vector<std::string> files;
    const Json output = report.value("output", Json::object());
    if (!output.value("written", false)) return files;
    for (const Json& file : output.at("files")) {
        files.push_back("{name}_mesh/" + file.at("file").get<std::string>());
    }
    return files;
}

Product labelsProduct(const BidsOptions& options) {
    const Sibling sibling = findSibling("adaptiso-labels");
    Product product = newProduct(options, "labels", sibling);
    std::vector<std::string> asked =
        siblingOptions("--labels-options", options.labelsOptions, sibling, refusedOptions());
    asked.emplace_back("--force");
    addOptions(product, std::move(asked), "{name}_mesh",
               options.makesPictures ? "{name}_desc-labels_figures" : "");
    BatchProgram& program = product.program;
    program.inputOptions = {"--names"};
    program.says = [](const Json& report) -> std::string {
        if (!report.contains("regions")) return {};
        for (const Json& check : report.value("checks", Json::array())) {
            if (!check.value("passed", true))
                return "failed: " + check.at("name").get<std::string>();
        }
        return formatCount(static_cast<long long>(report.at("regions").size())) + " regions";
    };
    program.outputs = labelsFiles;
    program.sidecar = [&options](const BatchItem& item, const Json& report) {
        Json json = sourceJson(options, item, true);
        json["Description"] = "Surfaces of the regions of a label map, with shared walls";
        json["Coordinates"] = report.at("output").at("coordinates");
        return json;
    };
    return product;
}

std::string checkSays(const Json& report) {
    std::string text;
    for (const Json& surface : report.value("surfaces", Json::array())) {
        for (const Json& name : surface.value("failed", Json::array())) {
            text += (text.empty() ? "" : ", ") + name.get<std::string>();
        }
    }
    return text.empty() ? "all that is required holds" : text;
}

}  // namespace

Json askedOf(const BidsOptions& options, const std::string& product) {
    Json asked{{"product", product},
               {"pictures", options.makesPictures},
               {"strict", options.common.isStrict},
               {"allow", options.common.allowed}};
    if (product == "surfaces") asked["options"] = options.surfaces;
    if (product == "bem") asked["options"] = options.bemOptions;
    if (product == "check") asked["options"] = options.checkOptions;
    if (product != "labels") return asked;
    asked["options"] = options.labelsOptions;
    if (!options.segmentations.empty()) {
        std::error_code error;
        asked["segmentations"] =
            fs::proximate(options.segmentations, options.output, error).generic_string();
    }
    return asked;
}

void bindItems(Product& product) {
    product.program.findInBids = [&product](const fs::path&, const std::vector<std::string>&,
                                            const fs::path&) { return product.items; };
}

std::deque<Product> findProducts(const BidsOptions& options,
                                 const std::vector<fs::path>& subjects) {
    std::deque<Product> products;
    if (!options.surfaces.empty()) products.push_back(meshProduct(options));
    if (options.makesBem) products.push_back(bemProduct(options));
    for (Product& product : products) {
        findItems(product, options, kBidsScans, subjects, options.dataset);
    }
    if (options.makesLabels) {
        products.push_back(labelsProduct(options));
        findItems(products.back(), options, kBidsSegmentations, subjects,
                  options.segmentations.empty() ? options.dataset : options.segmentations);
    }
    for (Product& product : products) bindItems(product);
    return products;
}

Product checkOf(const BidsOptions& options, const Product& surfaces) {
    const Sibling sibling = findSibling("adaptiso-check");
    Product product = newProduct(options, "check", sibling);
    std::vector<std::string> refused = refusedOptions();
    refused.emplace_back("iso");
    for (std::string& option :
         siblingOptions("--check-options", options.checkOptions, sibling, refused)) {
        product.batch.runOptions.push_back(std::move(option));
    }
    product.program.outputOptions = {"--report", "--pictures"};
    product.program.says = checkSays;
    product.program.outputs = [](const Json&) { return std::vector<std::string>{}; };
    const BatchPlan plan(surfaces.program, surfaces.batch, options.common);
    for (const BatchItem& item : plan.items()) {
        for (const PlannedRecord& planned : plan.records(item)) {
            RecordFault fault = RecordFault::None;
            const std::optional<KeptRecord> record = readRecord(planned.file, fault);
            if (!record || !record->hasEnded || !record->run.hasPassed()) continue;
            for (const std::string& output : record->run.outputs) {
                product.items.push_back({output, {item.folder / output}, item.folder});
            }
        }
    }
    return product;
}

}  // namespace adaptiso
