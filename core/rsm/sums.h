// Sums over the passes of an image, in double precision, and the image that they make.
//
// Different pixels may be written by different threads at once.
#pragma once

#include "image/image.h"
#include "render/camera.h"

#include <cstdint>

namespace ql {

// What a pass finds in a pixel; radiances in units of LightSet.
struct PixelPass {
    bool hit = false;
    V3f direct = {0, 0, 0};
    V3f indirect = {0, 0, 0};
    V3f position = {0, 0, 0}; // render space
    V3f normal = {0, 0, 0};
    V3f albedo = {0, 0, 0};
    uint32_t surface = 0;
};

class PixelSumImage {
  public:
    // aovs: see Aov.
    PixelSumImage(int width, int height, uint32_t aovs);

    void add(int x, int y, const PixelPass& pass, const RenderSpace& space,
             const PixelCamera& camera);
    // exponent: real radiances are stored ones times 2^exponent.
    Image image(int exponent) const;

    int width() const { return m_width; }
    int height() const { return m_height; }

  private:
    struct FirstHits {
        V3d normal{0, 0, 0}, position{0, 0, 0}, albedo{0, 0, 0};
        double depth = 0;
        int hits = 0;
        uint32_t id = 0;
    };

    int m_width, m_height;
    uint32_t m_aovs;
    std::vector<V3d> m_direct, m_indirect, m_squares;
    std::vector<FirstHits> m_first_hits; // empty if no channel needs them
    std::vector<int> m_passes;
};

} // namespace ql
