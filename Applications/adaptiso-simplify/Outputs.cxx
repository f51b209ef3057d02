#include "Common/CommonFrame.h"
#include "Common/Naming.h"
#include "Run.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/MeshIO/Formats.h"

namespace adaptiso::simplifier {
namespace {

namespace fs = std::filesystem;

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

std::string surfaceName(const fs::path& input) {
    const std::string name = input.filename().string();
    if (const std::size_t two = twoPartExtension(name)) return name.substr(0, name.size() - two);
    return isFreeSurfer(input) ? name : input.stem().string();
}

fs::path surfaceFile(const fs::path& output, const fs::path& input) {
    if (output.empty()) return insertBeforeExtension(input.filename(), "-simplified");
    return isFolder(output) ? output / input.filename() : output;
}

fs::path dataFile(const fs::path& data, const fs::path& surface) {
    const fs::path file = surface.parent_path() / data.filename();
    return areSame(file, data) ? insertBeforeExtension(file, ".simplified") : file;
}

}  // namespace adaptiso::simplifier
