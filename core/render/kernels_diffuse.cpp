#include "render/frame_tiles.h"

namespace ql {

TileRenderer diffuse_tile_renderer() {
    return detail::render_tile<kLobeDiffuse>;
}

} // namespace ql
