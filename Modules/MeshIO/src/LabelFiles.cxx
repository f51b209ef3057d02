#include "adaptiso/MeshIO/LabelFiles.h"

#include <limits>

#include "Bytes.h"
#include "GiftiArrays.h"
#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso {
namespace {

void encodeKey(const LabelKey& label, bool isSeen, ByteSink& sink) {
    sink << "<Label Key=\"" << std::int64_t{label.key} << "\"";
    constexpr const char* kChannels[] = {" Red=\"", " Green=\"", " Blue=\""};
    for (std::size_t n = 0; n < 3; ++n) sink << kChannels[n] << label.color[n] / 255.0 << "\"";
    sink << " Alpha=\"" << (isSeen ? "1" : "0") << "\">" << escapedMarkup(label.name)
         << "</Label>\n";
}

}  // namespace

void writeGiftiLabels(std::span<const std::int32_t> labels, std::span<const LabelKey> table,
                      const std::filesystem::path& path) {
    constexpr std::size_t kMost = std::numeric_limits<std::int32_t>::max();
    if (labels.empty() || labels.size() > kMost) {
        throw InvalidInput(path.string() + ": GIFTI holds the labels of 1 to " +
                           std::to_string(kMost) + " points, not of " +
                           std::to_string(labels.size()));
    }
    std::string bytes;
    bytes.reserve(labels.size_bytes());
    for (const std::int32_t label : labels) appendLittleEndian(label, bytes);
    writeBytes(path, [&](ByteSink& sink) {
        sink << meshio::kGiftiHead
             << "<GIFTI Version=\"1.0\" NumberOfDataArrays=\"1\">\n<MetaData/>\n<LabelTable>\n";
        bool hasNone = false;
        for (const LabelKey& label : table) hasNone = hasNone || label.key == 0;
        if (!hasNone) encodeKey({0, "???", {255, 255, 255}}, false, sink);
        for (const LabelKey& label : table) encodeKey(label, true, sink);
        sink << "</LabelTable>\n";
        meshio::beginGiftiArray("NIFTI_INTENT_LABEL", "NIFTI_TYPE_INT32",
                                {static_cast<std::int64_t>(labels.size()), 1}, sink);
        sink << "<MetaData/>\n";
        meshio::endGiftiArray(bytes, sink);
        sink << "</GIFTI>\n";
    });
}

void writeMultiBlock(std::span<const VtkBlock> blocks, const std::filesystem::path& path) {
    writeBytes(path, [&](ByteSink& sink) {
        sink << "<?xml version=\"1.0\"?>\n<VTKFile type=\"vtkMultiBlockDataSet\" version=\"1.0\" "
                "byte_order=\"LittleEndian\">\n<vtkMultiBlockDataSet>\n";
        std::int64_t index = 0;
        for (const VtkBlock& block : blocks) {
            sink << "<DataSet index=\"" << index++ << "\" name=\"" << escapedMarkup(block.name)
                 << "\" file=\"" << escapedMarkup(block.file) << "\"/>\n";
        }
        sink << "</vtkMultiBlockDataSet>\n</VTKFile>\n";
    });
}

}  // namespace adaptiso
