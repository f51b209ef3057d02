#pragma once

#include <pybind11/pybind11.h>

#include <algorithm>
#include <string>

#include "adaptiso/Core/Errors.h"
#include "adaptiso/Core/Options.h"
#include "adaptiso/Core/SimplifyAims.h"

namespace adaptiso::python {

namespace py = pybind11;

/// "max-error" -> "max_error"
inline std::string argumentName(const OptionFacts& facts) {
    std::string name(facts.name);
    std::ranges::replace(name, '-', '_');
    return name;
}

/// \pre  of the row's kind: the Python half has checked it
OptionValue toOptionValue(const py::handle& value, OptionKind kind);

/// Puts the arguments that rows name into `owner`.
template <class Owner>
void take(const Options<Owner>& rows, std::type_identity_t<Owner>& owner, const py::dict& given) {
    for (const Option<Owner>& row : rows) {
        const std::string name = argumentName(row.facts);
        if (!given.contains(name)) continue;
        row.put(owner, toOptionValue(given[name.c_str()], row.kind));
    }
}

/// The same of a surface's aims. \throws InvalidInput  a count by both of its names
inline void takeAims(AimedSurface surface, SimplifyAims& aims, const py::dict& given) {
    take(aimOptions(surface), aims, given);
    if (aims.maxTriangles && aims.reduction) {
        throw InvalidInput("triangles and reduction: are two ways to ask for one count");
    }
}

void declareOptions(py::module_& module);

}  // namespace adaptiso::python
