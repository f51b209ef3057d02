// The LabelTable of a GIFTI file, and FSL's atlases, both in XML.
#include <algorithm>
#include <utility>
#include <vector>

#include "Rows.h"
#include "adaptiso/Core/TextLines.h"
#include "adaptiso/MeshIO/Xml.h"

namespace adaptiso::labelnames {
namespace {

/// Collects what both formats have: elements of a label with attributes and a name.
class Labels final : public meshio::XmlHandler {
public:
    using Attributes = meshio::XmlAttributes;

    void onStart(const std::string& element, const Attributes& attributes) override {
        if (depth_++ == 0) {
            isGifti = element == "GIFTI";
            if (!isGifti && element != "atlas") refuseKind("its XML is a " + printable(element));
        }
        text_.clear();
        if (element == (isGifti ? "Label" : "label")) {
            attributes_ = attributes;
            isInLabel_ = true;
        }
    }
    void onEnd(const std::string& element) override {
        --depth_;
        if (element == "type") isProbabilistic_ = lowerCase(trimmed(text_)) != "label";
        if (isInLabel_ && element == (isGifti ? "Label" : "label")) {
            isInLabel_ = false;
            rows_.push_back({std::move(attributes_), text_});
        }
        text_.clear();
    }
    void onText(std::string_view more) override {
        constexpr std::size_t kLongest = 1 << 16;  // skips the data of a GIFTI file
        if (text_.size() < kLongest) text_ += more.substr(0, kLongest);
    }

    LabelTable finish() const {
        Collector found(isGifti ? "GIFTI" : "FSL");
        for (const auto& [attributes, name] : rows_) {
            found.add(entryOf(attributes, name, found));
        }
        return found.finish();
    }

    bool isGifti = false;

private:
    static std::int32_t numberOf(const Attributes& attributes, const char* name) {
        const auto at = attributes.find(name);
        if (at == attributes.end()) damaged("a label lacks the attribute " + std::string(name));
        const std::optional<std::int64_t> value = wholeNumber(at->second);
        constexpr std::int64_t kMost = (std::int64_t{1} << 31) - 2;
        if (!value || *value < -kMost || *value > kMost) {
            damaged("a label's " + std::string(name) + " is " + printable(at->second) +
                    ", must be a whole number that 32 bits hold");
        }
        return static_cast<std::int32_t>(*value);
    }

    LabelEntry entryOf(const Attributes& attributes, const std::string& name,
                       Collector& found) const {
        LabelEntry entry;
        entry.name = name;
        if (!isGifti) {
            const bool hasValue = attributes.contains("value");
            entry.value = numberOf(attributes, hasValue ? "value" : "index") +
                          (isProbabilistic_ && !hasValue ? 1 : 0);
            return entry;
        }
        entry.value = numberOf(attributes, attributes.contains("Key") ? "Key" : "Index");
        LabelColor color{};
        constexpr const char* kChannels[] = {"Red", "Green", "Blue"};
        for (std::size_t n = 0; n < 3; ++n) {
            const auto at = attributes.find(kChannels[n]);
            if (at == attributes.end()) return entry;
            const std::optional<double> part = realNumber(at->second);
            if (!part || *part < 0 || *part > 1) {
                found.leaveColorOut("label " + std::to_string(entry.value), at->second);
                return entry;
            }
            color[n] = static_cast<std::uint8_t>(*part * 255 + 0.5);
        }
        entry.color = color;
        return entry;
    }

    int depth_ = 0;
    bool isInLabel_ = false, isProbabilistic_ = true;
    Attributes attributes_;
    std::string text_;
    std::vector<std::pair<Attributes, std::string>> rows_;
};

bool isXml(const TableFile& file) {
    return file.first == '<';
}

/// XML names its own encoding.
LabelTable decodeFile(const TableFile& file) {
    return decodeXml(trimmed(withoutByteOrderMark(file.bytes)));
}

}  // namespace

LabelTable decodeXml(std::string_view text) {
    Labels labels;
    meshio::parseXml(text, labels);
    return labels.finish();
}

extern const TableCodec kXmlTables{isXml, decodeFile};

}  // namespace adaptiso::labelnames
