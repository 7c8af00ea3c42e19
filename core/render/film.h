// What a frame is made of: radiance sums per pixel and the layers and channels asked for.
#pragma once

#include "image/image.h"

#include <Imath/ImathVec.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace ql {

// Arbitrary output channels beside R, G, B.
enum Aov : uint32_t {
    kAovDepth = 1 << 0,    // Z: metres along the viewing axis; 0 where nothing was hit
    kAovNormal = 1 << 1,   // N.X N.Y N.Z: shading normal in world space
    kAovPosition = 1 << 2, // P.X P.Y P.Z: metres
    kAovAlbedo = 1 << 3,   // albedo.R albedo.G albedo.B
    kAovMotion = 1 << 4,   // motion.X motion.Y: pixels to the same point in the next frame
    kAovDirect = 1 << 5,   // direct.R ...: at most one scattering
    kAovIndirect = 1 << 6, // indirect.R ...: more than one
    kAovVariance = 1 << 7, // variance.R ...: of the pixel's mean, from at least two samples
    kAovId = 1 << 8,       // id: number of the surface, 0 where nothing was hit
    kAovAll = (1 << 9) - 1,
};

// "depth,normal" and so on, of those that a tool offers; "all" of them. Errors: ErrorKind::usage.
uint32_t parse_aovs(const std::string& names, uint32_t offered = kAovAll);

// Surface channels that come from the first hit of every camera ray.
inline constexpr uint32_t kFirstHitAovs =
    kAovDepth | kAovNormal | kAovPosition | kAovAlbedo | kAovMotion | kAovId;

// As float; what is beyond its range becomes the greatest float, not infinity: light may be
// brighter.
float saturated(double value);

// Three planes of an image under one prefix, added if they are not there.
class VectorPlanes {
  public:
    VectorPlanes() = default;
    VectorPlanes(Image& image, const std::string& prefix, const std::string& suffixes);
    explicit operator bool() const { return m_planes[0] != nullptr; }
    void set(int x, int y, const Imath::V3d& value) const;

  private:
    Array2D<float>* m_planes[3] = {};
};

// The planes of a frame and where to write them.
struct Film {
    Image image;
    VectorPlanes beauty, normal, position, albedo, direct, indirect, variance;
    Array2D<float>* depth = nullptr;
    Array2D<float>* motion_x = nullptr;
    Array2D<float>* motion_y = nullptr;
    Array2D<uint32_t>* id = nullptr;

    Film(int width, int height, uint32_t aovs);
    Film(const Film&) = delete;
    Film& operator=(const Film&) = delete;
};

} // namespace ql
