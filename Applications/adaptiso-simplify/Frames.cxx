#include "Common/CommonFrame.h"
#include "Run.h"
#include "adaptiso/Core/Errors.h"

namespace adaptiso::simplifier {
namespace {

bool needsVolume(CoordinateFrame frame) {
    return frame == CoordinateFrame::TkRas || frame == CoordinateFrame::Voxel;
}

}  // namespace

FrameChange changeFrame(const MeshFile& input, std::optional<CoordinateFrame> wanted,
                        const MeshFormat& output) {
    FrameChange change;
    change.isSaid = input.frame || wanted;
    const CoordinateFrame from = input.frame.value_or(CoordinateFrame::Ras);
    change.frame = wanted.value_or(from);
    if (!input.frame && (wanted || output.id == MeshFormatId::FreeSurfer)) {
        const char* const what = wanted ? "--coordinates" : "FreeSurfer's format";
        throw InvalidInput("does not say its coordinate frame, which " + std::string(what) +
                           " needs" + kStateIt);
    }
    if (change.frame == from) return change;
    for (const CoordinateFrame frame : {from, change.frame}) {
        if (!needsVolume(frame) || input.volume) continue;
        throw InvalidInput("is in " + std::string(toString(from)) +
                           ", and does not say the volume by which it would be in " +
                           std::string(toString(change.frame)));
    }
    change.move = lpsToFrame(change.frame, input.volume) * inverse(lpsToFrame(from, input.volume));
    return change;
}

PageFrame pageFrame(const MeshFile& input) {
    const CoordinateFrame frame = input.frame.value_or(CoordinateFrame::Ras);
    if (!needsVolume(frame) || input.volume) {
        return {inverse(lpsToFrame(frame, input.volume)),
                input.frame ? "scanner RAS mm" : kUnsaidFrame};
    }
    return {inverse(lpsToFrame(CoordinateFrame::Ras, std::nullopt)),
            frame == CoordinateFrame::TkRas ? "FreeSurfer's tkRAS mm" : "voxel indices"};
}

}  // namespace adaptiso::simplifier
