#include "adaptiso-giant/GiantPlan.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "adaptiso/Core/Errors.h"

namespace adaptiso::giant {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "adaptiso-giant-plan/1";

template <class T>
Json orNull(const std::optional<T>& value) {
    return value ? Json(*value) : Json(nullptr);
}

Json vectorJson(const Vec3& v) {
    return {v.x, v.y, v.z};
}

Json ids(const std::vector<Index3>& places) {
    Json list = Json::array();
    for (const Index3& place : places) list.push_back(idOf(place));
    return list;
}

/// All but the lists.
Json identityJson(const GiantPlan& plan) {
    const Mat3& axes = plan.geometry.indexToPhysical;
    return {{"schema", kSchema},
            {"version", plan.version},
            {"input", plan.input.string()},
            {"read",
             {{"level", orNull(plan.read.level)},
              {"channel", orNull(plan.read.channel)},
              {"time", orNull(plan.read.timePoint)},
              {"volumeIndex", orNull(plan.read.volumeIndex)},
              {"series", orNull(plan.read.series)},
              {"resampleSlices", plan.read.resampleSlices},
              {"refuseMissingChunks", plan.read.refusesMissingChunks}}},
            {"format", plan.format},
            {"sizeVoxels", plan.geometry.size},
            {"originMm", vectorJson(plan.geometry.originMm)},
            {"indexToPhysical",
             {vectorJson(axes.column[0]), vectorJson(axes.column[1]), vectorJson(axes.column[2])}},
            {"pixelType", toString(plan.pixelType)},
            {"isovalue", plan.isovalue},
            {"method", toString(plan.method)},
            {"maxErrorMm", plan.maxErrorMm},
            {"side", plan.side}};
}

[[noreturn]] void refusePlan(const std::string& name, const std::string& what) {
    throw FileError(name + ": is no plan of adaptiso-giant, or damaged (" + what +
                    "); make it again with: adaptiso-giant plan");
}

/// Reads the output of encodePlan() and validates every value.
class PlanReader {
public:
    PlanReader(const Json& json, const std::string& name) : json_(json), name_(name) {}

    GiantPlan read() const {
        if (text(json_, "schema") != kSchema) refusePlan(name_, "another schema");
        GiantPlan plan;
        plan.version = text(json_, "version");
        plan.input = text(json_, "input");
        plan.format = text(json_, "format");
        readOptions(plan.read);
        readImage(plan);
        plan.isovalue = number(member(json_, "isovalue"));
        const std::string method = text(json_, "method");
        if (method != "mc" && method != "adaptive") refusePlan(name_, "method");
        plan.method = method == "mc" ? Method::MarchingCubes : Method::Adaptive;
        plan.maxErrorMm = number(member(json_, "maxErrorMm"));
        if (plan.isAdaptive() && !(plan.maxErrorMm > 0)) refusePlan(name_, "maxErrorMm");
        plan.side = whole(member(json_, "side"), 1, TileCut::kLargestSide);
        readTiles(plan);
        for (const Json& warning : member(json_, "warnings")) {
            plan.warnings.push_back({text(warning, "code"), text(warning, "text")});
        }
        return plan;
    }

private:
    const Json& member(const Json& object, const char* key) const {
        if (!object.is_object() || !object.contains(key)) refusePlan(name_, key);
        return object.at(key);
    }
    std::string text(const Json& object, const char* key) const {
        const Json& value = member(object, key);
        if (!value.is_string()) refusePlan(name_, key);
        return value.get<std::string>();
    }
    double number(const Json& value) const {
        if (!value.is_number() || !std::isfinite(value.get<double>())) refusePlan(name_, "number");
        return value.get<double>();
    }
    std::int64_t whole(const Json& value, std::int64_t least, std::int64_t most) const {
        if (!value.is_number_integer() ||
            (value.is_number_unsigned() && value.get<std::uint64_t>() > INT64_MAX) ||
            value.get<std::int64_t>() < least || value.get<std::int64_t>() > most) {
            refusePlan(name_, "whole number");
        }
        return value.get<std::int64_t>();
    }
    bool flag(const Json& object, const char* key) const {
        const Json& value = member(object, key);
        if (!value.is_boolean()) refusePlan(name_, key);
        return value.get<bool>();
    }
    const Json& list(const Json& value, std::size_t count) const {
        if (!value.is_array() || value.size() != count) refusePlan(name_, "list");
        return value;
    }
    Vec3 vectorOf(const Json& value) const {
        const Json& three = list(value, 3);
        return {number(three[0]), number(three[1]), number(three[2])};
    }
    std::optional<std::int64_t> countOrNone(const Json& object, const char* key) const {
        const Json& value = member(object, key);
        if (value.is_null()) return std::nullopt;
        return whole(value, 0, INT64_MAX);
    }

    void readOptions(ReadOptions& read) const {
        const Json& json = member(json_, "read");
        read.level = countOrNone(json, "level");
        read.channel = countOrNone(json, "channel");
        read.timePoint = countOrNone(json, "time");
        read.volumeIndex = countOrNone(json, "volumeIndex");
        if (!member(json, "series").is_null()) read.series = text(json, "series");
        read.resampleSlices = flag(json, "resampleSlices");
        read.refusesMissingChunks = flag(json, "refuseMissingChunks");
    }

    void readImage(GiantPlan& plan) const {
        constexpr std::int64_t kMost = 1 << 20;
        const Json& size = list(member(json_, "sizeVoxels"), 3);
        const Json& axes = list(member(json_, "indexToPhysical"), 3);
        for (std::size_t a = 0; a < 3; ++a) {
            plan.geometry.size[a] = whole(size[a], 1, kMost);
            plan.geometry.indexToPhysical.column[a] = vectorOf(axes[a]);
        }
        plan.geometry.originMm = vectorOf(member(json_, "originMm"));
        const double volume = plan.geometry.voxelVolumeMm3();
        if (!(volume > 0) || !std::isfinite(volume)) refusePlan(name_, "indexToPhysical");
        const std::string type = text(json_, "pixelType");
        for (int n = 0; n <= static_cast<int>(PixelType::Float64); ++n) {
            plan.pixelType = static_cast<PixelType>(n);
            if (toString(plan.pixelType) == type) return;
        }
        refusePlan(name_, "pixelType");
    }

    void readTiles(GiantPlan& plan) const {
        Index3 count;
        try {
            count = plan.cut().tiles();
        } catch (const InvalidInput& error) {
            refusePlan(name_, error.what());
        }
        const Json& tiles = member(json_, "tiles");
        if (!tiles.is_array()) refusePlan(name_, "tiles");
        for (const Json& id : tiles) {
            const std::optional<Index3> tile =
                id.is_string() ? placeOf(id.get_ref<const std::string&>()) : std::nullopt;
            if (!tile || (*tile)[0] >= count[0] || (*tile)[1] >= count[1] ||
                (*tile)[2] >= count[2] ||
                (!plan.tiles.empty() && orderOf(plan.tiles.back()) >= orderOf(*tile))) {
                refusePlan(name_, "tiles");
            }
            plan.tiles.push_back(*tile);
        }
    }

    const Json& json_;
    const std::string& name_;
};

}  // namespace

std::vector<Index3> GiantPlan::seams() const {
    if (!isAdaptive()) return {};
    std::set<std::array<std::int64_t, 3>> found;
    const Index3 count = cut().seams();
    for (const Index3& tile : tiles) {
        for (int n = 0; n < 8; ++n) {
            Index3 seam;
            bool isThere = true;
            for (int a = 0; a < 3; ++a) {
                seam[a] = tile[a] - (n >> a & 1);
                isThere = isThere && seam[a] >= 0 && seam[a] < count[a];
            }
            if (isThere) found.insert(orderOf(seam));
        }
    }
    std::vector<Index3> list;
    for (const auto& [z, y, x] : found) list.push_back({x, y, z});
    return list;
}

std::array<std::int64_t, 3> orderOf(const Index3& place) {
    return {place[2], place[1], place[0]};
}

std::string GiantPlan::identity() const {
    return identityJson(*this).dump();
}

std::filesystem::path GiantPlan::fileIn(const std::filesystem::path& work) {
    return work / "plan.json";
}

std::string encodePlan(const GiantPlan& plan) {
    Json json = identityJson(plan);
    json["warnings"] = Json::array();
    for (const Warning& warning : plan.warnings) {
        json["warnings"].push_back({{"code", warning.code}, {"text", warning.text}});
    }
    json["tiles"] = ids(plan.tiles);
    json["seams"] = ids(plan.seams());
    return json.dump(1) + "\n";
}

GiantPlan decodePlan(std::string_view text, const std::string& name) {
    const Json json = Json::parse(text, nullptr, false);
    if (json.is_discarded()) refusePlan(name, "JSON");
    return PlanReader(json, name).read();
}

std::string idOf(const Index3& place) {
    return std::to_string(place[0]) + "_" + std::to_string(place[1]) + "_" +
           std::to_string(place[2]);
}

std::optional<Index3> placeOf(std::string_view id) {
    Index3 place{0, 0, 0};
    const char* at = id.data();
    const char* const end = at + id.size();
    for (int a = 0; a < 3; ++a) {
        if (a > 0 && (at == end || *at++ != '_')) return std::nullopt;
        const auto [next, error] = std::from_chars(at, end, place[a]);
        if (error != std::errc() || place[a] < 0) return std::nullopt;
        at = next;
    }
    if (at != end || id != idOf(place)) return std::nullopt;
    return place;
}

}  // namespace adaptiso::giant
