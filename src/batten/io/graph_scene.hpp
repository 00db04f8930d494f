#pragma once

#include <batten/io/spline_file.hpp>

#include <optional>

namespace batten {

/// A function's samples as points (parameters..., value), none where the scene does not know the
/// parameters; other samples as they are.
PointSet drawn_samples(const Scene& scene);

/// A factor per coordinate that makes a graph as long along every parameter and three fifths as
/// high, whatever the units: for pictures.
std::vector<double> picture_stretch(const Spline& graph);

/// A function's scene as that of its graph, stretched for a picture.
class GraphScene {
  public:
    /// Throws InvalidInput for a function of three variables.
    explicit GraphScene(const Scene& function);
    GraphScene(const GraphScene&) = delete;
    GraphScene& operator=(const GraphScene&) = delete;
    const Scene& scene() const { return *scene_; }

  private:
    Spline spline_;
    Samples samples_;
    std::optional<Scene> scene_;
};

} // namespace batten
