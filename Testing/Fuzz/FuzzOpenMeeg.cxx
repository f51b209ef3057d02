// libFuzzer target: bytes that claim to be a .geom and, from the first line that begins with
// "# Properties" on, a .cond; a.tri, b.tri and c.tri are sound. They are refused with a
// FileError or give a model.

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "InputFolder.h"
#include "OneLine.h"
#include "adaptiso/HeadModel/ExportOpenMeeg.h"

namespace {

constexpr const char* kTetrahedron =
    "- 4\n0 0 0 -0.6 -0.6 -0.529150262\n1 0 0 1 0 0\n0 1 0 0 1 0\n0 0 1 0 0 1\n- 4 4 4\n"
    "0 2 1\n0 1 3\n0 3 2\n1 2 3\n";

const adaptiso::fuzz::InputFolder& inputFolder() {
    static const adaptiso::fuzz::InputFolder folder;
    static const bool hasSurfaces = [] {
        for (const char* name : {"a.tri", "b.tri", "c.tri"}) folder.write(name, kTetrahedron);
        return true;
    }();
    static_cast<void>(hasSurfaces);
    return folder;
}

void requireSound(const adaptiso::OpenMeegModel& model) {
    for (const auto& domain : model.domains) {
        for (const auto* sides : {&domain.inside, &domain.outside}) {
            for (const std::size_t interface : *sides) {
                if (interface >= model.interfaces.size()) std::abort();
            }
        }
        if (!(domain.conductivity >= 0)) std::abort();
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view bytes(reinterpret_cast<const char*>(data), size);
    const std::size_t cut = std::min(bytes.find("# Properties"), size);
    const auto geometry = inputFolder().write("m.geom", bytes.substr(0, cut));
    const auto conductivities = inputFolder().write("m.cond", bytes.substr(cut));
    try {
        requireSound(adaptiso::readOpenMeegModel(geometry, conductivities));
    } catch (const adaptiso::FileError& refusal) {
        adaptiso::fuzz::requireOneLine(refusal);
    }
    return 0;
}
