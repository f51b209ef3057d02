#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <string>

#include "adaptiso/Core/Warning.h"

/// A Warning is an adaptiso._arguments.Warned in Python, which is a str; any str is a Warning.
template <>
struct pybind11::detail::type_caster<adaptiso::Warning> {
    PYBIND11_TYPE_CASTER(adaptiso::Warning, const_name("str"));

    bool load(handle from, bool) {
        if (!PyUnicode_Check(from.ptr())) return false;
        const bool isWarned = hasattr(from, "code");
        value.text = (isWarned ? from.attr("text") : from).cast<std::string>();
        if (!isWarned) return true;
        value.code = from.attr("code").cast<std::string>();
        value.file = from.attr("file").cast<std::string>();
        return true;
    }
    static handle cast(const adaptiso::Warning& from, return_value_policy, handle) {
        const module_ module = module_::import("adaptiso._arguments");
        return module.attr("Warned")(from.text, from.code, from.file).release();
    }
};
