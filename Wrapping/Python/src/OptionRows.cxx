#include "OptionRows.h"

#include <pybind11/stl.h>

#include <algorithm>
#include <initializer_list>

#include "Words.h"
#include "adaptiso/Core/Habits.h"
#include "adaptiso/Extraction/Components.h"
#include "adaptiso/Extraction/Extraction.h"
#include "adaptiso/Extraction/Simplify.h"
#include "adaptiso/HeadPipeline/BemRules.h"
#include "adaptiso/ImageIO/ReadVolume.h"
#include "adaptiso/Json/OptionsJson.h"
#include "adaptiso/Mending/Mend.h"
#include "adaptiso/Preprocessing/Preprocess.h"
#include "adaptiso/SurfaceChecks/Checks.h"
#include "adaptiso/Tetrahedra/MesherFiles.h"

namespace adaptiso::python {
namespace {

Json joined(std::initializer_list<Json> lists) {
    Json all = Json::array();
    for (const Json& list : lists) all.insert(all.end(), list.begin(), list.end());
    return all;
}

/// The rows, but those that a function takes otherwise or not at all.
Json without(std::initializer_list<std::string_view> names, const Json& rows) {
    Json some = Json::array();
    for (const Json& row : rows) {
        if (std::ranges::find(names, row["name"].get<std::string_view>()) == names.end()) {
            some.push_back(row);
        }
    }
    return some;
}

/// Rows of the functions that take options, as JSON.
std::string optionRows() {
    const Json rules = joined({describe(ruleOptions()), describe(pairOptions())});
    const Json border = without({"block-size", "search"}, describe(indexOptions()));
    return dumped(
        {{"surface", joined({describe(aimOptions(AimedSurface::OfScan)), describe(methodOptions()),
                             border, describe(pieceOptions()), describe(preprocessOptions())})},
         {"check", without({"profile", "min-gap", "max-off"}, rules)},
         {"check_nested", without({"profile", "max-off"}, rules)},
         {"simplify",
          joined({describe(aimOptions(AimedSurface::Mesh)), describe(simplifyOptions())})},
         {"mend", joined({describe(mendOptions()), describe(pieceOptions())})},
         {"labels", describe(aimOptions(AimedSurface::Walls))},
         {"bem", joined({describe(boundaryOptions()), describe(sourceOptions()),
                         describe(elementOptions())})},
         {"read", describe(readOptions())},
         {"giant", without({"resample-slices"}, describe(readOptions()))}});
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
    module.def("habit_answer", &habitAnswer, py::arg("program"), py::arg("typed"),
               py::arg("known"));
}

}  // namespace adaptiso::python
