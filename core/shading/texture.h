// Texture lookup: wrap modes, filtering and colour decoding of glTF 2.0 (section 3.8.4).
//
// Texels are decoded before they are filtered; alpha is always linear. Any uv is allowed: after
// wrapping only the fraction counts, and a coordinate that is not finite reads as 0. Pure
// functions, safe from any thread.
#pragma once

#include "scene/scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace ql {

// IEC 61966-2-1 for 8-bit code values; linear values are code / 255.
extern const std::array<float, 256> kSrgbToLinear;

inline V4f texel_at(const Texture& texture, Transfer transfer, int x, int y) {
    const size_t offset =
        (static_cast<size_t>(y) * static_cast<size_t>(texture.width) + static_cast<size_t>(x)) * 4;
    const uint8_t* t = texture.texels.data() + offset;
    const float alpha = t[3] * (1.0f / 255);
    if (transfer == Transfer::srgb)
        return {kSrgbToLinear[t[0]], kSrgbToLinear[t[1]], kSrgbToLinear[t[2]], alpha};
    return {t[0] * (1.0f / 255), t[1] * (1.0f / 255), t[2] * (1.0f / 255), alpha};
}

// The coordinate folded into [0, 1].
inline float wrapped_coordinate(float t, Wrap wrap) {
    if (!std::isfinite(t)) return 0;
    switch (wrap) {
    case Wrap::clamp:
        return std::clamp(t, 0.0f, 1.0f);
    case Wrap::repeat:
        return t - std::floor(t);
    case Wrap::mirrored_repeat:
        break;
    }
    const float period = t - 2 * std::floor(t / 2);
    return period > 1 ? 2 - period : period;
}

// A neighbour just outside [0, size): the other edge when repeating, else the edge itself.
inline int wrapped_texel(int i, int size, Wrap wrap) {
    if (i >= 0 && i < size) return i;
    if (wrap == Wrap::repeat) return i < 0 ? size - 1 : 0;
    return i < 0 ? 0 : size - 1;
}

inline V2f transformed_uv(const TextureUse& use, V2f uv) {
    const std::array<float, 6>& m = use.uv_transform;
    return {m[0] * uv.x + m[1] * uv.y + m[2], m[3] * uv.x + m[4] * uv.y + m[5]};
}

// RGBA at the uv of the mesh (before the transform of the use). Linear, in [0, 1].
inline V4f texture_value(const Texture& texture, const TextureUse& use, V2f mesh_uv) {
    const V2f uv = transformed_uv(use, mesh_uv);
    const float x = wrapped_coordinate(uv.x, use.wrap_s) * static_cast<float>(texture.width);
    const float y = wrapped_coordinate(uv.y, use.wrap_t) * static_cast<float>(texture.height);
    if (use.filter == TextureFilter::nearest)
        return texel_at(texture, use.transfer, std::min(static_cast<int>(x), texture.width - 1),
                        std::min(static_cast<int>(y), texture.height - 1));

    // Weigh the four texels whose centres surround the point.
    const float left = std::floor(x - 0.5f);
    const float top = std::floor(y - 0.5f);
    const float fx = x - 0.5f - left;
    const float fy = y - 0.5f - top;
    const int x0 = wrapped_texel(static_cast<int>(left), texture.width, use.wrap_s);
    const int x1 = wrapped_texel(static_cast<int>(left) + 1, texture.width, use.wrap_s);
    const int y0 = wrapped_texel(static_cast<int>(top), texture.height, use.wrap_t);
    const int y1 = wrapped_texel(static_cast<int>(top) + 1, texture.height, use.wrap_t);
    return (texel_at(texture, use.transfer, x0, y0) * (1 - fx) +
            texel_at(texture, use.transfer, x1, y0) * fx) *
               (1 - fy) +
           (texel_at(texture, use.transfer, x0, y1) * (1 - fx) +
            texel_at(texture, use.transfer, x1, y1) * fx) *
               fy;
}

// The value of a use that may be empty: white then, as glTF has it.
inline V4f texture_or_white(std::span<const Texture> textures, const TextureUse& use,
                            const std::array<V2f, 2>& uv) {
    if (!use.used()) return {1, 1, 1, 1};
    return texture_value(textures[static_cast<size_t>(use.texture)], use,
                         uv[static_cast<size_t>(use.uv_set)]);
}

// Asks for the texel at the uv ahead of its use. Large scenes wait for memory more than for
// arithmetic: asking for all textures of a material at once waits only once.
inline void prefetch_texture(std::span<const Texture> textures, const TextureUse& use,
                             const std::array<V2f, 2>& uv) {
    if (!use.used()) return;
    const Texture& texture = textures[static_cast<size_t>(use.texture)];
    const V2f at = transformed_uv(use, uv[static_cast<size_t>(use.uv_set)]);
    const auto texel_at = [](float coordinate, int texels) { // 1 is a coordinate, too
        return static_cast<size_t>(
            std::min(static_cast<int>(coordinate * static_cast<float>(texels)), texels - 1));
    };
    const size_t x = texel_at(wrapped_coordinate(at.x, use.wrap_s), texture.width);
    const size_t y = texel_at(wrapped_coordinate(at.y, use.wrap_t), texture.height);
    const size_t row = static_cast<size_t>(texture.width) * 4;
    const uint8_t* texel = texture.texels.data() + y * row + x * 4;
    __builtin_prefetch(texel);
    __builtin_prefetch(y > 0 ? texel - row : texel); // bilinear lookups read two rows
}

} // namespace ql
