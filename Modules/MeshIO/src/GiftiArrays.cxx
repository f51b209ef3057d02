#include "GiftiArrays.h"

#include <utility>

#include "Bytes.h"
#include "adaptiso/Core/Text.h"

namespace adaptiso::meshio {
namespace {

class GiftiHandler : public XmlHandler {
public:
    void onStart(const std::string& element, const XmlAttributes& attributes) override {
        if (depth_++ == 0 && element != "GIFTI") {
            unsupported("its XML is a " + printable(element) + ", must be GIFTI",
                        "it is no GIFTI file: get it again");
        }
        text_ = nullptr;
        if (depth_ == 1) file.count = attributeOr(attributes, "NumberOfDataArrays", "");
        if (element == "DataArray") {
            file.arrays.push_back({attributes});
            isInArray_ = true;
        } else if (element == "Label") {
            text_ = &file.labels.emplace_back(attributes, "").second;
        } else if (element == "Name" || element == "Value") {
            text_ = element == "Name" ? &name_ : &value_;
            text_->clear();
        } else if (isInArray_) {
            startInArray(element, file.arrays.back());
        }
    }
    void onEnd(const std::string& element) override {
        --depth_;
        text_ = nullptr;
        if (element == "DataArray") isInArray_ = false;
        if (element != "MD") return;
        (isInArray_ ? file.arrays.back().metadata : file.metadata)
            .emplace_back(trimmed(name_), trimmed(value_));
        name_.clear();
        value_.clear();
    }
    void onText(std::string_view text) override {
        if (text_ != nullptr) text_->append(text);
    }

    void onRest(std::string_view rest) override { file.behind = rest; }

    GiftiFile file;

private:
    void startInArray(const std::string& element, GiftiArray& array) {
        if (element == "Data") text_ = &array.text;
        if (element == "CoordinateSystemTransformMatrix") array.spaces.emplace_back();
        if (array.spaces.empty()) return;
        if (element == "DataSpace") text_ = &array.spaces.back().dataSpace;
        if (element == "TransformedSpace") text_ = &array.spaces.back().transformedSpace;
        if (element == "MatrixData") text_ = &array.spaces.back().matrix;
    }

    int depth_ = 0;
    bool isInArray_ = false;
    std::string* text_ = nullptr;  ///< where text at this place goes
    std::string name_, value_;
};

}  // namespace

GiftiFile parseGifti(std::string_view bytes) {
    GiftiHandler handler;
    parseXml(bytes, handler);
    GiftiFile& file = handler.file;
    if (!trimmed(file.count).empty()) {
        Counted arrays{"arrays", toInteger(trimmed(file.count), "NumberOfDataArrays"), 1};
        const std::int64_t there = std::ssize(file.arrays);
        if (arrays.count == 0 && there > 0) setToThere(arrays, there, file.warnings);
        if (arrays.count != there) {
            unsupported("its NumberOfDataArrays is " + std::to_string(arrays.count) +
                            ", and it holds " + std::to_string(there),
                        "get the file again, or correct the count");
        }
    }
    return std::move(file);
}

GiftiShape shapeOf(const XmlAttributes& attributes, std::string_view what) {
    const std::string dimensions = attributeOr(attributes, "Dimensionality", "1");
    if (dimensions != "1" && dimensions != "2") {
        unsupported("its " + std::string(what) + " have " + printable(dimensions) + " dimensions",
                    "save them with a row for each point");
    }
    GiftiShape shape;
    shape.rows = toInteger(requireAttribute(attributes, "Dim0"), "Dim0");
    if (dimensions == "2") shape.columns = toInteger(requireAttribute(attributes, "Dim1"), "Dim1");
    if (shape.rows < 0 || shape.columns < 0) damaged("the size of its arrays is negative");
    return shape;
}

void loadExternal(GiftiArray& array, const std::filesystem::path& folder) {
    namespace fs = std::filesystem;
    if (folder.empty() || attributeOr(array.attributes, "Encoding", "") != kExternalFile) return;
    const std::string name = attributeOr(array.attributes, "ExternalFileName", "");
    const fs::path file = folder / name;
    std::error_code error;
    const bool isPlain = !name.empty() && name != "." && name != ".." &&
                         name.find_first_of(std::string_view("/\\\0", 3)) == std::string::npos;
    if (!isPlain || (fs::is_symlink(fs::symlink_status(file, error)) &&
                     fs::canonical(file, error).parent_path() != fs::canonical(folder, error))) {
        unsupported("its data lie in " + printable(name) + ", which is no plain file of its folder",
                    "save it as GZipBase64Binary, all in one file");
    }
    const std::string offset = attributeOr(array.attributes, "ExternalFileOffset", "0");
    const std::int64_t begin =
        trimmed(offset).empty() ? 0 : toInteger(offset, "ExternalFileOffset");
    const std::string bytes = readBytes(file);
    requireRoom("bytes before the data in " + printable(name), begin, 1, bytes.size());
    array.text = bytes.substr(begin);
    array.isExternal = true;
}

bool isPackedGifti(const std::string& encoding, std::string_view what) {
    if (encoding == "GZipBase64Binary") return true;
    if (encoding == "Base64Binary") return false;
    unsupported("its " + std::string(what) + " have the encoding " + printable(encoding),
                "save it with GZipBase64Binary");
}

void beginGiftiArray(std::string_view intent, std::string_view type, const GiftiShape& shape,
                     ByteSink& sink) {
    const bool isFlat = shape.columns == 1;
    sink << "<DataArray Intent=\"" << intent << "\" DataType=\"" << type
         << "\" ArrayIndexingOrder=\"RowMajorOrder\" Dimensionality=\"" << (isFlat ? "1" : "2")
         << "\" Dim0=\"" << shape.rows;
    if (!isFlat) sink << "\" Dim1=\"" << shape.columns;
    sink << "\" Encoding=\"GZipBase64Binary\" Endian=\"LittleEndian\""
            " ExternalFileName=\"\" ExternalFileOffset=\"\">\n";
}

void endGiftiArray(const std::string& bytes, ByteSink& sink) {
    sink << "<Data>" << encodeBase64(deflated(bytes)) << "</Data>\n</DataArray>\n";
}

void requireGiftiType(const GiftiArray& array, std::string_view type, std::string_view what) {
    if (array.attributes.empty()) malformed("it has no " + std::string(what));
    const std::string& found = requireAttribute(array.attributes, "DataType");
    if (found != type) {
        unsupported("its " + std::string(what) + " are " + printable(found),
                    "save them as " + std::string(type));
    }
}

}  // namespace adaptiso::meshio
