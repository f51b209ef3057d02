#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>

namespace adaptiso::meshio {

using XmlAttributes = std::map<std::string, std::string, std::less<>>;

/// The value of `name`; damage if the element has none.
const std::string& requireAttribute(const XmlAttributes& attributes, std::string_view name);
/// The value of `name`, or `otherwise`.
std::string attributeOr(const XmlAttributes& attributes, std::string_view name,
                        std::string_view otherwise);

/// What parseXml() calls, in document order.
class XmlHandler {
public:
    virtual ~XmlHandler() = default;
    virtual void onStart(const std::string& element, const XmlAttributes& attributes) = 0;
    virtual void onEnd(const std::string& element) = 0;
    virtual void onText(std::string_view text) = 0;
    /// Asked after each onStart(): true ends parsing there.
    virtual bool isDone() const { return false; }
};

/// Parses the XML in `bytes` (expat). No other file or address is opened, whatever the document
/// says; documents that declare entities are refused. Malformed XML is damage; exceptions of the
/// handler come through.
/// \return  the position at which parsing ended: the '<' of the element at which the handler was
///          done, or the end of the bytes
std::size_t parseXml(std::string_view bytes, XmlHandler& handler);

}  // namespace adaptiso::meshio
