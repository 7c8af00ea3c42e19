#include "render/frame_tiles.h"

namespace ql {

TileRenderer general_tile_renderer(uint32_t attributes) {
    return detail::tile_renderer<kAllLobes>(attributes);
}

} // namespace ql
