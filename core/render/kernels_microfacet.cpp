#include "render/frame_tiles.h"

namespace ql {

TileRenderer microfacet_tile_renderer(uint32_t attributes) {
    return detail::tile_renderer<kLobeDiffuse | kLobeMicrofacet>(attributes);
}

} // namespace ql
