// libFuzzer target: bytes that claim to be the record of a run. They are refused without an error
// thrown, or name files below the record's folder alone.

#include <cstdint>
#include <cstdlib>

#include "Common/BatchRecord.h"
#include "InputFolder.h"
#include "adaptiso/Core/FoundFiles.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const adaptiso::fuzz::InputFolder folder;
    const std::filesystem::path file =
        folder.write("a.adaptiso-mesh.json", {reinterpret_cast<const char*>(data), size});
    adaptiso::RunRecord record;
    if (adaptiso::readRecord(file, record) != adaptiso::RecordFault::None) return 0;
    for (const std::string& output : record.outputs) {
        if (!adaptiso::staysBelow(output)) std::abort();
    }
    for (const adaptiso::RecordedFile& output : record.recordedOutputs) {
        if (!adaptiso::staysBelow(output.file)) std::abort();
    }
    return 0;
}
