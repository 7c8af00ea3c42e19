#include "render/frame_tiles.h"

namespace ql {

TileRenderer diffuse_tile_renderer(uint32_t attributes) {
    return detail::tile_renderer<kLobeDiffuse>(attributes);
}

} // namespace ql
