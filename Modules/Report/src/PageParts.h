#pragma once

#include <string>
#include <vector>

#include "Scene.h"
#include "adaptiso/Report/Pictures.h"
#include "adaptiso/Report/Report.h"

namespace adaptiso {

/// `text` as it can stand in HTML, in an element or a quoted attribute. What is not UTF-8 becomes
/// U+FFFD, and so do control characters.
std::string escaped(const std::string& text);

std::string factsHtml(const Report& report);
/// The places to look at: buttons where there is a viewer to move, else text.
std::string spotsHtml(const Scene& scene, bool hasViewer);
std::string checksHtml(const Report& report);
std::string tablesHtml(const Report& report);
std::string picturesHtml(const std::vector<Picture>& pictures);
std::string notesHtml(const std::vector<std::string>& notes);

}  // namespace adaptiso
