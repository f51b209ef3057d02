#pragma once

#include <string_view>

/// The files of page/, and niivue's script, as they were when the library was built.
namespace adaptiso::embedded {

std::string_view pageHtml();
std::string_view notebookHtml();
std::string_view viewerHtml();
std::string_view styleCss();
std::string_view unpackJs();
std::string_view summaryJs();
std::string_view viewerJs();
std::string_view niivueJs();  ///< empty when niivue could not be had
std::string_view licenses();

/// Of the scripts' bytes, in hexadecimal; empty for an empty one.
std::string_view unpackJsSha256();
std::string_view summaryJsSha256();
std::string_view viewerJsSha256();
std::string_view niivueJsSha256();

}  // namespace adaptiso::embedded
