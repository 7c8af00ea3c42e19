#include "render/frame_tiles.h"

namespace ql {

TileRenderer dithered_tile_renderer() {
    return detail::render_tile<kAllLobes, detail::FromDither>;
}

} // namespace ql
