#include "render/frame_tiles.h"

namespace ql {

TileRenderer dithered_tile_renderer() {
    return detail::render_tile<kAllLobes, kAttributeNormals | kAttributeTextures,
                               detail::FromDither>;
}

} // namespace ql
