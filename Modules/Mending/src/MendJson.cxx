#include "adaptiso/Mending/MendJson.h"

#include <algorithm>
#include <cstdint>
#include <string_view>

#include "adaptiso/Core/Phrases.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso {
namespace {

/// A count of faults, its key in the report and its words.
struct FaultRow {
    std::string_view key;
    std::int64_t MendStatistics::*count;
    const char *one, *many;
};

constexpr FaultRow kFaults[] = {
    {"borderEdges", &MendStatistics::borderEdges, "open border edge", "open border edges"},
    {"badEdges", &MendStatistics::badEdges, "edge that is no manifold's",
     "edges that are no manifold's"},
    {"badVertices", &MendStatistics::badVertices, "vertex whose triangles are not one fan",
     "vertices whose triangles are not one fan"},
    {"crossingTriangles", &MendStatistics::crossingTriangles, "triangle that crosses another",
     "triangles that cross others"},
    {"flippedTriangles", &MendStatistics::flippedTriangles, "triangle that faced the other way",
     "triangles that faced the other way"},
    {"brokenTriangles", &MendStatistics::brokenTriangles,
     "triangle that names a point that is not there or not finite, dropped",
     "triangles that name points that are not there or not finite, dropped"},
    {"degenerateTriangles", &MendStatistics::degenerateTriangles, "triangle without area, dropped",
     "triangles without area, dropped"},
    {"duplicateTriangles", &MendStatistics::duplicateTriangles,
     "triangle on the corners of another, dropped", "triangles on the corners of others, dropped"},
    {"mergedPoints", &MendStatistics::mergedPoints, "point of a border merged with another",
     "points of borders merged with others"},
    {"handles", &MendStatistics::handles, "handle", "handles"},
};

/// Places, their key in the report and their words.
struct PlacesRow {
    std::string_view key;
    std::vector<MendedPlace> MendStatistics::*places;
    const char *one, *many;
};

const PlacesRow kPlaces[] = {
    {"filled", &MendStatistics::filled, "hole closed", "holes closed"},
    {"leftOpen", &MendStatistics::leftOpen, "hole left open", "holes left open"},
    {"inner", &MendStatistics::inner, "part inside the solid dropped",
     "parts inside the solid dropped"},
    {"thin", &MendStatistics::thin, "part too thin for the bound dropped",
     "parts too thin for the bound dropped"},
    {"droppedPieces", &MendStatistics::droppedPieces, "piece left out", "pieces left out"},
    {"cutHandles", &MendStatistics::cutHandles, "handle cut", "handles cut"},
    {"filledHandles", &MendStatistics::filledHandles, "handle filled", "handles filled"},
};

}  // namespace

Json mendFaultsJson(const MendStatistics& statistics) {
    Json json = Json::object();
    for (const FaultRow& row : kFaults) json[std::string(row.key)] = statistics.*row.count;
    return json;
}

std::vector<std::string> mendFaultTexts(const MendStatistics& statistics) {
    std::vector<std::string> texts;
    for (const FaultRow& row : kFaults) {
        const std::int64_t count = statistics.*row.count;
        if (count > 0) texts.push_back(counted(count, row.one, row.many));
    }
    return texts;
}

Json mendPlacesJson(const MendStatistics& statistics) {
    Json json = Json::object();
    for (const PlacesRow& row : kPlaces) {
        Json list = Json::array();
        for (const MendedPlace& place : statistics.*row.places) {
            list.push_back({{"middleMm", vector(place.middleMm)},
                            {"spanMm", number(place.spanMm)},
                            {"areaMm2", number(place.areaMm2)},
                            {"triangles", place.triangles}});
        }
        json[std::string(row.key)] = std::move(list);
    }
    return json;
}

std::vector<std::string> mendPlaceTexts(const MendStatistics& statistics) {
    std::vector<std::string> texts;
    for (const PlacesRow& row : kPlaces) {
        const std::vector<MendedPlace>& places = statistics.*row.places;
        if (places.empty()) continue;
        constexpr std::int64_t kMany = 100'000;
        double area = 0;
        std::int64_t triangles = 0;
        for (const MendedPlace& place : places) {
            area += place.areaMm2;
            triangles += place.triangles;
        }
        const bool isFine = row.places == &MendStatistics::filled && triangles > kMany;
        const MendedPlace& widest = places.front();
        texts.push_back(
            counted(std::ssize(places), row.one, row.many) + ", " + formatMeasure(area) +
            " mm2; the widest spans " + formatMeasure(widest.spanMm) + " mm, around " +
            formatShort(widest.middleMm.x) + ", " + formatShort(widest.middleMm.y) + ", " +
            formatShort(widest.middleMm.z) +
            (isFine ? "; " + formatCount(triangles) + " triangles, fewer with a larger --max-error"
                    : ""));
    }
    return texts;
}

std::vector<std::pair<std::string, MendedPlace>> mendPlaces(const MendStatistics& statistics) {
    std::vector<std::pair<std::string, MendedPlace>> all;
    for (const PlacesRow& row : kPlaces) {
        for (const MendedPlace& place : statistics.*row.places) all.emplace_back(row.one, place);
    }
    return all;
}

std::optional<Warning> mendWarning(const MendStatistics& statistics, double areaMm2,
                                   const std::string& file) {
    constexpr double kMostPart = 0.05;
    double dropped = 0;
    for (const MendedPlace& part : statistics.thin) dropped += part.areaMm2;
    if (!(dropped > kMostPart * areaMm2)) return std::nullopt;
    const bool isOne = statistics.thin.size() == 1;
    return Warning{
        "parts-dropped",
        counted(std::ssize(statistics.thin), "part", "parts") + " too thin for the bound, " +
            formatFixed(100 * std::min(1.0, dropped / areaMm2), 0) + " % of the surface's area, " +
            (isOne ? "was" : "were") + " dropped: a sheet without thickness is no solid",
        file};
}

std::string mendDistanceText(const MendStatistics& statistics, double roundingMm) {
    const bool hasDiscs = !statistics.cutHandles.empty() || !statistics.filledHandles.empty();
    const bool hasDropped =
        !statistics.inner.empty() || !statistics.thin.empty() || !statistics.droppedPieces.empty();
    return "no point farther than " + formatBound(statistics.resultToInputMm + roundingMm) +
           " mm from the input" + (statistics.filled.empty() ? "" : ", but for the closed holes") +
           (hasDiscs ? ", but for the discs at handles" : "") +
           "; no point of the input farther than " +
           formatBound(statistics.inputToResultMm + roundingMm) + " mm from it" +
           (hasDropped ? ", but for what was dropped" : "") + " (proved)";
}

}  // namespace adaptiso
