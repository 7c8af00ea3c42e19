#include "image/png_metadata.h"

#include <set>
#include <string_view>

namespace ql {

namespace {

struct NamePair {
    std::string_view in_file, in_image;
};
constexpr NamePair kNames[] = {
    {"Author", "Artist"}, {"Title", "DocumentName"}, {"Description", "ImageDescription"}};

// Under which OpenImageIO keeps the name of a part, in PNG too.
constexpr std::string_view kPartName = "oiio:subimagename";

// Of the file and not of the image, or blocks that other programs write for themselves.
const std::set<std::string_view> kSkipped = {"oiio:ColorSpace",
                                             "DateTime",
                                             "name",
                                             "type",
                                             "version",
                                             "compression",
                                             "chromaticities",
                                             "XML:com.adobe.xmp",
                                             "Raw profile type exif"};

} // namespace

void read_png_text(const PngText& text, Image& image) {
    for (const auto& [keyword, value] : text) {
        if (keyword == kPartName) image.name = value;
        if (keyword == kPartName || kSkipped.contains(keyword)) continue;
        std::string key = keyword;
        for (const NamePair& pair : kNames)
            if (pair.in_file == keyword) key = pair.in_image;
        image.metadata[key] = value;
    }
}

PngText png_text(const Image& image, const std::string& software) {
    PngText text = {{"Software", software}};
    if (!image.name.empty()) text.emplace_back(kPartName, image.name);
    for (const auto& [key, value] : image.metadata) {
        const auto* string = std::get_if<std::string>(&value);
        if (!string || key == "Software") continue;
        std::string keyword = key;
        for (const NamePair& pair : kNames)
            if (pair.in_image == key) keyword = pair.in_file;
        text.emplace_back(keyword, *string);
    }
    return text;
}

} // namespace ql
