#include "scene/gltf_texture.h"

#include "image/picture_decode.h"
#include "scene/gltf_accessor.h"
#include "scene/gltf_material.h"

#include <tiny_gltf.h>

#include <cmath>

namespace ql {

namespace {

std::string image_name(const GltfImport& in, int image) {
    const tinygltf::Image& source = in.model.images[size_t(image)];
    const std::string name = source.uri.empty() ? source.name : source.uri;
    return name.empty() ? fmt::format("image {}", image)
                        : fmt::format("image {} ({})", image, name);
}

// The image of a texture; EXT_texture_webp may bring it where there is none.
int source_image(GltfImport& in, const tinygltf::Texture& texture, const std::string& where) {
    int source = texture.source;
    const auto webp = extension(in, texture.extensions, "EXT_texture_webp", where);
    if (source < 0 && webp) source = webp->index("source");
    if (source < 0 && texture.extensions.contains("KHR_texture_basisu"))
        throw in.error("{}: KTX2 image of KHR_texture_basisu, which is not supported", where);
    if (source < 0) throw in.error("{}: no image", where);
    in.at(in.model.images, source, where, "image");
    return source;
}

int import_image(GltfImport& in, int image) {
    const auto known = in.images.find(image);
    if (known != in.images.end()) return known->second;
    const int result = int(in.scene.textures.size());
    in.scene.textures.push_back({image_name(in, image), 0, 0, {}});
    return in.images[image] = result;
}

Wrap wrap_mode(const GltfImport& in, int mode, const std::string& where) {
    switch (mode) {
    case TINYGLTF_TEXTURE_WRAP_REPEAT:
        return Wrap::repeat;
    case TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT:
        return Wrap::mirrored_repeat;
    case TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE:
        return Wrap::clamp;
    default:
        throw in.error("{}: wrap mode {} is not one of glTF's", where, mode);
    }
}

void read_sampler(const GltfImport& in, int index, const std::string& where, TextureUse& use) {
    if (index < 0) return;
    const tinygltf::Sampler& sampler = in.at(in.model.samplers, index, where, "sampler");
    const std::string name = fmt::format("sampler {}", index);
    use.wrap_s = wrap_mode(in, sampler.wrapS, name);
    use.wrap_t = wrap_mode(in, sampler.wrapT, name);
    if (sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST) use.filter = TextureFilter::nearest;
}

// Translation * rotation * scale, with angles counter-clockwise as seen with v downwards: the
// extension's own example maps the unit square to [0, 1/2] x [1/2, 1].
void read_transform(const ExtensionObject& transform, TextureUse& use) {
    const std::vector<double> offset = transform.numbers("offset", {0, 0});
    const std::vector<double> scale = transform.numbers("scale", {1, 1});
    const double angle = transform.number("rotation", 0);
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    use.uv_transform = {float(c * scale[0]),  float(s * scale[1]), float(offset[0]),
                        float(-s * scale[0]), float(c * scale[1]), float(offset[1])};
    if (transform.has("texCoord")) use.uv_set = transform.index("texCoord");
}

TextureUse use_of(GltfImport& in, int texture, int uv_set, Transfer transfer,
                  const std::optional<ExtensionObject>& transform, const std::string& where) {
    const tinygltf::Texture& source = in.at(in.model.textures, texture, where, "texture");
    const std::string name = fmt::format("texture {}", texture);
    TextureUse use;
    use.transfer = transfer;
    use.uv_set = uv_set;
    read_sampler(in, source.sampler, name, use);
    if (transform) read_transform(*transform, use);
    if (use.uv_set < 0 || use.uv_set > 1)
        throw in.error("{}: reads TEXCOORD_{}, expected set 0 or 1", where, use.uv_set);
    use.texture = import_image(in, source_image(in, source, name));
    return use;
}

std::span<const std::byte> image_bytes(const GltfImport& in, int index) {
    const tinygltf::Image& image = in.model.images[size_t(index)];
    if (image.bufferView >= 0) {
        const ByteRange range = buffer_view_bytes(in, image.bufferView, image_name(in, index));
        return std::as_bytes(std::span(range.first, range.size));
    }
    if (image.image.empty()) throw in.error("{}: cannot be read", image_name(in, index));
    return std::as_bytes(std::span(image.image));
}

} // namespace

TextureUse texture_use(GltfImport& in, const tinygltf::TextureInfo& info, Transfer transfer,
                       const std::string& where) {
    if (info.index < 0) return {};
    const auto transform = extension(in, info.extensions, "KHR_texture_transform", where);
    return use_of(in, info.index, info.texCoord, transfer, transform, where);
}

TextureUse texture_use(GltfImport& in, const tinygltf::NormalTextureInfo& info, Transfer transfer,
                       const std::string& where) {
    if (info.index < 0) return {};
    const auto transform = extension(in, info.extensions, "KHR_texture_transform", where);
    return use_of(in, info.index, info.texCoord, transfer, transform, where);
}

TextureUse texture_use(GltfImport& in, const std::optional<ExtensionObject>& info,
                       Transfer transfer) {
    if (!info) return {};
    const auto extensions = info->object("extensions");
    const auto transform = extensions ? extensions->object("KHR_texture_transform") : std::nullopt;
    const int uv_set = info->has("texCoord") ? info->index("texCoord") : 0;
    return use_of(in, info->index("index"), uv_set, transfer, transform, info->where());
}

void decode_textures(GltfImport& in, const Workers& workers) {
    const std::vector<std::pair<int, int>> images(in.images.begin(), in.images.end());
    workers.for_each(images.size(), [&](size_t i) {
        const auto [image, texture] = images[i];
        Picture picture =
            decode_picture(image_bytes(in, image), in.file + ": " + image_name(in, image),
                           {in.config.max_texture_pixels});
        Texture& target = in.scene.textures[size_t(texture)];
        target.width = picture.width;
        target.height = picture.height;
        target.texels = std::move(picture.rgba);
    });
}

} // namespace ql
