#include "OptionRows.h"

#include <initializer_list>

#include "Words.h"
#include "adaptiso/Extraction/Components.h"
#include "adaptiso/Extraction/Extraction.h"
#include "adaptiso/Extraction/Simplify.h"
#include "adaptiso/HeadPipeline/BemRules.h"
#include "adaptiso/ImageIO/ReadVolume.h"
#include "adaptiso/Json/OptionsJson.h"

namespace adaptiso::python {
namespace {

Json joined(std::initializer_list<Json> lists) {
    Json all = Json::array();
    for (const Json& list : lists) all.insert(all.end(), list.begin(), list.end());
    return all;
}

/// Rows of the functions that take options, as JSON.
std::string optionRows() {
    Json border = Json::array();
    for (const Json& row : describe(indexOptions())) {
        if (row["name"] == "border") border.push_back(row);
    }
    return dumped(
        {{"surface", joined({describe(aimOptions(AimedSurface::OfScan)), describe(methodOptions()),
                             border, describe(pieceOptions())})},
         {"simplify",
          joined({describe(aimOptions(AimedSurface::Mesh)), describe(borderOptions())})},
         {"labels", describe(aimOptions(AimedSurface::Walls))},
         {"bem", describe(boundaryOptions())},
         {"read", describe(readOptions())}});
}

}  // namespace

OptionValue toOptionValue(const py::handle& value, OptionKind kind) {
    if (value.is_none()) return {};
    switch (kind) {
        case OptionKind::Flag:
            return value.cast<bool>();
        case OptionKind::Number:
            return value.cast<double>();
        case OptionKind::Count:
            return value.cast<std::int64_t>();
        case OptionKind::Choice:
        case OptionKind::Text:
            break;
    }
    return value.cast<std::string>();
}

void declareOptions(py::module_& module) {
    module.def("option_rows", &optionRows);
}

}  // namespace adaptiso::python
