#include <array>
#include <string_view>

#include "Common/CommonFrame.h"
#include "Run.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Text.h"
#include "adaptiso/MeshIO/Formats.h"

namespace adaptiso::simplifier {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMark = "simplified";

/// Length of an ending of two parts; 0 without one.
std::size_t twoPartEnding(const std::string& name) {
    constexpr std::array<std::string_view, 4> kEndings{".surf.gii", ".shape.gii", ".func.gii",
                                                       ".label.gii"};
    const std::string lower = lowerCase(name);
    for (const std::string_view ending : kEndings) {
        if (lower.size() > ending.size() && lower.ends_with(ending)) return ending.size();
    }
    return 0;
}

bool isFreeSurfer(const fs::path& path) {
    try {
        return findMeshFormat(path).defaultFrame == CoordinateFrame::TkRas;
    } catch (const InvalidInput&) {
        return false;
    }
}

bool areSame(const fs::path& a, const fs::path& b) {
    std::error_code error;
    return fs::weakly_canonical(fs::absolute(a), error) ==
           fs::weakly_canonical(fs::absolute(b), error);
}

/// Between what comes before the last point, or an ending of two parts, and what follows.
std::string marked(const std::string& name) {
    const std::size_t two = twoPartEnding(name);
    const std::size_t point = two > 0 ? name.size() - two : name.rfind('.');
    const std::size_t at = point == std::string::npos ? name.size() : point;
    return name.substr(0, at) + "." + std::string(kMark) + name.substr(at);
}

}  // namespace

PageFrame pageFrame(const MeshFile& input) {
    const CoordinateFrame frame = input.frame.value_or(CoordinateFrame::Ras);
    if (!needsVolume(frame) || input.volume) {
        return {inverse(lpsToFrame(frame, input.volume)),
                input.frame ? "scanner RAS mm" : kUnsaidFrame};
    }
    return {inverse(lpsToFrame(CoordinateFrame::Ras, std::nullopt)),
            frame == CoordinateFrame::TkRas ? "FreeSurfer's tkRAS mm" : "voxel indices"};
}

bool isFolder(const fs::path& path) {
    std::error_code error;
    return !path.empty() && (!path.has_filename() || fs::is_directory(path, error));
}

std::string surfaceName(const fs::path& input) {
    const std::string name = input.filename().string();
    if (const std::size_t two = twoPartEnding(name)) return name.substr(0, name.size() - two);
    return isFreeSurfer(input) ? name : input.stem().string();
}

fs::path surfaceFile(const fs::path& output, const fs::path& input) {
    return isFolder(output) ? output / input.filename() : output;
}

fs::path dataFile(const fs::path& data, const fs::path& surface) {
    const std::string name = data.filename().string();
    const fs::path file = surface.parent_path() / name;
    return areSame(file, data) ? surface.parent_path() / marked(name) : file;
}

}  // namespace adaptiso::simplifier
