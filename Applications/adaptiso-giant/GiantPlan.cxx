#include "adaptiso-giant/GiantPlan.h"

#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/ParseJson.h"
#include "adaptiso/Json/OptionsJson.h"

namespace adaptiso::giant {
namespace {

constexpr const char* kSchema = "adaptiso-giant-plan/1";

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
            {"read", valuesJson(readOptions(), plan.read)},
            {"format", plan.format},
            {"sizeVoxels", plan.geometry.size},
            {"originMm", vectorJson(plan.geometry.originMm)},
            {"indexToPhysical",
             {vectorJson(axes.column[0]), vectorJson(axes.column[1]), vectorJson(axes.column[2])}},
            {"pixelType", toString(plan.pixelType)},
            {"isovalue", plan.isovalue},
            {"method", toString(plan.method)},
            {"maxErrorMm", plan.maxErrorMm},
            {"leavesNoise", plan.leavesNoise},
            {"side", plan.side}};
}

[[noreturn]] void refusePlan(const std::string& name, const std::string& what) {
    throw FileError(name + ": is no plan of adaptiso-giant, or damaged (" + what +
                    "); make it again with: adaptiso-giant plan");
}

std::int64_t countOf(const Json& json) {
    return static_cast<std::int64_t>(json.get_ref<const Json::number_unsigned_t&>());
}

Vec3 vectorOf(const Json& json) {
    return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

/// The values of a plan; that they are those of encodePlan() is to be checked.
/// \throws Json::exception  one is missing, or of another type
GiantPlan planFrom(const Json& json) {
    GiantPlan plan;
    plan.version = json.at("version").get<std::string>();
    plan.input = json.at("input").get<std::string>();
    const Json& read = json.at("read");
    for (const auto& row : readOptions()) {
        row.put(plan.read, optionValue(read.at(row.facts.key), row.kind));
    }
    plan.format = json.at("format").get<std::string>();
    for (std::size_t a = 0; a < 3; ++a) {
        plan.geometry.size[a] = countOf(json.at("sizeVoxels").at(a));
        plan.geometry.indexToPhysical.column[a] = vectorOf(json.at("indexToPhysical").at(a));
    }
    plan.geometry.originMm = vectorOf(json.at("originMm"));
    for (int n = 0; n <= static_cast<int>(PixelType::Float64); ++n) {
        const auto type = static_cast<PixelType>(n);
        if (json.at("pixelType") == toString(type)) plan.pixelType = type;
    }
    plan.isovalue = json.at("isovalue");
    plan.method = json.at("method") == "mc" ? Method::MarchingCubes : Method::Adaptive;
    plan.maxErrorMm = json.at("maxErrorMm");
    plan.leavesNoise = json.at("leavesNoise");
    plan.side = countOf(json.at("side"));
    for (const Json& warning : json.at("warnings")) {
        plan.warnings.push_back({warning.at("code"), warning.at("text")});
    }
    for (const Json& id : json.at("tiles")) {
        plan.tiles.push_back(placeOf(id.get<std::string>()).value_or(Index3{}));
    }
    return plan;
}

/// Returns the key of the first value outside its range, or why the tiles do not fit. Empty: sound.
std::string faultOf(const GiantPlan& plan) {
    constexpr std::int64_t kMost = 1 << 20;
    for (const std::int64_t extent : plan.geometry.size) {
        if (extent < 1 || extent > kMost) return "sizeVoxels";
    }
    const double volume = plan.geometry.voxelVolumeMm3();
    if (!(volume > 0) || !std::isfinite(volume)) return "indexToPhysical";
    if (plan.isAdaptive() && !(plan.maxErrorMm > 0)) return "maxErrorMm";
    if (plan.side < 1 || plan.side > TileCut::kLargestSide) return "side";
    Index3 count;
    try {
        count = plan.cut().tiles();
    } catch (const InvalidInput& error) {
        return error.what();
    }
    for (std::size_t n = 0; n < plan.tiles.size(); ++n) {
        const Index3& tile = plan.tiles[n];
        const bool isAscending = n == 0 || orderOf(plan.tiles[n - 1]) < orderOf(tile);
        const bool isThere = tile[0] < count[0] && tile[1] < count[1] && tile[2] < count[2];
        if (!isAscending || !isThere) return "tiles";
    }
    return "";
}

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
    try {
        GiantPlan plan = planFrom(parseJson<Json>(text));
        if (const std::string fault = faultOf(plan); !fault.empty()) refusePlan(name, fault);
        if (encodePlan(plan) != text) refusePlan(name, "not as it was written");
        return plan;
    } catch (const Json::exception&) {
        refusePlan(name, "JSON");
    }
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
