// How a light sees the scene: from points of the unit square to rays, and from points to the
// square.
//
// Equal-area maps give every texel the same solid angle: the cone of a spot light, whatever its
// angle, or the whole sphere, from the square by Shirley & Chiu 1997 and Lambert's azimuthal map.
// Perspective maps are those of Nilles 2017, section 5.1: square, field of view twice the cut-off
// angle; a point light has six. Directional lights see the scene's bounds orthographically. In the
// square u runs right and v down, seen from the light, "up" being (0, 1, 0), or (0, 0, 1) where the
// light looks along that axis. Render space; immutable.
#pragma once

#include "rsm/light.h"

namespace ql {

enum class MapKind { equal_area, perspective };

class MapProjection {
  public:
    // The solid angle (sr) or, for directional lights, the area that du dv of the square covers.
    struct LightRay {
        Ray ray; // of unit direction; t counts from the light or from a plane in front of the scene
        double measure;
    };
    LightRay ray(double u, double v) const;

    struct MapPoint {
        V2f uv = {0.5f, 0.5f}; // may lie outside the unit square
        float depth = 0;       // t of the ray that meets the point
        bool is_ahead = true;  // false: a perspective light cannot see it

        // Does the light look there?
        bool is_inside() const {
            return is_ahead && uv.x >= 0 && uv.x <= 1 && uv.y >= 0 && uv.y <= 1;
        }
    };
    MapPoint point(const V3f& p) const;

    // The measure of LightRay at a point.
    double measure(const MapPoint& at) const;
    // How far that many texels of a map of `size` reach from a point at most: an angle, or a length
    // for directional lights. Texels of equal area are slivers near the rim of the sphere.
    double reach(const MapPoint& at, double texels, int size) const;
    bool is_directional() const { return m_kind == Kind::orthographic; }

  private:
    friend std::vector<MapProjection> map_projections(const MapLight&, MapKind, const World&);
    enum class Kind { equal_area, perspective, orthographic };

    Kind m_kind = Kind::equal_area;
    V3f m_origin;
    V3f m_right, m_up, m_forward;
    float m_one_minus_cos = 2; // equal area: of the cone's angle; 2 is the sphere
    double m_tangent = 1;      // perspective: of half the field of view
    double m_half_width = 1;   // orthographic
};

// One, or six for the perspective maps of a point light. Errors: ErrorKind::input for a spot light
// that no perspective map can hold.
std::vector<MapProjection> map_projections(const MapLight& light, MapKind kind, const World& world);

} // namespace ql
