#include "render/frame_tiles.h"

namespace ql {

TileRenderer general_tile_renderer() {
    return detail::render_tile<kAllLobes>;
}

} // namespace ql
