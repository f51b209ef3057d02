#include "adaptiso/MeshIO/CoordinateFrame.h"

#include <array>

namespace adaptiso {
namespace {

constexpr std::array kFrames{CoordinateFrame::Ras, CoordinateFrame::Lps, CoordinateFrame::TkRas,
                             CoordinateFrame::Voxel};
constexpr std::string_view kMarker = "CoordinateFrame: ";

}  // namespace

std::string_view toString(CoordinateFrame frame) {
    switch (frame) {
        case CoordinateFrame::Ras:
            return "RAS mm";
        case CoordinateFrame::Lps:
            return "LPS mm";
        case CoordinateFrame::TkRas:
            return "tkRAS mm";
        case CoordinateFrame::Voxel:
            return "voxel indices";
    }
    return "unknown";
}

std::string frameMarker(CoordinateFrame frame) {
    return std::string(kMarker).append(toString(frame));
}

std::optional<CoordinateFrame> findFrameMarker(std::string_view text) {
    const std::size_t begin = text.find(kMarker);
    if (begin == std::string_view::npos) return std::nullopt;
    const std::string_view name = text.substr(begin + kMarker.size());
    for (const CoordinateFrame frame : kFrames) {
        if (name.starts_with(toString(frame))) return frame;
    }
    return std::nullopt;
}

std::optional<CoordinateFrame> parseCoordinateFrame(std::string_view name) {
    for (const CoordinateFrame frame : kFrames) {
        if (name == toString(frame)) return frame;
    }
    return std::nullopt;
}

std::string_view slicerName(CoordinateFrame frame) {
    return frame == CoordinateFrame::Ras ? "RAS" : frame == CoordinateFrame::Lps ? "LPS" : "";
}

std::string slicerMarker(CoordinateFrame frame) {
    const std::string_view name = slicerName(frame);
    return name.empty() ? std::string() : "SPACE=" + std::string(name);
}

}  // namespace adaptiso
