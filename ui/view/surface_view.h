// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "ui/gl/frame_target.h"
#include "ui/gl/shader_program.h"
#include "ui/view/face_runs.h"
#include "ui/view/mesh_buffers.h"
#include "ui/view/mesh_selecting.h"
#include "ui/view/motion_budget.h"
#include "ui/view/orbit_camera.h"
#include "ui/view/piece_size.h"

namespace dubsar::ui {

enum class Overlay { kClay, kColours, kValue, kReliability, kScans, kFlags };

/// The mesh has what the overlay shows.
[[nodiscard]] bool tells(const ShownMesh& mesh, Overlay overlay);

/// How a surface is lit and coloured.
struct Look {
  Overlay overlay = Overlay::kClay;
  Eigen::Vector2f value_range{0, 1};
  bool lamp = false;                         ///< a raking lamp; else the lit sphere
  Eigen::Vector3f light{-0.6F, 0.6F, 0.5F};  ///< towards the lamp, eye space
  bool shadows = true;                       ///< of the lamp
  bool occlusion = true;
  float radiance = 0.8F;    ///< 0: no radiance scaling
  float depth_shading = 0;  ///< 0: none; per mm below the surroundings
  bool flat = false;
  Eigen::Vector3f clay{0.86F, 0.72F, 0.55F};
  Eigen::Vector3f red{0.84F, 0.12F, 0.15F};
  Eigen::Vector3f amber{0.89F, 0.63F, 0.16F};
  Eigen::Vector3f selected{0.25F, 0.55F, 0.95F};
  Eigen::Vector4f ground{0, 0, 0, 0};
  bool operator==(const Look&) const = default;
};

/// How far a mesh is on its way to the graphics card.
enum class Arrival { kUnderWay, kShown, kRefused };

/// Draws a surface into a picture that the skin shows. While it is turned it is drawn in the level of detail
/// of which the machine draws soon enough what is in the picture; at rest all faces follow, some at each
/// frame, so that no frame takes long. Main thread.
class SurfaceView {
 public:
  SurfaceView();

  /// All of it at once, however long that takes.
  void show(const ShownMesh& mesh);
  /// A piece at each call; what was shown before stays until all is there, unless the graphics card has room
  /// for one only. While it is under way `mesh` must stay.
  [[nodiscard]] Arrival show_soon(const ShownMesh& mesh);
  void show_points(const ColouredPoints* points);  ///< null: none
  void set_values(const std::vector<float>& values);
  void set_traits(const std::vector<std::array<std::uint8_t, 4>>& traits);
  [[nodiscard]] bool empty() const { return mesh_ == nullptr && points_ == nullptr; }
  [[nodiscard]] const MeshBuffers* buffers() const { return mesh_.get(); }
  /// Of the graphics card's memory, that this takes: meshes, pictures, shadows and what is selected.
  [[nodiscard]] std::size_t graphics_bytes() const;

  /// Draws what has changed since the last call. True while more is to come at the next.
  bool draw(const OrbitCamera& camera, const Look& look, int width, int height);
  /// A picture beside the one that is shown, for one that is kept (still_picture.h). `same_light`: the last
  /// one's, with the same model under it, so that its shadows need not be cast again.
  void begin_still(const OrbitCamera& camera, const Look& look, int width, int height, bool same_light);
  /// Some more faces of it. True while more is to come.
  bool draw_still();
  [[nodiscard]] Image read_still() const { return still_ ? still_->picture.read() : Image{}; }
  /// Lets go of what it took.
  void end_still();
  /// All of it at once, however long that takes.
  void draw_whole(const OrbitCamera& camera, const Look& look, int width, int height);
  /// The same in a level of detail, which draw() chooses itself.
  void draw_level(std::size_t level, const OrbitCamera& camera, const Look& look, int width, int height);
  /// The picture; id 0 before the first draw.
  [[nodiscard]] unsigned texture() const {
    return shown().picture.width() > 0 ? shown().picture.colour(0) : 0;
  }
  [[nodiscard]] Image read() const { return shown().picture.read(); }
  /// False when the mesh has more of them than the graphics driver can number or the card has room for, or is
  /// shown in fewer faces than it has: then none can be selected.
  [[nodiscard]] bool can_select(MeshElement of) const;
  /// Begins to select faces, or vertices, by a polygon in the last picture, corners in its pixels from the
  /// top left; what is drawn next does not matter to it. `through`: also what is hidden there. A selection of
  /// the other kind is given up. False before the whole surface stands in the picture.
  bool select(MeshElement of, const std::vector<Eigen::Vector2f>& corners, SelectionStep step, bool through);
  /// Some more of that. True while more is to come.
  bool select_more();
  void set_selection(MeshElement of, SelectionMarks selected);
  void clear_selection();
  /// Null where nothing was selected.
  [[nodiscard]] const MeshSelecting* selection() const { return selection_.get(); }
  /// Model point that is seen at a pixel (from the top left) of the last picture, once that is whole().
  [[nodiscard]] std::optional<Eigen::Vector3f> point_at(const Eigen::Vector2f& px) const;
  /// Faces in the last picture, and outside it by their blocks.
  [[nodiscard]] std::size_t faces_drawn() const { return faces_drawn_; }
  [[nodiscard]] bool whole() const { return whole_; }
  /// Level of detail in the last picture, and how many there are; the last is the whole surface.
  [[nodiscard]] std::size_t level_drawn() const { return level_drawn_; }
  [[nodiscard]] std::size_t levels() const { return levels_.size(); }
  /// As many faces as are drawn in motion at most, once this machine's speed is known.
  [[nodiscard]] std::size_t faces_in_motion() const { return motion_.faces(); }

 private:
  struct Layer {  // what is seen where
    FrameTarget target{{PixelFormat::kRgba8, PixelFormat::kRgba16f}};
    FrameTarget shadow{{}};
    FrameTarget picture{{PixelFormat::kRgba8}};  ///< of both, lit
    bool shadow_stands = false;                  ///< from another picture in the same light
    float shadow_slack_mm = 0;                   ///< what casts it may lie so far off the surface
  };
  struct Scene {
    OrbitCamera camera;
    Look look;
    int width = 0;
    int height = 0;
    bool operator==(const Scene&) const = default;
  };
  struct Progress {  // next blocks of a picture that comes together
    std::size_t shadow = 0;
    std::size_t surface = 0;
  };
  [[nodiscard]] const Layer& shown() const { return layers_[shown_layer_]; }
  [[nodiscard]] static bool casts_shadows(const Layer& layer, const Scene& scene) {
    return scene.look.lamp && scene.look.shadows && !layer.shadow_stands;
  }
  void warm_up();
  void take_shown(const ShownMesh& mesh);
  bool clear(Layer& layer, const Scene& scene) const;  ///< true when it had another size before
  ShaderProgram& begin_surface(const Scene& scene, const Layer& layer, bool everything);
  void draw_surface(Layer& layer, const Scene& scene, std::size_t level, std::span<const FaceBlock> blocks);
  void draw_shadow(Layer& layer, const Scene& scene, std::size_t level, std::span<const FaceBlock> blocks);
  void draw_faces(std::size_t level, const FaceRun& run) const;
  [[nodiscard]] int shadow_px(const Layer& layer) const;
  /// The coarsest level up to `finest` whose shadows are as good as that one's.
  [[nodiscard]] std::size_t shadow_level(const Layer& layer, const Scene& scene, std::size_t finest) const;
  bool draw_in_motion(const Scene& scene);
  bool draw_more(const Scene& scene);
  bool add_faces(Layer& layer, const Scene& scene, Progress& next);
  void draw_marks(Layer& layer, const Scene& scene);
  [[nodiscard]] bool begin_selection(MeshElement of);
  void show_selection(ShaderProgram& surface, std::size_t level, std::size_t first_face);
  void light(Layer& layer, const Scene& scene);
  [[nodiscard]] OrbitCamera lamp_of(const Scene& scene) const;
  [[nodiscard]] Eigen::Matrix4f light_clip_from_model(const Scene& scene) const;

  ShaderProgram clay_;     ///< a surface of one colour, nothing selected
  ShaderProgram surface_;  ///< with all that may be shown on it
  ShaderProgram shadow_, lighting_;
  PixelTexture sphere_, colour_map_;
  std::unique_ptr<MeshBuffers> mesh_;
  std::unique_ptr<MeshBuffers> coming_;  ///< not all of it is on the card yet
  std::unique_ptr<PointBuffers> points_;
  std::unique_ptr<MeshSelecting> selection_;
  bool selection_refused_ = false;                  ///< the card has no room for one of this mesh
  std::vector<std::vector<FaceBlock>> levels_{{}};  ///< fewest faces first, the whole surface last
  std::vector<float> cells_mm_;                     ///< of all levels but the last
  bool has_normals_ = false;
  Eigen::AlignedBox3f box_mm_;
  /// Each keeps its size: other memory for every drag would cost the first picture of it.
  static constexpr std::size_t kInMotion = 0, kAtRest = 1;
  std::array<Layer, 2> layers_;
  std::size_t shown_layer_ = kInMotion;
  unsigned no_vertices_ = 0;
  Scene scene_;
  std::unique_ptr<Layer> still_;
  Scene still_scene_;
  Progress still_next_;
  bool dirty_ = true;          ///< mesh, points or values have changed
  Progress next_;              ///< of the whole picture that comes together
  bool faces_to_come_ = true;  ///< into it; then the light
  bool whole_ = false;
  PieceSize faces_at_a_time_{40000};
  MotionBudget motion_;
  Scene in_motion_;  ///< the last picture of it
  std::size_t level_drawn_ = 0;
  std::size_t faces_drawn_ = 0;
};

/// Colours of the overlay that shows numbers, from low to high (viridis-like, told apart by the
/// colour-blind).
[[nodiscard]] std::array<std::array<std::uint8_t, 3>, 256> overlay_colours();

}  // namespace dubsar::ui
