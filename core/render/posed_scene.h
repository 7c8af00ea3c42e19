// A scene at one moment with everything that a renderer asks: rays, lights, and what it requires.
#pragma once

#include "geometry/embree_scene.h"
#include "render/camera.h"
#include "shading/alpha.h"
#include "shading/lights.h"

#include <memory>

namespace ql {

class PosedScene {
  public:
    PosedScene(const Scene& scene, const RenderSpace& space, double time_seconds,
               const Workers& workers);
    PosedScene(const PosedScene&) = delete;
    PosedScene& operator=(const PosedScene&) = delete;

    const World& world() const { return m_world; }
    const EmbreeScene& rays() const { return *m_rays; }
    const LightSet& lights() const { return *m_lights; }

  private:
    World m_world;
    MaterialAlphaTest m_alpha;
    std::unique_ptr<EmbreeScene> m_rays;
    std::unique_ptr<LightSet> m_lights;
};

// Whether anything but cameras moves.
bool has_moving_surfaces_or_lights(const Scene& scene);

// Where a camera comes from: one of the file's, or explicit points.
struct CameraChoice {
    std::string name; // name or index of a camera of the file; empty: the first one
    bool explicit_view = false;
    V3d look_from = {0, 0, 0};
    V3d look_at = {0, 0, 0};
    double fov_degrees = 0; // vertical; 0: the file's, or 45
};

struct ChosenCamera {
    Camera camera;
    int node = -1;          // animated with the scene; -1: fixed
    M44d world_from_camera; // used if node is -1
    bool is_framed = false; // neither in the file nor given: placed to see the whole scene
};

// Errors: ErrorKind::usage for a name that is not there.
ChosenCamera choose_camera(const Scene& scene, const RenderSpace& space,
                           const CameraChoice& choice);

// bounds: of the world at that time; the default is that of time 0.
PixelCamera pixel_camera(const ChosenCamera& chosen, const Scene& scene, const RenderSpace& space,
                         double time_seconds, int width, int height,
                         const Imath::Box3d& bounds = kUnitBox);

} // namespace ql
