// Small scenes made in code, and rendering them: for tests that need no files.
#pragma once

#include "render/path_tracer.h"

#include <array>
#include <vector>

namespace ql::reference {

Material lambert(const V3f& albedo);
Material mirror();
Material glass(float ior); // perfectly smooth, solid
Material glossy(const V3f& diffuse, float specular, float exponent);
Material metal(float roughness);
Material emitter(const V3f& radiance, const V3f& albedo = V3f(0));

M44d translated(const V3d& by);
M44d scaled(const V3d& by);
// Right-handed turn about an axis.
M44d rotated(const V3d& axis, double radians);

Light point_light(const V3d& intensity);

class SceneBuilder {
  public:
    Scene scene;

    int add_material(const Material& material);
    int add_mesh(std::vector<V3f> positions, std::vector<std::array<uint32_t, 3>> triangles,
                 int material);
    // A new node with the thing in it; its index.
    int place_mesh(int mesh, const M44d& world_from_node = M44d());
    int place_shape(const ImplicitShape& shape, const M44d& world_from_node = M44d());
    int place_light(const Light& light, const M44d& world_from_node = M44d());

    // Meshes of their own, placed. The front of a quad is the side of edge1 x edge2.
    int add_quad(const V3f& corner, const V3f& edge1, const V3f& edge2, int material);
    int add_triangle(const V3f& a, const V3f& b, const V3f& c, int material);
    void add_sphere(const V3d& centre, double radius, int material);
};

// The 12 triangles of the cube [-1, 1]^3, each side cut into cells x cells squares; fronts outside.
Mesh cube(int cells, int material);
// Points of a sphere of radius 1, all vertices on it; fronts outside.
Mesh sphere_mesh(int rings, int material);
// The closed cone y in [-h/2, h/2], vertices on it.
Mesh cone_mesh(const ImplicitShape& cone, int segments, int rings, int material);

struct View {
    V3d from = {0, 0, 5};
    V3d at = {0, 0, 0};
    double fov_degrees = 40;
    int width = 16;
    int height = 16;
};

PixelCamera camera_of(const View& view, const Scene& scene, const RenderSpace& space);

FrameResult render_scene(const Scene& scene, const View& view, const RenderConfig& config,
                         uint64_t seed = 0, int threads = 1);

// A box of 1 x 1 x 1 around the origin, open to +z, with coloured walls and an area light.
Scene cornell(const Material& block, const Material& light);
View cornell_view(int side);

// Mean over all pixels of one plane.
double mean_of(const Image& image, const char* plane);

} // namespace ql::reference
