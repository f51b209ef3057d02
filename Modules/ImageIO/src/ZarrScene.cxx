#include "ZarrScene.h"

#include <fmt/core.h>

#include <algorithm>
#include <system_error>
#include <utility>

#include "FileFault.h"
#include "ZarrArray.h"
#include "ZarrStore.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso::detail {
namespace fs = std::filesystem;

namespace {

[[noreturn]] void refuseMetadata(const fs::path& file, std::string_view fault) {
    refuse(file, fmt::format("its metadata are damaged: {}", fault), "repair them");
}

std::optional<double> knownMillimetresOf(std::string_view unit) {
    constexpr std::pair<std::string_view, double> kUnits[] = {
        {"angstrom", 1e-7},   {"picometer", 1e-9}, {"nanometer", 1e-6}, {"nm", 1e-6},
        {"micrometer", 1e-3}, {"micron", 1e-3},    {"um", 1e-3},        {"\u00b5m", 1e-3},
        {"millimeter", 1},    {"mm", 1},           {"centimeter", 10},  {"cm", 10},
        {"decimeter", 100},   {"meter", 1e3},      {"m", 1e3}};
    for (const auto& [name, mm] : kUnits) {
        if (unit == name) return mm;
    }
    return std::nullopt;
}

ZarrAxis axisOf(const fs::path& file, const ZarrJson& json) {
    ZarrAxis axis;
    axis.name = textOf(file, json, "name");
    const ZarrJson& type = memberOf(json, "type");
    if (type == "space") axis.kind = ZarrAxis::Kind::Space;
    if (type == "channel") axis.kind = ZarrAxis::Kind::Channel;
    if (type == "time") axis.kind = ZarrAxis::Kind::Time;
    if (axis.kind != ZarrAxis::Kind::Space) return axis;
    const ZarrJson& unit = memberOf(json, "unit");
    const ZarrJson& said = unit.is_null() ? memberOf(json, "units") : unit;  // real ones write that
    if (said.is_null()) return axis;
    axis.toMm = millimetresOf(file, said.is_string() ? said.get<std::string>() : shownJson(said));
    return axis;
}

/// Numbers of a transformation, one for each dimension.
std::vector<double> factorsOf(const fs::path& file, const ZarrJson& list, std::size_t rank) {
    std::vector<double> factors;
    if (list.is_array()) {
        for (const ZarrJson& value : list) {
            if (value.is_number()) factors.push_back(value.get<double>());
        }
    }
    if (factors.size() != rank || factors.size() != list.size()) {
        refuseMetadata(file, "a transformation has not one number for each axis");
    }
    return factors;
}

/// Applies a list of transformations behind what `scene` has already.
void apply(const fs::path& file, const ZarrJson& transformations, ZarrScene& scene) {
    if (transformations.is_null()) return;
    if (!transformations.is_array()) refuseMetadata(file, "coordinateTransformations is no list");
    const std::size_t rank = scene.axes.size();
    for (const ZarrJson& one : transformations) {
        const std::string type = textOf(file, one, "type");
        if (type == "identity") continue;
        if (type != "scale" && type != "translation") {
            refuse(file, fmt::format("its transformation {} is not read here", printable(type)),
                   "write a scale and a translation");
        }
        const std::vector<double> factors = factorsOf(file, memberOf(one, type.c_str()), rank);
        for (std::size_t n = 0; n < rank; ++n) {
            if (type == "scale") {
                scene.saysScale = true;
                scene.scale[n] *= factors[n];
                scene.shift[n] *= factors[n];
            } else {
                scene.shift[n] += factors[n];
            }
        }
    }
}

/// A path below the group: names alone. \throws FileError
std::string requirePath(const fs::path& file, const std::string& path) {
    const fs::path parts(path);
    bool isGood = !path.empty() && parts.is_relative();
    for (const fs::path& part : parts) isGood = isGood && part != ".." && !part.empty();
    if (!isGood) {
        refuse(file, fmt::format("the path {} of a resolution leads out of it", printable(path)),
               "repair the metadata");
    }
    return parts.lexically_normal().generic_string();
}

ZarrScene sceneOf(const fs::path& file, const ZarrJson& multiscales, const std::string& version,
                  std::int64_t level) {
    if (!multiscales.is_array() || multiscales.empty()) {
        refuseMetadata(file, "multiscales is no list");
    }
    const ZarrJson& image = multiscales.front();
    ZarrScene scene;
    scene.format = "OME-Zarr " + version;
    if (multiscales.size() > 1) {
        scene.warnings.push_back(
            {"first-image-taken",
             fmt::format("it holds {} images; the first was taken", multiscales.size())});
    }
    for (const ZarrJson& axis : memberOf(image, "axes")) scene.axes.push_back(axisOf(file, axis));
    if (scene.axes.empty()) refuseMetadata(file, "multiscales has no axes");
    const ZarrJson& datasets = memberOf(image, "datasets");
    if (!datasets.is_array() || datasets.empty()) refuseMetadata(file, "no datasets");
    scene.levels = static_cast<std::int64_t>(datasets.size());
    if (level < 0 || level >= scene.levels) refuseLevel(file, level, scene.levels);
    const ZarrJson& dataset = datasets[static_cast<std::size_t>(level)];
    scene.path = requirePath(file, textOf(file, dataset, "path"));
    scene.scale.assign(scene.axes.size(), 1);
    scene.shift.assign(scene.axes.size(), 0);
    apply(file, memberOf(dataset, "coordinateTransformations"), scene);
    apply(file, memberOf(image, "coordinateTransformations"), scene);
    return scene;
}

/// The version of a multiscales, as far as it says.
std::string versionOf(const ZarrJson& version, const char* otherwise) {
    return version.is_string() ? version.get<std::string>() : otherwise;
}

[[noreturn]] void refuseVersion(const fs::path& file, const std::string& version) {
    refuse(file, fmt::format("is OME-Zarr {}, which is not read here", printable(version)),
           "write it as 0.4 or 0.5");
}

/// Zarr 2 keeps attributes in a file of their own.
std::optional<ZarrScene> sceneOfVersion2(const ZarrStore& store, std::int64_t level) {
    const fs::path file = store.root() / ".zattrs";
    const std::optional<ZarrJson> attributes = readZarrJson(store, ".zattrs");
    if (!attributes) return std::nullopt;
    const ZarrJson& multiscales = memberOf(*attributes, "multiscales");
    if (multiscales.is_null()) {
        if (memberOf(*attributes, "bioformats2raw.layout").is_null()) return std::nullopt;
        refuse(store.root(), "holds several images, one in each folder",
               "give one of them: " + displayName(store.root() / "0"));
    }
    const ZarrJson& first =
        multiscales.is_array() && !multiscales.empty() ? multiscales.front() : multiscales;
    const std::string version = versionOf(memberOf(first, "version"), "0.4");
    if (version != "0.4") refuseVersion(file, version);
    return sceneOf(file, multiscales, version, level);
}

std::optional<ZarrScene> sceneOfVersion3(const ZarrStore& store, std::int64_t level) {
    const fs::path file = store.root() / "zarr.json";
    const std::optional<ZarrJson> group = readZarrJson(store, "zarr.json");
    if (!group) return std::nullopt;
    const ZarrJson& ome = memberOf(memberOf(*group, "attributes"), "ome");
    if (ome.is_null()) return std::nullopt;
    const std::string version = versionOf(memberOf(ome, "version"), "of no version");
    if (version != "0.5") refuseVersion(file, version);
    const ZarrJson& multiscales = memberOf(ome, "multiscales");
    if (multiscales.is_null()) {
        refuse(store.root(), "is a group of OME-Zarr that is no image",
               "give one of the images in it: " + displayName(store.root() / "0"));
    }
    return sceneOf(file, multiscales, version, level);
}

bool isArray(const ZarrStore& store) {
    const std::optional<ZarrJson> json = readZarrJson(store, "zarr.json");
    return json ? memberOf(*json, "node_type") == "array" : store.open(".zarray").has_value();
}

}  // namespace

bool isZarrFolder(const fs::path& folder) {
    std::error_code error;
    return std::ranges::any_of(
               std::array{"zarr.json", ".zarray", ".zgroup", ".zattrs"},
               [&](const char* name) { return fs::exists(folder / name, error); }) ||
           isN5Folder(folder);
}

std::optional<double> millimetresOf(const fs::path& file, const std::string& unit) {
    const std::string_view name = trimmed(unit);
    if (name.empty() || name == "pixel" || name == "pixels" || name == "px") return std::nullopt;
    const std::optional<double> mm = knownMillimetresOf(name);
    if (mm) return mm;
    refuse(file, fmt::format("its unit '{}' is not known here", printable(unit)),
           "write micrometer, millimeter, ...");
}

void refuseLevel(const fs::path& file, std::int64_t level, std::int64_t levels) {
    refuse(file, fmt::format("there is no level {}: it holds {}", level, levels),
           fmt::format("choose one, 0 to {} (--level)", levels - 1));
}

ZarrScene findZarrScene(const ZarrStore& store, std::int64_t level) {
    if (isArray(store)) {
        ZarrScene scene;
        scene.format = "Zarr";
        if (level != 0) {
            refuse(store.root(), "is one array, which has no levels", "leave --level out");
        }
        return scene;
    }
    if (std::optional<ZarrScene> scene = sceneOfVersion3(store, level)) return *scene;
    if (std::optional<ZarrScene> scene = sceneOfVersion2(store, level)) return *scene;
    if (std::optional<ZarrScene> scene = findN5Scene(store, level)) return *scene;
    refuse(store.root(), "is a group of Zarr that is no image (OME-Zarr's multiscales)",
           "give an array in it");
}

}  // namespace adaptiso::detail
