// GIFTI 1.0 files of values at points: .shape.gii, .func.gii, .label.gii. Written packed, little
// endian, float32 and int32.
#include "GiftiData.h"

#include <vector>

#include "Codecs.h"
#include "GiftiArrays.h"

namespace adaptiso::meshio {
namespace {

using Metadata = std::vector<std::pair<std::string, std::string>>;

/// What a reader needs of the metadata; the rest may name people, places and dates.
bool isKept(std::string_view name, bool isOfArray) {
    return name.starts_with("AnatomicalStructure") || (isOfArray && name == "Name");
}

struct StoredArray {
    GiftiArray array;
    Metadata metadata;
};

/// Collects arrays, labels and metadata.
class DataHandler : public XmlHandler {
public:
    void onStart(const std::string& element, const XmlAttributes& attributes) override {
        if (path_.empty() && element != "GIFTI") {
            unsupported("its XML is a " + printable(element) + ", must be GIFTI",
                        "it is no GIFTI file: get it again");
        }
        text_ = nullptr;
        if (element == "DataArray") {
            arrays.push_back({{attributes, {}}, {}});
            isInArray_ = true;
        } else if (element == "Data" && isInArray_) {
            text_ = &arrays.back().array.text;
        } else if (element == "Label") {
            labels.push_back(labelOf(attributes));
            text_ = &labels.back().name;
        } else if (element == "Name" || element == "Value") {
            text_ = element == "Name" ? &name_ : &value_;
            text_->clear();
        }
        path_.push_back(element);
    }
    void onEnd(const std::string& element) override {
        path_.pop_back();
        text_ = nullptr;
        if (element == "DataArray") isInArray_ = false;
        if (element == "MD") keepMetadata();
    }
    void onText(std::string_view text) override {
        if (text_ != nullptr) text_->append(text);
    }

    std::vector<StoredArray> arrays;
    std::vector<PointLabel> labels;
    Metadata metadata;

private:
    static PointLabel labelOf(const XmlAttributes& attributes) {
        PointLabel label;
        const std::string key =
            attributeOr(attributes, "Key", attributeOr(attributes, "Index", ""));
        label.key = static_cast<std::int32_t>(toInteger(key, "a label's key"));
        static constexpr const char* kChannels[] = {"Red", "Green", "Blue", "Alpha"};
        if (attributes.find("Red") == attributes.end()) return label;
        label.rgba.emplace();
        for (std::size_t n = 0; n < 4; ++n) {
            const double part = toReal(attributeOr(attributes, kChannels[n], "1"), "a colour");
            (*label.rgba)[n] = part >= 0 && part <= 1 ? part : 0;
        }
        return label;
    }

    void keepMetadata() {
        const std::string_view name = trimmed(name_);
        if (isKept(name, isInArray_)) {
            Metadata& to = isInArray_ ? arrays.back().metadata : metadata;
            to.emplace_back(storedName(name), storedName(trimmed(value_)));
        }
        name_.clear();
        value_.clear();
    }

    std::vector<std::string> path_;  ///< the elements around this place
    bool isInArray_ = false;
    std::string* text_ = nullptr;  ///< where text at this place goes
    std::string name_, value_;
};

PointValues decodeArray(const StoredArray& stored) {
    const XmlAttributes& attributes = stored.array.attributes;
    PointValues array;
    array.intent = storedName(attributeOr(attributes, "Intent", "NIFTI_INTENT_NONE"));
    if (array.intent == "NIFTI_INTENT_POINTSET" || array.intent == "NIFTI_INTENT_TRIANGLE") {
        unsupported("it is a surface", "give the file of values at its points");
    }
    if (array.intent == "NIFTI_INTENT_NODE_INDEX") {
        unsupported("it has values for some points only", "save it with a value for every point");
    }
    const GiftiShape shape = shapeOf(attributes, "values");
    array.columns = shape.columns;
    array.metadata = stored.metadata;
    const std::string& type = requireAttribute(attributes, "DataType");
    if (type == "NIFTI_TYPE_FLOAT32") {
        array.values = decodeGiftiRows<float, float>(stored.array, shape, "values");
    } else if (type == "NIFTI_TYPE_INT32") {
        array.values = decodeGiftiRows<std::int32_t, std::int32_t>(stored.array, shape, "values");
    } else if (type == "NIFTI_TYPE_UINT8") {
        array.values = decodeGiftiRows<std::uint8_t, std::int32_t>(stored.array, shape, "values");
    } else {
        unsupported("its values are " + printable(type), "save them as NIFTI_TYPE_FLOAT32");
    }
    return array;
}

void encodeMetadata(const Metadata& metadata, ByteSink& sink) {
    if (metadata.empty()) {
        sink << "<MetaData/>\n";
        return;
    }
    sink << "<MetaData>\n";
    for (const auto& [name, value] : metadata) {
        sink << "<MD><Name>" << escapedMarkup(name) << "</Name><Value>" << escapedMarkup(value)
             << "</Value></MD>\n";
    }
    sink << "</MetaData>\n";
}

void encodeLabels(const std::vector<PointLabel>& labels, ByteSink& sink) {
    if (labels.empty()) {
        sink << "<LabelTable/>\n";
        return;
    }
    sink << "<LabelTable>\n";
    for (const PointLabel& label : labels) {
        sink << "<Label Key=\"" << std::int64_t{label.key} << "\"";
        static constexpr const char* kChannels[] = {" Red=\"", " Green=\"", " Blue=\"",
                                                    " Alpha=\""};
        for (std::size_t n = 0; label.rgba && n < 4; ++n) {
            sink << kChannels[n] << (*label.rgba)[n] << "\"";
        }
        sink << ">" << escapedMarkup(label.name) << "</Label>\n";
    }
    sink << "</LabelTable>\n";
}

}  // namespace

PointData decodeGiftiData(std::string_view bytes) {
    DataHandler found;
    parseXml(bytes, found);
    PointData data;
    data.format = PointDataFormat::Gifti;
    data.labels = std::move(found.labels);
    for (PointLabel& label : data.labels) label.name = storedName(trimmed(label.name));
    data.metadata = std::move(found.metadata);
    for (const StoredArray& stored : found.arrays) data.arrays.push_back(decodeArray(stored));
    if (data.arrays.empty()) damaged("it holds no values");
    const PointValues& first = data.arrays.front();
    const auto size = [](const auto& values) { return std::ssize(values); };
    data.points = first.columns > 0 ? std::visit(size, first.values) / first.columns : 0;
    return data;
}

void encodeGiftiData(const PointData& data, ByteSink& sink) {
    sink << kGiftiHead << "<GIFTI Version=\"1.0\" NumberOfDataArrays=\""
         << static_cast<std::int64_t>(data.arrays.size()) << "\">\n";
    encodeMetadata(data.metadata, sink);
    encodeLabels(data.labels, sink);
    for (const PointValues& array : data.arrays) {
        beginGiftiArray(array.intent.empty() ? "NIFTI_INTENT_NONE" : escapedMarkup(array.intent),
                        array.areLabels() ? "NIFTI_TYPE_INT32" : "NIFTI_TYPE_FLOAT32",
                        {data.points, array.columns}, sink);
        encodeMetadata(array.metadata, sink);
        std::string packed;
        std::visit(
            [&](const auto& values) {
                for (const auto value : values) appendLittleEndian(value, packed);
            },
            array.values);
        endGiftiArray(packed, sink);
    }
    sink << "</GIFTI>\n";
}

}  // namespace adaptiso::meshio
