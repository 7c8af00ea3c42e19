#include "image/exr_metadata.h"

#include <OpenEXR/ImfBoxAttribute.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFloatVectorAttribute.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfVecAttribute.h>

#include <optional>
#include <set>
#include <string_view>

namespace ql {

namespace {

// Attributes of the container, which the writer makes anew.
const std::set<std::string_view> kContainerKeys = {"capDate",
                                                   "channels",
                                                   "chromaticities",
                                                   "chunkCount",
                                                   "compression",
                                                   "dataWindow",
                                                   "displayWindow",
                                                   "dwaCompressionLevel",
                                                   "envmap",
                                                   "lineOrder",
                                                   "maxSamplesPerPixel",
                                                   "name",
                                                   "pixelAspectRatio",
                                                   "preview",
                                                   "screenWindowCenter",
                                                   "screenWindowWidth",
                                                   "tiles",
                                                   "type",
                                                   "version"};

struct NamePair {
    std::string_view in_file, in_image;
};
constexpr NamePair kNames[] = {{"comments", "ImageDescription"},
                               {"owner", "Copyright"},
                               {"xDensity", "XResolution"},
                               {"expTime", "ExposureTime"},
                               {"aperture", "FNumber"}};

std::string name_in_image(std::string_view name) {
    for (const NamePair& pair : kNames)
        if (pair.in_file == name) return std::string(pair.in_image);
    return std::string(name);
}

std::string name_in_file(std::string_view name) {
    for (const NamePair& pair : kNames)
        if (pair.in_image == name) return std::string(pair.in_file);
    return std::string(name);
}

// The value if the attribute is of type T.
template<class T>
const T* value_of(const Imf::Attribute& attribute) {
    const auto* typed = dynamic_cast<const Imf::TypedAttribute<T>*>(&attribute);
    return typed ? &typed->value() : nullptr;
}

std::vector<float> floats_of(const Imf::Attribute& attribute) {
    if (const auto* v = value_of<Imath::V2f>(attribute)) return {v->x, v->y};
    if (const auto* v = value_of<Imath::V3f>(attribute)) return {v->x, v->y, v->z};
    if (const auto* b = value_of<Imath::Box2f>(attribute))
        return {b->min.x, b->min.y, b->max.x, b->max.y};
    if (const auto* m = value_of<Imath::M33f>(attribute)) return {&(*m)[0][0], &(*m)[0][0] + 9};
    if (const auto* list = value_of<Imf::FloatVector>(attribute)) return *list;
    return {};
}

std::optional<MetadataValue> metadata_value(const Imf::Attribute& attribute) {
    if (const auto* i = value_of<int>(attribute)) return *i;
    if (const auto* f = value_of<float>(attribute)) return *f;
    if (const auto* m = value_of<Imath::M44f>(attribute)) return *m;
    if (const auto* s = value_of<std::string>(attribute); s && !s->empty()) return *s;
    if (std::vector<float> floats = floats_of(attribute); !floats.empty()) return floats;
    return std::nullopt;
}

// Vectors and matrices where the count fits one, as other programs expect them.
void insert_floats(const std::string& name, const std::vector<float>& v, Imf::Header& header) {
    if (v.size() == 2)
        header.insert(name, Imf::V2fAttribute({v[0], v[1]}));
    else if (v.size() == 3)
        header.insert(name, Imf::V3fAttribute({v[0], v[1], v[2]}));
    else if (v.size() == 9)
        header.insert(name,
                      Imf::M33fAttribute({v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7], v[8]}));
    else if (!v.empty())
        header.insert(name, Imf::FloatVectorAttribute(v));
}

} // namespace

Metadata exr_metadata(const Imf::Header& header) {
    Metadata metadata;
    for (auto it = header.begin(); it != header.end(); ++it)
        if (!kContainerKeys.contains(it.name()))
            if (auto value = metadata_value(it.attribute()))
                metadata[name_in_image(it.name())] = std::move(*value);
    return metadata;
}

void insert_exr_metadata(const Metadata& metadata, Imf::Header& header) {
    for (const auto& [key, value] : metadata) {
        const std::string name = name_in_file(key);
        if (name.empty() || kContainerKeys.contains(name) || header.find(name) != header.end())
            continue;
        if (const auto* i = std::get_if<int>(&value)) header.insert(name, Imf::IntAttribute(*i));
        if (const auto* f = std::get_if<float>(&value))
            header.insert(name, Imf::FloatAttribute(*f));
        if (const auto* s = std::get_if<std::string>(&value); s && !s->empty())
            header.insert(name, Imf::StringAttribute(*s));
        if (const auto* m = std::get_if<Imath::M44f>(&value))
            header.insert(name, Imf::M44fAttribute(*m));
        if (const auto* v = std::get_if<std::vector<float>>(&value))
            insert_floats(name, *v, header);
    }
}

} // namespace ql
