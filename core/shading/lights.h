// The lights of a posed world, in render space, and sampling them by power.
//
// Emissive triangles, spheres and cones (emitters) are chosen by power. So is whether it is a
// point, spot or directional light at all; which of them, if they are few, by the irradiance on a
// surface there that faces the light, whatever may lie between. Or nothing is left to chance but
// the emitter: each of the others is sampled.
//
// Units: radiance in W/(m^2 sr); intensities in render space are W/sr times RenderSpace::scale^2,
// so that I'/d'^2 is the irradiance whatever the unit of length. All values are divided by 2^k
// (`exponent`) so that the brightest light is near 1: scenes of 1e-30 or 1e30 candela lose nothing.
#pragma once

#include "geometry/surface_point.h"
#include "sampling/discrete.h"
#include "shading/lit_texels.h"
#include "shading/shape_light.h"
#include "shading/spot_cone.h"

#include <map>
#include <optional>
#include <vector>

namespace ql {

struct LightSample {
    V3f target = {0, 0, 0}; // point in render space that must be visible; unused if distant
    V3f direction;          // unit vector from the shaded point to the light
    bool distant;           // the light is outside of the scene: nothing may lie along direction
    V3f weight;             // radiance / pdf, or intensity / (distance^2 probability)
    float pdf_solid_angle;  // 0 for point, spot and directional lights
};

// Of all lights one, or each point, spot and directional light and one of the emitters.
enum class LightChoice { one, each };

// Whether rays may find light on surfaces.
bool has_emission(const Scene& scene);

class LightSet {
  public:
    // Errors: ErrorKind::input for a light too far away.
    explicit LightSet(const World& world);

    bool empty() const { return m_pick.empty(); }
    // Real values are stored values times 2^exponent.
    int exponent() const { return m_exponent; }
    float stored_from_real() const { return m_stored_from_real; }
    size_t triangle_count() const { return m_triangles.size(); }
    // Emissive triangles, spheres and cones.
    size_t emitter_count() const { return m_triangles.size() + m_shapes.size(); }

    // LightChoice::each where it is wanted, there are at most 32 point, spot and directional
    // lights, and with the emitters as one more than one to choose from.
    LightChoice choice(bool each) const;
    // Samples that light a point.
    size_t sample_count(LightChoice choice) const;

    // Sample i < sample_count(): a light and a point on it; none if the point cannot be lit by that
    // choice. u_pick and u in [0, 1).
    std::optional<LightSample> sample(const V3f& from, LightChoice choice, size_t i, double u_pick,
                                      V2f u) const;

    // The density with which sample() at `from` would have chosen the direction to `at`, a point on
    // an emitter that lies in `direction` (unit) at `distance`.
    float pdf_solid_angle(const SurfacePoint& at, const V3f& direction, float distance,
                          LightChoice choice) const;

  private:
    friend class LightEmission; // photons from the same lights

    struct Punctual {
        Light::Kind kind;
        V3f position;
        V3f axis; // unit, the way the light shines
        V3f intensity;
        float mean_intensity;
        SpotCone cone;

        float falloff(const V3f& direction) const;
        float irradiance_at(const V3f& point) const;
    };
    struct Triangle {
        V3f corner, edge1, edge2;
        V3f normal; // unit, front
        float area;
        float offset;
        uint32_t surface, primitive;
        bool double_sided;
        bool textured; // radiance differs from place to place, or is thinned by alpha
    };

    void add_punctual(const World& world);
    void add_emitters(const World& world);
    void add_triangles(const World& world, uint32_t surface);
    double punctual_power(const Punctual& light) const;
    bool is_double_sided(const ShapeLight& shape) const;
    const Material& material_of(size_t emitter) const;
    double emitter_power(size_t emitter, std::map<int, LitTexels>& lit_texels) const;
    double brightest_radiance(size_t emitter) const;
    bool may_shine(size_t emitter, std::map<int, LitTexels>& lit_texels) const;
    V3f triangle_radiance(const Triangle& triangle, float b1, float b2) const;
    V3f shape_radiance(const ShapeLight& shape, const V2f& uv) const;
    std::optional<LightSample> sample_one(const V3f& from, double u_pick, V2f u) const;
    std::optional<LightSample> sample_brightest(const V3f& from, float u) const;
    std::optional<LightSample> sample_punctual(const Punctual& light, const V3f& from,
                                               float probability) const;
    std::optional<LightSample> sample_emitter(size_t emitter, const V3f& from, V2f u,
                                              float probability) const;

    const World* m_world;
    std::vector<Punctual> m_punctual;
    // Emitters are numbered: triangles first, then shapes.
    std::vector<Triangle> m_triangles;
    std::vector<ShapeLight> m_shapes;
    std::vector<int> m_first_emitter; // by surface; -1: the surface does not emit
    AliasTable m_pick;                // punctual lights first, then emitters
    AliasTable m_pick_emitter;        // of emitters alone
    float m_punctual_probability = 0; // of all of them
    int m_exponent = 0;
    float m_stored_from_real = 1;
};

} // namespace ql
